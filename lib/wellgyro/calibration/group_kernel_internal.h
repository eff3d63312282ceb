#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>

#include "wellgyro/calibration/lanes_internal.h"
#include "wellgyro/record/sample.h"

namespace wellgyro {

/// Samples that are calibrated side by side.
inline constexpr int kSide = 4;

/// SensorGroup's formula solved for u in T within a cell of temperatures, as plain numbers:
///   u = A counts + b + x (A1 counts + b1 + x b2 - force1 f)
///       - (force f + force_products q(f) - heat dT/dt) - products q(u)
/// with q as SensorGroup has it and x from 0 to 1 through the cell. All but A counts + b is small
/// beside u: it is summed in single precision, to 2^-20 of its largest part, products of u where
/// that is enough for them (kReachSingle).
struct GroupKernel {
  /// What the products of q move u by: xx, yy, zz, then xy, yz, zx.
  template <class Number>
  struct Products {
    bool squares = false, crosses = false;  ///< some of these three move anything
    Number out[6][3] = {};
  };

  int n_channels = 0;
  std::array<std::size_t, 4> channel{};
  /// What of the formula a group has: what it lacks costs nothing.
  bool varies = false, moved = false, second_order = false;  ///< moved: by the force or heating
  SameDouble A[3][4], b[3];
  SameSingle A1[3][4], b1[3], b2[3], force[3][3], force1[3][3], heat[3];
  Products<SameSingle> force_products, products_single;
  Products<double> products;
  /// Largest sum of a row of products: e = slope |u| is how far the second order moves u, over u.
  double slope = 0;
  SameSingle reach_square;  ///< largest |u|^2 for which products in single precision are enough
};

/// u <- linear - products q(u), from `linear` on, as often as it needs to leave less than a tenth
/// of the finest count, 2^-31 of full scale.
Eigen::Vector3d RefineInDouble(const GroupKernel& kernel, const Eigen::Vector3d& linear);
/// Largest e for which two turns in single precision leave as little: sums of six products of what
/// was rounded before are off by twelve roundings at most, 12 * 2^-24 e.
inline constexpr double kReachSingle = 6.5e-5;

template <int kN>
using Side = std::array<typename LanesOf<kN>::Double, 3>;
template <int kN>
using SingleSide = std::array<typename LanesOf<kN>::Single, 3>;

/// What moves the samples of a side beside their counts.
template <int kN>
struct Beside {
  typename LanesOf<kN>::Single x, heating_rate;
  SingleSide<kN> f;
};

template <int kN, bool kVaries>
[[gnu::always_inline]] inline void AddChannel(const GroupKernel& g, const CountsOf<kN>& counts,
                                              std::size_t c, Side<kN>& u, SingleSide<kN>& slope) {
  const auto whole = counts[g.channel[c]];
  const auto n = ToDouble(whole);
  for (std::size_t i = 0; i < 3; ++i) u[i] = u[i] + Of<kN>(g.A[i][c]) * n;
  if constexpr (!kVaries) return;
  const auto single = ToSingle(whole);
  for (std::size_t i = 0; i < 3; ++i) slope[i] = slope[i] + Of<kN>(g.A1[i][c]) * single;
}

/// u where the cell begins, and how much it changes through the cell.
template <int kN, bool kFour, bool kVaries>
[[gnu::always_inline]] inline void Linear(const GroupKernel& g, const CountsOf<kN>& counts,
                                          Side<kN>& u, SingleSide<kN>& slope) {
  for (std::size_t i = 0; i < 3; ++i) {
    u[i] = Of<kN>(g.b[i]);
    slope[i] = Of<kN>(g.b1[i]);
  }
  for (std::size_t c = 0; c < 3; ++c) AddChannel<kN, kVaries>(g, counts, c, u, slope);
  if constexpr (kFour) AddChannel<kN, kVaries>(g, counts, 3, u, slope);
}

template <int kN>
[[gnu::always_inline]] inline void AddRow(const SameSingle (&row)[3], const SingleSide<kN>& f,
                                          typename LanesOf<kN>::Single& sum) {
  for (std::size_t j = 0; j < 3; ++j) sum = sum + Of<kN>(row[j]) * f[j];
}

/// Adds what q(of) moves u by.
template <int kN>
[[gnu::always_inline]] inline void AddProducts(const GroupKernel::Products<SameSingle>& products,
                                               const SingleSide<kN>& of, SingleSide<kN>& sum) {
  const auto add = [&](std::size_t p, typename LanesOf<kN>::Single q)
      __attribute__((always_inline)) {
    for (std::size_t i = 0; i < 3; ++i) sum[i] = sum[i] + Of<kN>(products.out[p][i]) * q;
  };
  if (products.squares) {
    for (std::size_t i = 0; i < 3; ++i) add(i, of[i] * of[i]);
  }
  if (products.crosses) {
    for (std::size_t i = 0; i < 3; ++i) add(3 + i, of[i] * of[(i + 1) % 3]);
  }
}

/// What the force and the heating move u by.
template <int kN>
[[gnu::always_inline]] inline void AddForce(const GroupKernel& g, const Beside<kN>& beside,
                                            SingleSide<kN>& sum) {
  for (std::size_t i = 0; i < 3; ++i) {
    AddRow<kN>(g.force[i], beside.f, sum[i]);
    sum[i] = sum[i] - Of<kN>(g.heat[i]) * beside.heating_rate;
  }
  AddProducts<kN>(g.force_products, beside.f, sum);
}

/// Takes that off, and adds what the place in the cell does.
template <int kN, bool kVaries, bool kMoved>
[[gnu::always_inline]] inline void TakeSmall(const GroupKernel& g, const Beside<kN>& beside,
                                             SingleSide<kN>& slope, Side<kN>& u) {
  SingleSide<kN> sum{};
  if constexpr (kMoved) AddForce<kN>(g, beside, sum);
  for (std::size_t i = 0; i < 3; ++i) {
    if constexpr (kVaries) {
      typename LanesOf<kN>::Single force{};
      if constexpr (kMoved) AddRow<kN>(g.force1[i], beside.f, force);
      sum[i] = sum[i] - beside.x * (slope[i] - force + Of<kN>(g.b2[i]) * beside.x);
    }
    u[i] = u[i] - ToDouble(sum[i]);
  }
}

template <int kN>
[[gnu::noinline]] void RefineLarge(const GroupKernel& g, const Side<kN>& linear,
                                   const typename LanesOf<kN>::Single& square, Side<kN>& u) {
  for (std::size_t k = 0; k < static_cast<std::size_t>(kN); ++k) {
    if (!(At(square, k) > g.reach_square.fourfold[0])) continue;
    const Eigen::Vector3d refined =
        RefineInDouble(g, {At(linear[0], k), At(linear[1], k), At(linear[2], k)});
    for (int i = 0; i < 3; ++i) SetAt(u[static_cast<std::size_t>(i)], k, refined[i]);
  }
}

/// Takes off what products of u do to it.
template <int kN>
[[gnu::always_inline]] inline void Refine(const GroupKernel& g, Side<kN>& u) {
  SingleSide<kN> at, first{}, second{};
  for (std::size_t i = 0; i < 3; ++i) at[i] = ToSingle(u[i]);
  const auto square = at[0] * at[0] + at[1] * at[1] + at[2] * at[2];
  AddProducts<kN>(g.products_single, at, first);
  for (std::size_t i = 0; i < 3; ++i) at[i] = at[i] - first[i];
  AddProducts<kN>(g.products_single, at, second);
  const Side<kN> linear = u;
  for (std::size_t i = 0; i < 3; ++i) u[i] = linear[i] - ToDouble(second[i]);
  if (AnyAbove(square, Of<kN>(g.reach_square))) RefineLarge<kN>(g, linear, square, u);
}

template <int kN>
[[gnu::always_inline]] inline void Put(const Side<kN>& u, ImuSample* out,
                                       Eigen::Vector3d ImuSample::*member) {
  std::array<double*, kN> to;
  for (std::size_t k = 0; k < to.size(); ++k) to[k] = (out[k].*member).data();
  Scatter(u, to);
}

}  // namespace wellgyro

#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>

#include "wellgyro/record/sample.h"

namespace wellgyro {

/// SensorGroup's formula solved for u in T at one temperature, as plain numbers:
///   u = A counts + b - (force f + force_squares q(f) - heat dT/dt) - squares q(u)
/// with q as SensorGroup has it. What stands in brackets is small beside u and known to 1e-5 of
/// itself at best: it is summed in single precision, to 2^-21 of its largest part.
struct GroupKernel {
  /// What the products of q move u by: xx, yy, zz, then xy, yz, zx.
  template <class Real>
  struct Products {
    bool squares = false, crosses = false;  ///< some of these three move anything
    Real out[6][3] = {};
  };
  static constexpr std::size_t kTurns = 64;

  int n_channels = 0;
  std::array<std::size_t, 4> channel{};
  double A[3][4] = {}, b[3] = {};
  float force[3][3] = {}, heat[3] = {};
  bool heats = false, feels_force = false, second_order = false;
  Products<float> force_products;
  Products<double> products;
  std::array<double, kTurns> reach{};  ///< largest |component of u| for which so many turns do
};

/// A component of kN samples side by side: what the processor does with one number it does with
/// several at once. The arithmetic of a sample does not depend on kN nor on its neighbours.
template <int kN, class Real = double>
using Lanes = Eigen::Array<Real, kN, 1>;
template <int kN, class Real = double>
using Side = std::array<Lanes<kN, Real>, 3>;

/// Counts of kN samples, made numbers where they stand: whole numbers of several samples put
/// together first would go through memory in halves, for which a processor waits.
template <int kN>
class CountsOf {
 public:
  [[gnu::always_inline]] CountsOf(const RawSample* raw, std::size_t channels) {
    constexpr std::size_t kAtOnce = 4;
    for (std::size_t k = 0; k < static_cast<std::size_t>(kN); ++k) {
      for (std::size_t c = 0; c < channels; c += kAtOnce) {
        for (std::size_t i = c; i < c + kAtOnce; ++i) counts_[k][i] = raw[k].counts[i];
      }
    }
  }
  [[gnu::always_inline]] Lanes<kN> operator[](std::size_t channel) const {
    Lanes<kN> counts;
    for (int k = 0; k < kN; ++k) counts[k] = counts_[static_cast<std::size_t>(k)][channel];
    return counts;
  }

 private:
  static_assert(RawSample::kChannelsMax % 4 == 0);
  std::array<std::array<double, RawSample::kChannelsMax>, kN> counts_;
};

template <int kN>
[[gnu::always_inline]] inline void Linear(const GroupKernel& g, const CountsOf<kN>& counts,
                                          Side<kN>& u) {
  const Lanes<kN> x = counts[g.channel[0]], y = counts[g.channel[1]], z = counts[g.channel[2]];
  for (std::size_t i = 0; i < 3; ++i) {
    u[i] = g.A[i][0] * x + g.A[i][1] * y + g.A[i][2] * z + g.b[i];
  }
  if (g.n_channels == 4) {
    const Lanes<kN> fourth = counts[g.channel[3]];
    for (std::size_t i = 0; i < 3; ++i) u[i] += g.A[i][3] * fourth;
  }
}

/// Adds what q(of) moves u by.
template <int kN, class Real>
[[gnu::always_inline]] inline void AddProducts(const GroupKernel::Products<Real>& products,
                                               const Side<kN, Real>& of, Side<kN, Real>& sum) {
  const auto add = [&](const Real(&out)[3], const Lanes<kN, Real>& q) {
    for (std::size_t i = 0; i < 3; ++i) sum[i] += out[i] * q;
  };
  if (products.squares) {
    for (std::size_t i = 0; i < 3; ++i) add(products.out[i], of[i] * of[i]);
  }
  if (products.crosses) {
    for (std::size_t i = 0; i < 3; ++i) add(products.out[3 + i], of[i] * of[(i + 1) % 3]);
  }
}

/// Takes off what the force and the heating do.
template <int kN>
[[gnu::always_inline]] inline void TakeSmall(const GroupKernel& g, const Side<kN, float>& f,
                                             const float* heating_rate, Side<kN>& u) {
  Side<kN, float> sum;
  for (std::size_t i = 0; i < 3; ++i) {
    sum[i] = g.force[i][0] * f[0] + g.force[i][1] * f[1] + g.force[i][2] * f[2];
  }
  AddProducts<kN, float>(g.force_products, f, sum);
  if (g.heats) {
    const Lanes<kN, float> rate = Lanes<kN, float>::Map(heating_rate);
    for (std::size_t i = 0; i < 3; ++i) sum[i] -= g.heat[i] * rate;
  }
  for (std::size_t i = 0; i < 3; ++i) u[i] -= sum[i].template cast<double>();
}

/// u <- linear - what q(u) moves it by, of the lanes whose size is beyond `reach`.
template <int kN>
[[gnu::always_inline]] inline void RefineOnce(const GroupKernel& g, const Side<kN>& linear,
                                              const Lanes<kN>& size, double reach, bool all,
                                              Side<kN>& u) {
  Side<kN> sum;
  for (std::size_t i = 0; i < 3; ++i) sum[i].setZero();
  AddProducts<kN, double>(g.products, u, sum);
  for (std::size_t i = 0; i < 3; ++i) {
    const Lanes<kN> next = linear[i] - sum[i];
    if (all) {
      u[i] = next;
    } else {
      u[i] = (size > reach).select(next, u[i]);
    }
  }
}

/// The same from u_0 on, as often as a sample needs it.
template <int kN>
[[gnu::always_inline]] inline void Refine(const GroupKernel& g, Side<kN>& u) {
  const Side<kN> linear = u;
  const Lanes<kN> size = u[0].abs().max(u[1].abs()).max(u[2].abs());
  const double largest = size.maxCoeff(), smallest = size.minCoeff();
  for (std::size_t turn = 0; turn < GroupKernel::kTurns && largest > g.reach[turn]; ++turn) {
    RefineOnce<kN>(g, linear, size, g.reach[turn], smallest > g.reach[turn], u);
  }
}

template <int kN>
[[gnu::always_inline]] inline void Put(const Side<kN>& u, ImuSample* out,
                                       Eigen::Vector3d ImuSample::*member) {
  for (int k = 0; k < kN; ++k) out[k].*member = Eigen::Vector3d(u[0][k], u[1][k], u[2][k]);
}

}  // namespace wellgyro

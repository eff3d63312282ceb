#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>

#include "wellgyro/record/sample.h"

namespace wellgyro {

/// SensorGroup's formula solved for u in T at one temperature, as plain numbers:
///   u = A counts + b + heat dT/dt - force f - sum force_squares - sum squares
/// where a sum is over products of two components, of f and of u itself.
struct GroupKernel {
  /// One of the components of q, and what it moves u by.
  struct Product {
    std::size_t first = 0, second = 0;
    double out[3] = {};
  };
  /// Products that move anything.
  struct Products {
    std::size_t count = 0;
    std::array<Product, 6> each;
  };
  static constexpr std::size_t kTurns = 64;

  int n_channels = 0;
  std::array<std::size_t, 4> channel{};
  double A[3][4] = {}, b[3] = {}, heat[3] = {}, force[3][3] = {};
  bool heats = false, feels_force = false;
  Products squares, force_squares;
  std::array<double, kTurns> reach{};  ///< largest |component of u| for which so many turns do
};

/// A component of kN samples side by side: what the processor does with one number it does with
/// several at once. The arithmetic of a sample does not depend on kN nor on its neighbours.
template <int kN>
using Lanes = Eigen::Array<double, kN, 1>;
template <int kN>
using Side = std::array<Lanes<kN>, 3>;

template <int kN>
[[gnu::always_inline]] inline Lanes<kN> Counts(const RawSample* raw, std::size_t channel) {
  Lanes<kN> counts;
  for (int k = 0; k < kN; ++k) counts[k] = raw[k].counts[channel];
  return counts;
}

template <int kN>
[[gnu::always_inline]] inline void Linear(const GroupKernel& g, const RawSample* raw,
                                          const double* heating_rate, Side<kN>& u) {
  const Lanes<kN> x = Counts<kN>(raw, g.channel[0]), y = Counts<kN>(raw, g.channel[1]),
                  z = Counts<kN>(raw, g.channel[2]);
  for (std::size_t i = 0; i < 3; ++i) {
    u[i] = g.A[i][0] * x + g.A[i][1] * y + g.A[i][2] * z + g.b[i];
  }
  if (g.n_channels == 4) {
    const Lanes<kN> fourth = Counts<kN>(raw, g.channel[3]);
    for (std::size_t i = 0; i < 3; ++i) u[i] += g.A[i][3] * fourth;
  }
  if (g.heats) {
    const Lanes<kN> rate = Lanes<kN>::Map(heating_rate);
    for (std::size_t i = 0; i < 3; ++i) u[i] += g.heat[i] * rate;
  }
}

template <int kN>
[[gnu::always_inline]] inline void AddProducts(const GroupKernel::Products& products,
                                               const Side<kN>& of, Side<kN>& sum) {
  for (std::size_t p = 0; p < products.count; ++p) {
    const GroupKernel::Product& product = products.each[p];
    const Lanes<kN> q = of[product.first] * of[product.second];
    for (std::size_t i = 0; i < 3; ++i) sum[i] += product.out[i] * q;
  }
}

template <int kN>
[[gnu::always_inline]] inline void TakeForce(const GroupKernel& g, const Side<kN>& f, Side<kN>& u) {
  Side<kN> sum;
  for (std::size_t i = 0; i < 3; ++i) {
    sum[i] = g.force[i][0] * f[0] + g.force[i][1] * f[1] + g.force[i][2] * f[2];
  }
  AddProducts<kN>(g.force_squares, f, sum);
  for (std::size_t i = 0; i < 3; ++i) u[i] -= sum[i];
}

/// u <- u_0 - squares(u), as often as a sample needs it.
template <int kN>
[[gnu::always_inline]] inline void Refine(const GroupKernel& g, Side<kN>& u) {
  const Side<kN> linear = u;
  const Lanes<kN> size = u[0].abs().max(u[1].abs()).max(u[2].abs());
  const double largest = size.maxCoeff(), smallest = size.minCoeff();
  for (std::size_t turn = 0; turn < GroupKernel::kTurns && largest > g.reach[turn]; ++turn) {
    Side<kN> sum;
    for (std::size_t i = 0; i < 3; ++i) sum[i].setZero();
    AddProducts<kN>(g.squares, u, sum);
    const bool all = smallest > g.reach[turn];
    for (std::size_t i = 0; i < 3; ++i) {
      const Lanes<kN> next = linear[i] - sum[i];
      if (all) {
        u[i] = next;
      } else {
        u[i] = (size > g.reach[turn]).select(next, u[i]);
      }
    }
  }
}

template <int kN>
[[gnu::always_inline]] inline void Put(const Side<kN>& u, ImuSample* out,
                                       Eigen::Vector3d ImuSample::*member) {
  for (int k = 0; k < kN; ++k) out[k].*member = Eigen::Vector3d(u[0][k], u[1][k], u[2][k]);
}

}  // namespace wellgyro

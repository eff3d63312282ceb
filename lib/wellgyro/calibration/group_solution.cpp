#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Dense>

#include "wellgyro/calibration/group_solution_internal.h"

namespace wellgyro {
namespace {

template <class T>
T Polynomial(const std::array<T, SensorGroup::kPowers>& powers, double tau) {
  T value = powers.back();
  for (std::size_t n = powers.size() - 1; n-- > 0;) value = value * tau + powers[n];
  return value;
}

Eigen::Matrix<double, 6, 1> SquaresOf(const Eigen::Vector3d& a) {
  Eigen::Matrix<double, 6, 1> q;
  q << a.x() * a.x(), a.y() * a.y(), a.z() * a.z(), a.x() * a.y(), a.y() * a.z(), a.z() * a.x();
  return q;
}

// q(R a) = OfSquares(R) q(a).
Eigen::Matrix<double, 6, 6> OfSquares(const Eigen::Matrix3d& R) {
  constexpr int kFirst[] = {0, 1, 2, 0, 1, 2}, kSecond[] = {0, 1, 2, 1, 2, 0};
  Eigen::Matrix<double, 6, 6> M;
  for (int row = 0; row < 6; ++row) {
    const int i = kFirst[row], j = kSecond[row];
    for (int column = 0; column < 6; ++column) {
      const int k = kFirst[column], l = kSecond[column];
      M(row, column) = R(i, k) * R(j, l) + (k == l ? 0 : R(i, l) * R(j, k));
    }
  }
  return M;
}

// u in T from what the channels read; S in T.
Eigen::Matrix<double, 3, 4> Inverse(const SensorGroup::Rows& S, int n_channels) {
  Eigen::Matrix<double, 3, 4> inverse = Eigen::Matrix<double, 3, 4>::Zero();
  if (n_channels == 2) {
    inverse.topLeftCorner<2, 2>() = Eigen::Matrix2d(S.topLeftCorner<2, 2>()).inverse();
  } else if (n_channels == 3) {
    inverse.leftCols<3>() = Eigen::Matrix3d(S.topRows<3>()).inverse();
  } else {
    inverse = S.colPivHouseholderQr().solve(Eigen::Matrix4d::Identity());
  }
  return inverse;
}

// The unit vector at right angles to the three columns of S.
Eigen::Vector4d Parity(const SensorGroup::Rows& S) {
  const Eigen::Matrix4d Q = S.householderQr().householderQ();
  return Q.col(3);
}

template <int kColumns, class Real>
void Put(const Eigen::Matrix<double, 3, kColumns>& from, Real (&to)[3][kColumns]) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < kColumns; ++j) to[i][j] = static_cast<Real>(from(i, j));
  }
}

template <class Real>
GroupKernel::Products<Real> ProductsOf(const Eigen::Matrix<double, 3, 6>& out) {
  GroupKernel::Products<Real> products;
  products.squares = !out.leftCols<3>().isZero(0);
  products.crosses = !out.rightCols<3>().isZero(0);
  for (int p = 0; p < 6; ++p) {
    for (int i = 0; i < 3; ++i) products.out[p][i] = static_cast<Real>(out(i, p));
  }
  return products;
}

// Sizes e = K |u_0|, K the largest sum of a row of squares, for which n turns u <- u_0 - squares(u)
// leave less than a fiftieth of the finest count, 2^-31 of full scale. All u_n are below |u_0| s, s
// = 1 / (1 - 2 e); the first is off by e s^2 |u_0|, and each turn leaves 2 e s of it.
std::array<double, GroupKernel::kTurns> Sizes() {
  constexpr double kLeft = 1e-11;
  std::array<double, GroupKernel::kTurns> sizes{};
  for (std::size_t turns = 0; turns < sizes.size(); ++turns) {
    double low = 0, high = 0.25;
    for (int halving = 0; halving < 60; ++halving) {
      const double e = (low + high) / 2, s = 1 / (1 - 2 * e);
      const double left = std::pow(2 * e * s, static_cast<double>(turns)) * e * s * s;
      (left < kLeft ? low : high) = e;
    }
    sizes[turns] = low;
  }
  return sizes;
}

void SetReach(const Eigen::Matrix<double, 3, 6>& squares, GroupKernel& kernel) {
  static const std::array<double, GroupKernel::kTurns> kSizes = Sizes();
  const double K = squares.cwiseAbs().rowwise().sum().maxCoeff();
  for (std::size_t turn = 0; turn < kSizes.size(); ++turn) {
    kernel.reach[turn] = K > 0 ? kSizes[turn] / K : std::numeric_limits<double>::infinity();
  }
}

}  // namespace

bool GroupSolution::Prepare(const SensorGroup& group, double temperature, double seconds) {
  ahead_ += temperature - temperature_;
  temperature_ = temperature;
  const double held = std::clamp(temperature, group.min, group.max);
  const double tau = group.thermometer < 0 ? 0 : (held - group.reference) / group.half_range;
  const Eigen::Matrix3d R_ST = group.R_TS.transpose();
  const Eigen::Matrix<double, 6, 6> squares_ST = OfSquares(R_ST);
  const SensorGroup::Rows S_T = Polynomial(group.sensitivity, tau) * R_ST;
  unit_per_count_ = group.unit_per_count;
  if (group.per_second) unit_per_count_ /= seconds;
  bias_ = Polynomial(group.bias, tau);
  heating_ = group.heating;
  per_lag_ = 1 / group.heating_lag;
  g_dependence_ = Polynomial(group.g_dependence, tau) * R_ST;
  squares_ = group.second_order * squares_ST;
  g_squares_ = group.g_squared * squares_ST;
  parity_ = group.n_channels == 4 ? wellgyro::Parity(S_T) : Eigen::Vector4d::Zero();

  const Eigen::Matrix<double, 3, 4> from_units = Inverse(S_T, group.n_channels);
  kernel_.n_channels = group.n_channels;
  for (std::size_t c = 0; c < kernel_.channel.size(); ++c) {
    const std::size_t of = static_cast<int>(c) < group.n_channels ? c : 0;
    kernel_.channel[c] = static_cast<std::size_t>(group.channel[of]);
  }
  const Eigen::Matrix<double, 3, 4> from_counts = from_units * unit_per_count_.asDiagonal();
  Put(from_counts, kernel_.A);
  const Eigen::Vector3d offset = -(from_units * bias_), heat = -(from_units * heating_);
  const Eigen::Matrix3d force = from_units * g_dependence_;
  Put(force, kernel_.force);
  Eigen::Vector3d::Map(kernel_.b) = offset;
  Eigen::Vector3f::Map(kernel_.heat) = heat.cast<float>();
  kernel_.heats = !heat.isZero(0);
  kernel_.products = ProductsOf<double>(from_units * squares_);
  kernel_.second_order = kernel_.products.squares || kernel_.products.crosses;
  kernel_.force_products = ProductsOf<float>(from_units * g_squares_);
  kernel_.feels_force =
      !force.isZero(0) || kernel_.force_products.squares || kernel_.force_products.crosses;
  SetReach(from_units * squares_, kernel_);
  return group.thermometer < 0 || held == temperature;
}

double GroupSolution::Parity(const RawSample& raw, const Eigen::Vector3d& u_T,
                             const Eigen::Vector3d& f_T) const {
  Eigen::Vector4d units;
  for (int c = 0; c < 4; ++c) {
    units[c] = static_cast<double>(raw.counts[kernel_.channel[static_cast<std::size_t>(c)]]);
  }
  units = units.cwiseProduct(unit_per_count_) - bias_ - heating_ * heating_rate();
  units -= g_dependence_ * f_T + g_squares_ * SquaresOf(f_T) + squares_ * SquaresOf(u_T);
  return parity_.dot(units);
}

}  // namespace wellgyro

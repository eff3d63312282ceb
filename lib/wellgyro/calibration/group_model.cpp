#include <algorithm>
#include <cstddef>

#include <Eigen/Dense>

#include "wellgyro/calibration/group_model_internal.h"
#include "wellgyro/math/linear_algebra.h"
#include "wellgyro/record/products.h"

namespace wellgyro {
namespace {

template <class T>
T ValueAt(const std::array<T, SensorGroup::kPowers>& powers, double tau) {
  T value = powers.back();
  for (std::size_t n = powers.size() - 1; n-- > 0;) value = value * tau + powers[n];
  return value;
}

// q(R a) = OfSquares(R) q(a).
Eigen::Matrix<double, 6, 6> OfSquares(const Eigen::Matrix3d& R) {
  Eigen::Matrix<double, 6, 6> M;
  for (int row = 0; row < 6; ++row) {
    const int i = kFirstFactor[row], j = kSecondFactor[row];
    for (int column = 0; column < 6; ++column) {
      const int k = kFirstFactor[column], l = kSecondFactor[column];
      M(row, column) = R(i, k) * R(j, l) + (k == l ? 0 : R(i, l) * R(j, k));
    }
  }
  return M;
}

// u in T from what the channels read; S in T.
Eigen::Matrix<double, 3, 4> InverseOf(const SensorGroup::Rows& S, int n_channels) {
  Eigen::Matrix<double, 3, 4> inverse = Eigen::Matrix<double, 3, 4>::Zero();
  if (n_channels == 2) {
    inverse.topLeftCorner<2, 2>() = Eigen::Matrix2d(S.topLeftCorner<2, 2>()).inverse();
  } else if (n_channels == 3) {
    inverse.leftCols<3>() = Eigen::Matrix3d(S.topRows<3>()).inverse();
  } else {
    inverse = LeftInverse(S);
  }
  return inverse;
}

}  // namespace

GroupModel::GroupModel(const SensorGroup& group) : group_(group) {
  const Eigen::Matrix3d R_ST = group.R_TS.transpose();
  const Eigen::Matrix<double, 6, 6> squares_ST = OfSquares(R_ST);
  for (SensorGroup::Rows& S : group_.sensitivity) S *= R_ST;
  for (SensorGroup::Rows& G : group_.g_dependence) G *= R_ST;
  group_.second_order *= squares_ST;
  group_.g_squared *= squares_ST;
  heats_ = !group_.heating.isZero(0);
  feels_force_ = std::any_of(group_.g_dependence.begin(), group_.g_dependence.end(),
                             [](const SensorGroup::Rows& G) { return !G.isZero(0); });
  second_order_ = !group_.second_order.isZero(0);
  g_squared_ = !group_.g_squared.isZero(0);
}

double GroupModel::Tau(double temperature) const {
  if (group_.thermometer < 0) return 0;
  return (std::clamp(temperature, group_.min, group_.max) - group_.reference) / group_.half_range;
}

SensorGroup::Rows GroupModel::Sensitivity(double tau) const {
  return ValueAt(group_.sensitivity, tau);
}

SensorGroup::Column GroupModel::Bias(double tau) const { return ValueAt(group_.bias, tau); }

GroupNode GroupModel::At(double tau) const {
  GroupNode node;
  const Eigen::Matrix<double, 3, 4> from_units = InverseOf(Sensitivity(tau), group_.n_channels);
  node.A = from_units * group_.unit_per_count.asDiagonal();
  node.b_T = -(from_units * Bias(tau));
  // What a group lacks costs nothing.
  if (heats_) node.heat_T = from_units * group_.heating;
  if (feels_force_) node.u_by_force_T = from_units * ValueAt(group_.g_dependence, tau);
  if (second_order_) node.products = from_units * group_.second_order;
  if (g_squared_) node.force_products = from_units * group_.g_squared;
  return node;
}

double GroupModel::Parity(const RawSample& raw, double tau, double seconds, double heating_rate,
                          const Eigen::Vector3d& u_T, const Eigen::Vector3d& f_T) const {
  SensorGroup::Column units;
  for (int c = 0; c < 4; ++c) {
    const auto place = static_cast<std::size_t>(group_.channel[static_cast<std::size_t>(c)]);
    units[c] = static_cast<double>(raw.counts[place]);
  }
  units = units.cwiseProduct(group_.unit_per_count);
  if (group_.per_second) units /= seconds;
  units -= Bias(tau) + group_.heating * heating_rate;
  units -= ValueAt(group_.g_dependence, tau) * f_T + group_.g_squared * ProductsOf(f_T) +
           group_.second_order * ProductsOf(u_T);
  // The unit vector at right angles to the three columns of S.
  return UnitBeside(Sensitivity(tau)).dot(units);
}

}  // namespace wellgyro

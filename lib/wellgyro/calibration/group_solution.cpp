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

}  // namespace

bool GroupSolution::Prepare(const SensorGroup& group, double temperature, double seconds) {
  n_channels_ = group.n_channels;
  temperature_ = temperature;
  const double held = std::clamp(temperature, group.min, group.max);
  const double tau = group.thermometer < 0 ? 0 : (held - group.reference) / group.half_range;
  for (std::size_t c = 0; c < channel_.size(); ++c)
    channel_[c] =
        static_cast<std::size_t>(group.channel[static_cast<int>(c) < n_channels_ ? c : 0]);

  R_ST_ = group.R_TS.transpose();
  const SensorGroup::Rows S_T = Polynomial(group.sensitivity, tau) * R_ST_;
  unit_per_count_ = group.unit_per_count;
  if (group.per_second) unit_per_count_ /= seconds;
  bias_ = Polynomial(group.bias, tau);
  heating_ = group.heating;
  g_dependence_T_ = Polynomial(group.g_dependence, tau) * R_ST_;
  second_order_terms_ = group.second_order;
  g_squared_terms_ = group.g_squared;

  from_units_ = Inverse(S_T, n_channels_);
  from_counts_ = from_units_ * unit_per_count_.asDiagonal();
  from_force_ = from_units_ * g_dependence_T_;
  from_squares_ = from_units_ * second_order_terms_;
  from_force_squares_ = from_units_ * g_squared_terms_;
  second_order_ = !from_squares_.isZero(0);
  g_dependent_ = !from_force_.isZero(0);
  g_squared_ = !from_force_squares_.isZero(0);
  parity_ = n_channels_ == 4 ? wellgyro::Parity(S_T) : Eigen::Vector4d::Zero();
  if (!settled_) Settle();
  Offset();
  return group.thermometer < 0 || held == temperature;
}

void GroupSolution::Offset() { offset_ = -(from_units_ * (bias_ + heating_ * heating_rate_)); }

void GroupSolution::Settle() {
  settled_ = true;
  lagged_ = temperature_;
  heating_rate_ = 0;
  Offset();
}

void GroupSolution::Heat(const SensorGroup& group, double seconds) {
  lagged_ += (temperature_ - lagged_) * -std::expm1(-seconds / group.heating_lag);
  heating_rate_ = (temperature_ - lagged_) / group.heating_lag;
  Offset();
}

Eigen::Vector3d GroupSolution::Linear(const RawSample& raw) const {
  // Channels that the group does not have are the first one again, with a gain of zero.
  Eigen::Vector3d u = offset_;
  for (int c = 0; c < 3; ++c)
    u += from_counts_.col(c) *
         static_cast<double>(raw.counts[channel_[static_cast<std::size_t>(c)]]);
  if (n_channels_ == 4) u += from_counts_.col(3) * static_cast<double>(raw.counts[channel_[3]]);
  return u;
}

Eigen::Vector3d GroupSolution::Refine(const Eigen::Vector3d& linear) const {
  if (!second_order_) return linear;
  // Contracts by 2 |K u| / |S| a turn.
  constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon();
  constexpr int kTurns = 40;
  Eigen::Vector3d u = linear;
  for (int turn = 0; turn < kTurns; ++turn) {
    const Eigen::Vector3d next = linear - from_squares_ * SquaresOf(R_ST_ * u);
    const double change = (next - u).cwiseAbs().maxCoeff();
    u = next;
    if (!(change > kRounding * u.cwiseAbs().maxCoeff())) break;
  }
  return u;
}

Eigen::Vector3d GroupSolution::Solve(const RawSample& raw, const Eigen::Vector3d& f_T) const {
  Eigen::Vector3d u = Linear(raw);
  if (g_dependent_) u -= from_force_ * f_T;
  if (g_squared_) u -= from_force_squares_ * SquaresOf(R_ST_ * f_T);
  return Refine(u);
}

double GroupSolution::Parity(const RawSample& raw, const Eigen::Vector3d& u_T,
                             const Eigen::Vector3d& f_T) const {
  Eigen::Vector4d units;
  for (int c = 0; c < 4; ++c)
    units[c] = static_cast<double>(raw.counts[channel_[static_cast<std::size_t>(c)]]);
  units = units.cwiseProduct(unit_per_count_) - bias_ - heating_ * heating_rate_;
  units -= g_dependence_T_ * f_T + g_squared_terms_ * SquaresOf(R_ST_ * f_T) +
           second_order_terms_ * SquaresOf(R_ST_ * u_T);
  return parity_.dot(units);
}

}  // namespace wellgyro

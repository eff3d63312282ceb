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

}  // namespace

bool GroupSolution::Prepare(const SensorGroup& group, double temperature, double seconds) {
  n_channels_ = group.n_channels;
  temperature_ = temperature;
  const double held = std::clamp(temperature, group.min, group.max);
  const double tau = group.thermometer < 0 ? 0 : (held - group.reference) / group.half_range;
  for (std::size_t c = 0; c < channel_.size(); ++c) {
    channel_[c] =
        static_cast<std::size_t>(group.channel[static_cast<int>(c) < n_channels_ ? c : 0]);
  }

  const Eigen::Matrix3d R_ST = group.R_TS.transpose();
  const Eigen::Matrix<double, 6, 6> squares_ST = OfSquares(R_ST);
  const SensorGroup::Rows S_T = Polynomial(group.sensitivity, tau) * R_ST;
  unit_per_count_ = group.unit_per_count;
  if (group.per_second) unit_per_count_ /= seconds;
  bias_ = Polynomial(group.bias, tau);
  heating_ = group.heating;
  g_dependence_ = Polynomial(group.g_dependence, tau) * R_ST;
  squares_ = group.second_order * squares_ST;
  g_squares_ = group.g_squared * squares_ST;

  from_units_ = Inverse(S_T, n_channels_);
  from_counts_ = from_units_ * unit_per_count_.asDiagonal();
  from_force_ = from_units_ * g_dependence_;
  from_squares_ = from_units_ * squares_;
  from_force_squares_ = from_units_ * g_squares_;
  second_order_ = !from_squares_.isZero(0);
  feels_force_ = !from_force_.isZero(0) || !from_force_squares_.isZero(0);
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

LinearPart GroupSolution::linear() const {
  return {from_counts_.leftCols<3>(), offset_, channel_[0], channel_[1], channel_[2]};
}

Eigen::Vector3d GroupSolution::Fourth(const RawSample& raw) const {
  return from_counts_.col(3) * static_cast<double>(raw.counts[channel_[3]]);
}

Eigen::Vector3d GroupSolution::OfForce(const Eigen::Vector3d& f_T) const {
  Eigen::Vector3d u = from_force_ * f_T;
  if (g_squared_) u += from_force_squares_ * SquaresOf(f_T);
  return -u;
}

Eigen::Vector3d GroupSolution::Refine(const Eigen::Vector3d& linear) const {
  // Contracts by 2 |K u| / |S| a turn.
  constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon();
  constexpr int kTurns = 40;
  Eigen::Vector3d u = linear;
  for (int turn = 0; turn < kTurns; ++turn) {
    const Eigen::Vector3d next = linear - from_squares_ * SquaresOf(u);
    const double change = (next - u).cwiseAbs().maxCoeff();
    u = next;
    if (!(change > kRounding * u.cwiseAbs().maxCoeff())) break;
  }
  return u;
}

double GroupSolution::Parity(const RawSample& raw, const Eigen::Vector3d& u_T,
                             const Eigen::Vector3d& f_T) const {
  Eigen::Vector4d units;
  for (int c = 0; c < 4; ++c) {
    units[c] = static_cast<double>(raw.counts[channel_[static_cast<std::size_t>(c)]]);
  }
  units = units.cwiseProduct(unit_per_count_) - bias_ - heating_ * heating_rate_;
  units -= g_dependence_ * f_T + g_squares_ * SquaresOf(f_T) + squares_ * SquaresOf(u_T);
  return parity_.dot(units);
}

}  // namespace wellgyro

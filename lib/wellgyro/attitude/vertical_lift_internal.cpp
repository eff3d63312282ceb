#include "wellgyro/attitude/vertical_lift_internal.h"

#include <algorithm>
#include <cmath>

#include "wellgyro/attitude/tracker_angles_internal.h"

namespace wellgyro::vertical {
namespace {

constexpr double kSameSeconds = 1e-6;

}  // namespace

void LiftSums::Add(const Sensed& s, const Eigen::Matrix3d& R_LT, double axial_rate) {
  const double across = std::hypot(R_LT(2, 0), R_LT(2, 1));
  const double c = across > 0 ? -R_LT(2, 0) / across : 1, sn = across > 0 ? R_LT(2, 1) / across : 0;
  const double spin = axial_rate * s.seconds, regain = tracker::InverseSinc(spin);
  const Eigen::Vector2d angle = s.w_IT_T.head<2>() * (s.seconds * regain);
  const Eigen::Vector2d force = s.gravity_T.head<2>() * regain;
  const double high = force.x() * c - force.y() * sn;
  part_ << s.seconds, angle.x() * sn + angle.y() * c, angle.x() * c - angle.y() * sn,
      std::atan2(high, -s.gravity_T.z()) * s.seconds, c * s.seconds, sn * s.seconds, spin * c,
      spin * sn, angle.x() * sn, angle.y() * c, high * s.seconds;
  part_level_ = s.accel_good;
  level_ = level_ && s.accel_good;
  sums_ += part_;
  open_ += part_;
}

void LiftSums::Roll(const Sums& open, const Knot::SourceVector& d_toolface) {
  rolled_ += Eigen::Vector3d(open[kUnitC], open[kUnitS], open[kAcross]) * d_toolface.transpose();
}

void LiftSums::TakeToolface(const Knot::SourceVector& d_toolface, double regained) {
  if (open_[kSeconds] > 0) {
    sums_[kSpinC] += regained * open_[kUnitC] / open_[kSeconds];
    sums_[kSpinS] += regained * open_[kUnitS] / open_[kSeconds];
  }
  Roll(open_, d_toolface);
  open_.setZero();
}

Lift LiftSums::Of(const Sums& done) const {
  Lift lift;
  lift.lift = done[kLift];
  lift.inclination_accel = done[kLevel] / done[kSeconds];
  lift.level = level_;
  lift.rolled = {done[kUnitC], done[kUnitS]};
  lift.rolled_toolface = rolled_.topRows<2>();
  // As in HighSideTracker, of V_r alone: a toolface too large by d turns V by d.
  Knot::SourceVector& d = lift.d_lift;
  d = rolled_.row(2).transpose();
  d[Knot::kGyroBiasX] += done[kUnitS];
  d[Knot::kGyroBiasY] += done[kUnitC];
  d[Knot::kQuadrature] -= done[kForce];
  d[Knot::kGyroScaleX] += done[kScaleX];
  d[Knot::kGyroScaleY] += done[kScaleY];
  d[Knot::kMisalignmentX] += done[kSpinS];
  d[Knot::kMisalignmentY] += done[kSpinC];
  return lift;
}

std::optional<Lift> LiftSums::Cut(double rest, double seconds,
                                  const Knot::SourceVector& d_toolface) {
  const double share = part_[kSeconds] > 0 ? std::clamp(rest / part_[kSeconds], 0.0, 1.0) : 0;
  const Sums left = share * part_, done = sums_ - left;
  Roll(open_ - left, d_toolface);
  std::optional<Lift> lift;
  const bool whole = done[kSeconds] > 0 && std::abs(done[kSeconds] - seconds) < kSameSeconds;
  if (whole && !broken_) lift = Of(done);
  sums_ = open_ = left;
  rolled_.setZero();
  level_ = share > 0 ? part_level_ : true;
  broken_ = false;
  return lift;
}

}  // namespace wellgyro::vertical

#include "wellgyro/survey/hole/node_attitude.h"

#include <algorithm>
#include <cmath>

#include "wellgyro/base/angle.h"
#include "wellgyro/estimate/node.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/math/so3.h"
#include "wellgyro/math/square.h"
#include "wellgyro/record/force_errors.h"
#include "wellgyro/record/unknown_angle.h"

namespace wellgyro {
namespace {

using Eigen::Matrix3d;

// Least sin I in d azimuth / d phi = 1 / sin I. There every attitude's sigma above 2e-9 rad gives
// an azimuth's beyond that of a uniform distribution, which is what it is then set to.
constexpr double kLeastSine = 1e-9;

/// d(inclination, azimuth, toolface) / d phi, by R_LT Exp(phi).
Matrix3d AnglesByPhi(double inclination, double toolface) {
  const double s = std::max(std::sin(inclination), kLeastSine), c = std::cos(inclination);
  const double st = std::sin(toolface), ct = std::cos(toolface);
  Matrix3d slope;
  slope.row(0) << st, ct, 0;
  slope.row(1) << -ct / s, st / s, 0;
  slope.row(2) = Eigen::RowVector3d::UnitZ() - c * slope.row(1);
  return slope;
}

void ForgetAngle(int i, AttitudeSample& a) {
  a.cov_attitude.row(i).setZero();
  a.cov_attitude.col(i).setZero();
  a.cov_attitude(i, i) = kUnknownAngleVariance;
}

}  // namespace

AttitudeSample AttitudeOf(const RunKnot& knot, const Matrix3d& R, const Matrix3d& cov_phi_T) {
  AttitudeSample a;
  a.time = knot.increment.time;
  a.inclination = InclinationOf(R.col(2));
  a.azimuth = AzimuthOf(R.col(2));
  a.toolface = std::atan2(R(2, 1), -R(2, 0));
  a.azimuth_known = true;
  a.quality = Without(knot.increment.quality, Quality::kVertical);
  const Matrix3d slope = AnglesByPhi(a.inclination, a.toolface);
  a.cov_attitude = slope * cov_phi_T * slope.transpose();
  if (a.cov_attitude(1, 1) > kVagueAngle * kVagueAngle) a.quality |= Quality::kVertical;
  for (const int i : {1, 2}) {
    if (!(a.cov_attitude(i, i) < kUnknownAngleVariance)) ForgetAngle(i, a);
  }
  return a;
}

AttitudeSample LevelOf(const RunKnot& knot, const ErrorPriors& errors, double gravity) {
  AttitudeSample a;
  const Eigen::Vector3d& f = knot.increment.force_M;
  const double across = std::hypot(f.x(), f.y());
  a.time = knot.increment.time;
  a.inclination = std::atan2(across, -f.z());
  a.toolface = WrapPi(std::atan2(-f.y(), f.x()) + knot.increment.roll_after);
  a.quality = Without(knot.increment.quality, Quality::kVertical);
  const auto by = ForceErrors(errors, f);
  const double sine = std::max(across / gravity, kLeastSine), high = std::atan2(f.y(), f.x());
  const Eigen::RowVector3d up(std::cos(high), std::sin(high), 0);
  const Eigen::RowVector3d tilt =
      (across * Eigen::RowVector3d::UnitZ() - f.z() * up) / f.squaredNorm();
  const Eigen::RowVector3d turn = Eigen::RowVector3d(up.y(), -up.x(), 0) / (sine * gravity);
  a.cov_attitude(0, 0) = (tilt * by).squaredNorm();
  a.cov_attitude(1, 1) = kUnknownAngleVariance;
  a.cov_attitude(2, 2) = std::min((turn * by).squaredNorm(), kUnknownAngleVariance);
  if (a.cov_attitude(0, 0) >= Square(kVagueAngle * sine)) a.quality |= Quality::kVertical;
  return a;
}

void ForgetAzimuth(AttitudeSample& a) {
  a.azimuth_known = false;
  const double leans = kVagueAngle * std::sin(a.inclination);
  if (a.cov_attitude(0, 0) < leans * leans) a.quality = Without(a.quality, Quality::kVertical);
  ForgetAngle(1, a);
}

StationState StateOf(std::size_t index, const RunKnot& knot, const AttitudeSample& attitude,
                     const Matrix3d& R_LT, const LinkedErrors& errors) {
  StationState state;
  state.knot = index;
  state.attitude = attitude;
  state.along = knot.along;
  state.cov = errors.cov;
  state.cov_with_previous = errors.cov_with_previous;
  state.tangent_by_phi_L = TangentByPhi(R_LT);
  return state;
}

StationState StateOf(std::size_t index, const RunKnot& knot, const AttitudeSample& level) {
  LinkedErrors errors;
  const Matrix3d R_LT = AttitudeMatrix(level.azimuth, level.inclination, level.toolface);
  // Of the lean in both directions, and of a heading of which nothing is known.
  const Eigen::Vector3d down_T = R_LT.row(2).transpose();
  errors.cov = level.cov_attitude(0, 0) * Matrix3d::Identity() +
               kUnknownAngleVariance * down_T * down_T.transpose();
  return StateOf(index, knot, level, R_LT, errors);
}

}  // namespace wellgyro

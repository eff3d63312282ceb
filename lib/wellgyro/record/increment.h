#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "wellgyro/base/time.h"
#include "wellgyro/record/error_source.h"
#include "wellgyro/record/quality.h"

namespace wellgyro {

/// What the sensors say of the tool's motion between two instants, the knot's ends, free of any
/// attitude: a preintegrated increment.
///
/// M is the tool's frame at the knot's middle, turned about the axis with the tool: a vector of T
/// at time t reads Rz(psi(t) - psi(middle)) v_T in it, psi being the tool's inertial roll. So U = M
/// does not turn about the axis, and a rotation vector across the axis simply sums:
///   R_IT(end) = R_IT(begin) Rz(roll_before) Exp(turn) Rz(roll_after), turn and its axial part 0.
/// What turns about the axis because turns do not commute (coning) stands in the rolls. T is the
/// accelerometers' frame where the gyros' is turned against it.
/// With psi in error by a straight line through the middle that grows by delta over the knot
/// (estimate psi + delta (t - t_middle)/seconds) the increment is that of
///   roll_before + delta/2, turn + turn_per_roll delta, roll_after + delta/2, force +
///   force_per_roll delta.
/// psi is known inside the knot only: from one knot to the next it is the estimator's business.
/// All sums are exact to the third order of the turn within a sample (mean rates in, de-averaged).
struct Increment {
  ToolTime time;           ///< end of the knot
  double seconds = 0;      ///< its length
  double roll_before = 0;  ///< psi(middle) - psi(begin) [rad], not wrapped
  double roll_after = 0;   ///< psi(end) - psi(middle) [rad]
  double roll() const { return roll_before + roll_after; }  ///< psi(end) - psi(begin) [rad]
  Eigen::Vector2d turn_M = Eigen::Vector2d::Zero();         ///< over the knot [rad]
  Eigen::Vector2d turn_before_M = Eigen::Vector2d::Zero();  ///< up to the middle [rad]
  /// Mean specific force, each instant's turned back to the middle by the knot's own turn [m/s^2].
  Eigen::Vector3d force_M = Eigen::Vector3d::Zero();
  Eigen::Vector2d turn_per_roll = Eigen::Vector2d::Zero();   ///< [1]
  Eigen::Vector2d force_per_roll = Eigen::Vector2d::Zero();  ///< [m/s^2 per rad]
  /// d turn_M / d error, of the kTurnSources, and d force_M / d error, of the kForceSources behind
  /// them (of the reading, uncorrected). Those of kMisalignment and kTimeSkew hold for the roll
  /// rate of psi.
  Eigen::Matrix<double, 2, kTurnSources> turn_by_error =
      Eigen::Matrix<double, 2, kTurnSources>::Zero();
  Eigen::Matrix<double, 3, kForceSources> force_by_error =
      Eigen::Matrix<double, 3, kForceSources>::Zero();
  /// psi follows gravity as the accelerometers show it, whose errors go round with the tool: of a
  /// wobble of the phase once a turn, and twice, the shares that psi has. 0: a third axis.
  Eigen::Vector2d wobble_followed = Eigen::Vector2d::Zero();
  /// Integrals of the transverse rates, not turned, and turned by 2, -1 and 3 times psi from the
  /// middle on: what wobbles turn [rad].
  Eigen::Matrix<double, 2, 4> turn_by_harmonic = Eigen::Matrix<double, 2, 4>::Zero();
  /// Of an accelerometer's source.
  auto ForceBy(int source) { return force_by_error.col(source - kTurnSources); }
  auto ForceBy(int source) const { return force_by_error.col(source - kTurnSources); }
  bool has_axial = false;  ///< psi is the integral of a third gyro axis
  /// Variance of turn_M beyond the gyros' white noise: what the last order kept leaves out, per
  /// component [rad^2]. Whirl and roll of half the sampling rate pass unseen.
  double var_turn = 0;
  /// 1-sigma of what gravity says of the roll over the knot, the change of psi, by noise alone and
  /// from this knot's samples alone [rad]; 2 pi where there are none.
  double sigma_roll = 0;
  /// Variance of force_M across gravity, about the axis, over that of the accelerometers' mean: psi
  /// follows their noise, or what a third axis did between its samples is not known.
  double lateral = 1;
  bool roll_seen = false;  ///< psi follows gravity (or a third axis) all through the knot
  bool level = true;       ///< force_M counts: of half the knot, off full scale and outside gaps
  double gap_seconds = 0;  ///< of the knot, without usable gyro samples: turn goes on as before it
  std::int64_t seq_begin = 0;     ///< first sample
  std::int64_t seq_end = 0;       ///< exclusive
  std::int64_t samples_lost = 0;  ///< in that range
  Quality quality = Quality::kGood;
};

}  // namespace wellgyro

#pragma once

#include "wellgyro/base/export.h"

namespace wellgyro {

/// Toolface of a tool with a third gyro axis: that gyro's where the tool turns to and fro,
/// gravity's in the long run.
///
/// Gravity's toolface carries the noise of the accelerometers and whatever shakes them: an arm of
/// 2 cm and 2 deg of roll at 2 Hz read as 0.7 deg too much, and what their filter takes away they
/// do not see at all. The axial rate has none of that, and only drifts. Two equal time constants,
/// so that a bias leaves nothing, nor what the hole's own turning adds to the rate about the axis;
/// an error of scale leaves at most its share of a change of the roll rate times a quarter of
/// `seconds`. The mean over a sample is told to third order in what the tool turns in it.
class WELLGYRO_EXPORT RollObserver {
 public:
  /// `seconds`: time constant, over which gravity corrects.
  explicit RollObserver(double seconds) : seconds_(seconds) {}

  /// A sample of length `dt` [s] which turned by `spin`, its mean force at (cos, sin) of the
  /// toolface, which take their corrected values. `spin` is the gyro's, less what the hole's own
  /// turning adds. Not `trusted`: the force says nothing.
  void Take(double spin, double dt, bool trusted, double& cosine, double& sine);

  /// Samples are missing, or have no third axis: begins anew.
  void Forget() { samples_ = 0; }

  /// Variance of its toolface [rad^2], where white noise of density `noise` [rad sqrt(s)] is on
  /// that of gravity.
  double Variance(double noise) const;

 private:
  double seconds_;
  double toolface_ = 0;  ///< at the end of the last sample [rad]
  double drift_ = 0;     ///< what the gyro's rate lacks [rad/s]
  double spin_ = 0;      ///< of the last sample [rad]
  double dt_ = 1;        ///< of the last sample [s]
  double samples_ = 0;   ///< since it began, as far as they count
};

}  // namespace wellgyro

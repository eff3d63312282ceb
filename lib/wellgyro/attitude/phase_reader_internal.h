#pragma once

#include "wellgyro/attitude/roll_smoother_internal.h"

namespace wellgyro::increment {

struct PhaseOptions {
  double accel_noise = 0;  ///< [m/s^2 sqrt(s)]
  double accel_bias = 0;   ///< across the axis [m/s^2]
  double gravity = 0;      ///< [m/s^2]
};

/// Measures the inertial roll of a block, psi' = T' + A' cos I with A' sin I = -Re(W e^{iT}),
/// W = wx + i wy. The toolface T is the phase of the mean force across the axis; the second term,
/// the azimuth's own turning, comes from the gyros. A third gyro axis gives psi' by itself.
class PhaseReader {
 public:
  explicit PhaseReader(const PhaseOptions& options) : options_(options) {}
  /// Fills phase, weight and link of the youngest block, and mends the phase of the one two before
  /// it, which is final then.
  void Read(Blocks& blocks);

 private:
  void ReadGyro(bool follows, Block& block);
  void ReadGravity(Block& block);

  PhaseOptions options_;
  double across_ = 0;  ///< |force across| / g, over the last second
  double swept_ = 0, phase_ = 0, rate_ = 0, axial_ = 0;
  bool started_ = false, seen_ = false, had_gyro_ = false;
};

}  // namespace wellgyro::increment

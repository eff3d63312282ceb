#pragma once

#include <optional>

#include "wellgyro/base/time.h"

namespace wellgyro {

/// Some twenty seconds of a run as the tool went through them, and how well the residuals there are
/// what the noise that the job states would make them.
struct RunStretch {
  UtcTime begin, end;
  std::optional<double> md;     ///< the last that was known in it [m]
  std::optional<double> speed;  ///< mean along the hole, down positive [m/s]
  double roll_rate = 0;         ///< mean, by the right hand about the axis down the hole [rad/s]
  double temperature = 0;       ///< of the tool, mean [degC]
  double samples_lost = 0;      ///< by sequence number, those between two knots counted once
  /// Root mean square of the whitened residuals, each over its own sigma: 1 where noise and model
  /// are as stated. Absent where there are none.
  std::optional<double> residual_gyro, residual_accel;
};

}  // namespace wellgyro

#pragma once

#include <span>

#include "wellgyro/base/export.h"
#include "wellgyro/earth/earth.h"
#include "wellgyro/record/noise.h"
#include "wellgyro/record/north_fix.h"
#include "wellgyro/record/sample.h"

namespace wellgyro {

struct GyrocompassSetup {
  NoiseCoefficients gyro = {};
  ErrorPriors errors = {};
  double sigma_gravity_ref = kSigmaGravity;  ///< of Site::gravity against the true one [m/s^2]
};

/// Finds north from the Earth's rotation in windows at rest at one place, one or more of which may
/// be at other index positions (same axis, other toolface).
///
/// Least squares with priors over the attitude of the axis, the toolface of each window, the
/// sensors' errors (by `errors`; zero: known to be none) and the latitude, with the Earth's rate
/// known: unlike azimuth by atan2 of the two rates it stays finite towards horizontal
/// (sigma = s / (We cos L) / sqrt(cos^2 A + sin^2 A cos^2 I) for rate noise s). Gyro biases are
/// estimated; without a prior they are taken as zero for a single toolface, and as free where
/// toolfaces separate them. A third gyro axis is used where every window has it.
///
/// `toolface` is that of the last window. The covariance holds noise over the windows, bias
/// instability and rate random walk between them, and the priors. Two axes see azimuths A and
/// 180 deg - A nearly alike: the second minimum is kept (`mirror_azimuth`) while its cost is within
/// 9 of the best, and flagged kMirror. Near east-west and horizontal the two run into one: where
/// the cost between them rises by less than 4, azimuth and variance are the posterior's over both.
/// Where the axis is vertical within 3 sigma, kVertical is set; azimuth and toolface alone mean
/// little (variances up to pi^2/3), their sum is still good, and the covariance says both. kGravity
/// and kEarthRate are set beyond 3 of their own sigmas.
///
/// Throws std::invalid_argument for no windows, values not finite, or a window without length.
WELLGYRO_EXPORT NorthFix Gyrocompass(std::span<const StillWindow> windows, const Site& site,
                                     const GyrocompassSetup& setup);

}  // namespace wellgyro

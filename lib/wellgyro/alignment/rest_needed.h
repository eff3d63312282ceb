#pragma once

#include <optional>

#include "wellgyro/base/export.h"
#include "wellgyro/record/noise.h"

namespace wellgyro {

/// How long a tool must rest until the white noise of its gyros leaves no more than `sigma_azimuth`
/// [rad] of its axis's azimuth, by the sigma that Gyrocompass() reaches:
///   t = (N / (sigma We cos L))^2 / (cos^2 A + sin^2 A cos^2 I),  N = gyro.angle_random_walk.
///
/// It is the least: biases and what else errs come on top. Angles in [rad], of which inclination
/// and azimuth need be known by a few degrees only. Nothing where it is more than a day: at a pole,
/// or horizontal and east-west.
WELLGYRO_EXPORT std::optional<double> RestForSigma(double sigma_azimuth,
                                                   const NoiseCoefficients& gyro, double latitude,
                                                   double inclination, double azimuth);

}  // namespace wellgyro

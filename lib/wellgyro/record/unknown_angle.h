#pragma once

#include <Eigen/Core>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/export.h"

namespace wellgyro {

/// Variance of an angle of which nothing is known: flat round the circle [rad^2].
inline constexpr double kUnknownAngleVariance = kPi * kPi / 3;

/// From this sigma on the first order is not what an angle is: sine and angle part by 2 % [rad].
inline constexpr double kVagueAngle = 20 * kPi / 180;

/// Azimuth and toolface in a covariance of (inclination, azimuth, toolface) [rad^2] become no
/// vaguer than that; correlations stay.
WELLGYRO_EXPORT void CapAtUnknown(Eigen::Matrix3d* cov_attitude);

}  // namespace wellgyro

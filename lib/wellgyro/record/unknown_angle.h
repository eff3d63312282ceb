#pragma once

#include "wellgyro/base/angle.h"

namespace wellgyro {

/// Variance of an angle of which nothing is known: flat round the circle [rad^2].
inline constexpr double kUnknownAngleVariance = kPi * kPi / 3;

/// From this sigma on the first order is not what an angle is: sine and angle part by 2 % [rad].
inline constexpr double kVagueAngle = 20 * kPi / 180;

}  // namespace wellgyro

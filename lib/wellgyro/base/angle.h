#pragma once

#include <cmath>
#include <numbers>

/// @file
/// Degrees and radians, and angles within one turn.
namespace wellgyro {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kTwoPi = 2 * std::numbers::pi;

/// Degrees to radians, for the edges: inside the library every angle is in radians.
constexpr double FromDegrees(double degrees) { return degrees * (kPi / 180); }
/// Radians to degrees, likewise.
constexpr double ToDegrees(double radians) { return radians * (180 / kPi); }

/// The same direction in (-pi, pi]; NaN of what is not finite. Exact for arguments already inside;
/// the error of the reduction grows with |angle| as one rounding of 2 pi per turn.
inline double WrapPi(double angle) {
  const double wrapped = std::remainder(angle, kTwoPi);
  return wrapped <= -kPi ? kPi : wrapped;
}

/// The same direction in [0, 2 pi), as azimuths are written; NaN of what is not finite.
inline double WrapTwoPi(double angle) {
  if (angle >= 0 && angle < kTwoPi) return angle;
  const double wrapped = std::remainder(angle, kTwoPi);
  const double positive = wrapped < 0 ? wrapped + kTwoPi : wrapped;
  return positive >= kTwoPi ? 0 : positive;  // NaN stays
}

}  // namespace wellgyro

#pragma once

#include <algorithm>
#include <cstdint>

#include <Eigen/Core>

#include "wellgyro/alignment/still_detector.h"
#include "wellgyro/base/angle.h"
#include "wellgyro/record/quality.h"

namespace wellgyro {

/// Slower than this a tool is at rest [m/s].
inline constexpr double kRestSpeed = StillSetup{}.speed_limit;
inline constexpr Quality kUnseen = Quality::kGap | Quality::kSaturated;
/// About a heading that may be further off nothing is made linear: the slope of the Earth's rate
/// changes by a tenth within this sigma. Let through up to 20 deg, a run that rolls in a vertical
/// hole learned an inclination from it that was eight sigmas off.
inline constexpr double kRoughHeading = 5 * kPi / 180;  // [rad]
inline constexpr std::int64_t kSameNs = 2;              ///< one place, cut twice and rounded

inline constexpr std::int64_t kKnotNs = 1'000'000'000;  ///< from knot to knot on the way

/// Gravity across the tool turns by more than a right angle, and is such that no noise makes it.
inline bool TurnsFar(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  constexpr double kSeenAcross = 1;  // [m/s^2]
  const double least = std::min(from.squaredNorm(), to.squaredNorm());
  return from.dot(to) < 0 && least > kSeenAcross * kSeenAcross;
}

}  // namespace wellgyro

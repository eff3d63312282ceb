#pragma once

#include <cstdint>

#include "wellgyro/alignment/still_detector.h"
#include "wellgyro/record/quality.h"

namespace wellgyro {

/// Slower than this a tool is at rest [m/s].
inline constexpr double kRestSpeed = StillSetup{}.speed_limit;
inline constexpr Quality kUnseen = Quality::kGap | Quality::kSaturated;
inline constexpr std::int64_t kSameNs = 2;  ///< one place, cut twice and rounded

}  // namespace wellgyro

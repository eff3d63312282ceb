#pragma once

#include "wellgyro/alignment/still_detector.h"

namespace wellgyro {

/// Slower than this a tool is at rest [m/s].
inline constexpr double kRestSpeed = StillSetup{}.speed_limit;

}  // namespace wellgyro

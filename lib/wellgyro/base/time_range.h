#pragma once

#include <cstdint>

#include "wellgyro/base/time.h"

namespace wellgyro {

/// The largest time and count that is taken from outside: 127 years in nanoseconds. Sums and
/// differences of two stay inside int64.
inline constexpr std::int64_t kFarthest = 4'000'000'000'000'000'000;

constexpr bool IsWithinReach(std::int64_t value) { return value > -kFarthest && value < kFarthest; }
template <class Clock>
constexpr bool IsWithinReach(Instant<Clock> time) {
  return IsWithinReach(time.ns);
}

}  // namespace wellgyro

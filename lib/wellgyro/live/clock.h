#pragma once

#include <cstdint>
#include <functional>

namespace wellgyro {

inline constexpr std::int64_t kSecondUs = 1'000'000;

/// The clocks of the program that runs a live session: the library itself reads none, so that a
/// test may give it any time. Both are called from several threads.
struct LiveClock {
  std::function<std::int64_t()> utc_us;        ///< since 1970 [us]
  std::function<std::int64_t()> monotonic_us;  ///< for lengths of time [us]
};

}  // namespace wellgyro

#pragma once

#include <compare>
#include <cstdint>
#include <limits>

/// @file
/// Instants of the tool's clock and of the surface's, and lengths of time.
namespace wellgyro {

/// A length of time [ns]. Integer, so that sums over days stay exact.
struct Duration {
  std::int64_t ns = 0;

  /// To the nearest nanosecond. Beyond 292 years the longest there is; of NaN the least.
  static constexpr Duration Seconds(double s) {
    const double ns = s * 1e9 + (s < 0 ? -0.5 : 0.5);
    if (ns >= 0x1p63) return {std::numeric_limits<std::int64_t>::max()};
    if (!(ns >= -0x1p63)) return {std::numeric_limits<std::int64_t>::min()};
    return {static_cast<std::int64_t>(ns)};
  }
  constexpr double seconds() const { return static_cast<double>(ns) * 1e-9; }

  friend constexpr auto operator<=>(Duration, Duration) = default;
  friend constexpr Duration operator+(Duration a, Duration b) { return {a.ns + b.ns}; }
  friend constexpr Duration operator-(Duration a, Duration b) { return {a.ns - b.ns}; }
};

/// A reading of one clock. The library never asks the host for the time: there is no now().
/// Readings of different clocks are different types, so that they meet only where depth/ ties the
/// clocks together.
template <class Clock>
struct Instant {
  std::int64_t ns = 0;

  friend constexpr auto operator<=>(Instant, Instant) = default;
  friend constexpr Duration operator-(Instant a, Instant b) { return {a.ns - b.ns}; }
  friend constexpr Instant operator+(Instant a, Duration d) { return {a.ns + d.ns}; }
  friend constexpr Instant operator-(Instant a, Duration d) { return {a.ns - d.ns}; }
};

/// The tool's free-running crystal, from an arbitrary zero. Attitude runs on it.
using ToolTime = Instant<struct ToolClock>;
/// The surface's clock: UTC since 1970 without leap seconds. Depth and events run on it.
using UtcTime = Instant<struct UtcClock>;

}  // namespace wellgyro

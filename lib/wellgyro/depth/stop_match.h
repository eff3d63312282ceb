#pragma once

#include <cstddef>
#include <span>
#include <string>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/base/time.h"

namespace wellgyro {

/// Rests of either clock, at most: one a minute and a half for a day. The search takes up to their
/// square of offsets.
inline constexpr std::size_t kRestsMost = 1000;

/// A time at rest, as one clock tells it.
template <class Clock>
struct Rest {
  Instant<Clock> begin, end;
};
using ToolRest = Rest<struct ToolClock>;
using UtcRest = Rest<struct UtcClock>;

struct StopMatchSetup {
  double sigma_drift = 1e-4;  ///< of the tool clock's rate, before any stop [1]
  double sigma_edge = 3;      ///< prior of StopMatch::late, of mean 0 [s]
};

/// A tool's clock tied to UTC by its stops and starts.
struct StopMatch {
  ToolTime tool;     ///< amid the stops that count; there
  UtcTime utc;       ///< it is this time
  double drift = 0;  ///< UTC seconds per tool second, less one
  /// Of the time at `tool` and of the drift [s^2, s, 1].
  Eigen::Matrix2d cov = Eigen::Matrix2d::Zero();
  double late = 0;  ///< by which the tool's rests begin later and end earlier than the rig's [s]
  double sigma_edge = 0;  ///< of one start or stop, as they scatter [s]
  int matched = 0;        ///< rests of the tool that one of the rig's agrees with

  UtcTime ToUtc(ToolTime time) const;
  double Sigma(ToolTime time) const;  ///< of ToUtc(time) [s]
};

/// Finds offset and drift of a free-running tool clock from when the tool, and when the rig's
/// depth, stood still: for memory and drop tools, and as a check of timestamps.
///
/// No first guess is needed. Rests that only one of the two has, and wrong times, are left out:
/// starts and stops count by Tukey's biweight of their own scatter. Both lists in the order of
/// time, at most kRestsMost rests each. Faults: kLost with fewer than two rests that agree,
/// kConflict where another offset explains nearly as many, as with stops of equal length and
/// distance.
WELLGYRO_EXPORT Result<StopMatch> MatchStops(std::span<const ToolRest> tool,
                                             std::span<const UtcRest> rig,
                                             const StopMatchSetup& setup = {});

}  // namespace wellgyro

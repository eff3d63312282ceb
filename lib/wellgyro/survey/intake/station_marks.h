#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "wellgyro/alignment/still_detector.h"
#include "wellgyro/base/time.h"
#include "wellgyro/record/along_hole.h"
#include "wellgyro/survey/job.h"
#include "wellgyro/survey/stations/choose.h"
#include "wellgyro/survey/stations/station_plan.h"

namespace wellgyro {

/// Slower than this a tool is at rest [m/s].
inline constexpr double kRestSpeed = StillSetup{}.speed_limit;

/// Of an hour of depths that never rest 360 stations are kept, 0.2 GB; a sixth of a shortest stop.
inline constexpr Duration kRestsApart = Duration::Seconds(10);

/// Where along the hole a run wants its stations: at the depths of the job's plan, where a person
/// asks for one, and where the tool comes to rest away from the last.
///
/// Two stations nearer than kSameDepth are one: a tool that creeps at a stop, or whose depth counts
/// back and forth there, makes none anew.
class StationMarks {
 public:
  explicit StationMarks(const Job& job) : plan_(job) {}

  /// Asks for a station at the next sample; `md`: depth to give it [m].
  void Ask(std::optional<double> md) {
    asked_ = true;
    asked_md_ = md;
  }
  /// And that is not answered yet.
  bool asked() const { return asked_; }
  /// What was asked for is answered: the depth of its station, `here` if none was given; none where
  /// neither is known, or nothing was asked.
  std::optional<double> TakeAsked(std::optional<double> here) {
    if (!std::exchange(asked_, false)) return std::nullopt;
    const std::optional<double> given = std::exchange(asked_md_, std::nullopt);
    return given ? given : here;
  }

  /// Planned depths from `from` to `to`, in the order in which the tool meets them; see
  /// StationPlan::Between. They hold until the next call.
  std::span<const StationPlan::Target> Between(double from, double to, bool inclusive) {
    plan_.Between(from, to, inclusive, targets_);
    return targets_;
  }

  /// A station is made at this depth [m].
  void Mark(double md) { last_md_ = md; }
  /// It is at the depth of the last station.
  bool IsMarked(double md) const { return last_md_ && std::abs(md - *last_md_) <= kSameDepth; }
  /// At rest, as far as its sigma lets the speed tell, and not where the last station is. That
  /// makes one, listed only if the job asks for stops or if it turns out to be the deepest. Depths
  /// that count in whole metres come to rest at each: two rests within kRestsApart are one.
  bool ComesToRest(const AlongHole& here, ToolTime now) {
    if (Moves(here.speed, here.sigma_speed) || IsMarked(here.md)) return false;
    const Duration since = last_rest_ ? now - *last_rest_ : kRestsApart;
    if (since < kRestsApart && since.ns > -kRestsApart.ns) return false;
    last_rest_ = now;
    return true;
  }
  /// The depth says so: beyond what its own error makes of a tool that hangs still.
  static bool Moves(double speed, double sigma_speed) {
    return std::abs(speed) > std::max(kRestSpeed, 2 * sigma_speed);
  }

 private:
  StationPlan plan_;
  std::vector<StationPlan::Target> targets_;  ///< scratch
  std::optional<double> last_md_;             ///< of the last station [m]
  std::optional<ToolTime> last_rest_;
  bool asked_ = false;
  std::optional<double> asked_md_;  ///< [m]
};

}  // namespace wellgyro

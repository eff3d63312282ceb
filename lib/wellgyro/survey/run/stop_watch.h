#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "wellgyro/alignment/still_detector.h"
#include "wellgyro/base/time.h"
#include "wellgyro/record/along_hole.h"
#include "wellgyro/record/along_hole_block.h"
#include "wellgyro/record/north_fix.h"
#include "wellgyro/record/run_knot.h"
#include "wellgyro/record/sample.h"
#include "wellgyro/record/sample_block.h"
#include "wellgyro/survey/hole/path_site.h"
#include "wellgyro/survey/job.h"
#include "wellgyro/survey/run/waiting_knot.h"
#include "wellgyro/survey/survey.h"

namespace wellgyro {

/// Between places of one stop [m]: a string creeps by a decimetre while its stretch settles, and on
/// twice that a hole of 10 deg/30 m turns by 0.07 deg.
inline constexpr double kOneStop = 0.2;

/// A stop of the tool, from its first window at rest on.
struct Stop {
  /// Its life, in this order. Before it the still detector has a window open; after it its fix is
  /// part of the run.
  enum class Phase {
    kHeld,  ///< the tool has not left the place: a window at another index position may join
    kLeft,  ///< its north is found and waits until the knots up to its end are known
  };
  Phase phase = Phase::kHeld;
  std::vector<StillWindow> windows;  ///< while it is held
  NorthFix fix;                      ///< once it is left
};

/// Finds the stops of a run and the north at each of them.
///
/// A stop is left when a sample comes from another place (or, where no depth is known, two minutes
/// behind its last window): windows at several index positions give one north, in which the axes'
/// biases drop out. What lies within a stop is then decided at once, so that its fix and the knots
/// at rest never say different things.
class StopWatch {
 public:
  /// All must outlive this object. `site`: where the tool is; knots of `waiting` are told whether
  /// they are at rest; checks of three gyro axes at rest go to `summary`.
  StopWatch(const Job& job, const PathSite& site, WaitingKnots& waiting, RunSummary& summary);

  /// The next sample; `begin` and `middle` of it along the hole.
  void Push(const ImuSample& sample, const AlongHole& begin, const AlongHole& middle);
  /// See StillDetector: samples that end no window.
  std::size_t Room(const SampleStamp& next) const { return still_.Room(next); }
  void Append(const SampleBlock& samples, const AlongHoleBlock& middle, std::size_t at) {
    still_.Append(samples, middle, at);
  }
  /// Mode or index position changes before the next sample.
  void Cut(std::optional<std::int32_t> index_position);
  /// No sample follows for now: what rests has come to its end.
  void Flush();

  /// Whether a tool that is there is still at the stop that is held, if one is.
  bool Stays(ToolTime time, std::optional<double> md) const {
    return !held() || IsAt(stops_.back(), time, md);
  }
  /// Says of every knot that waits whether it is at rest, once the detector has made up its mind
  /// about its time, or now.
  void DecideStill(bool all);
  /// The fix of the next stop that is left and ends by then, or at all; it is given once.
  std::optional<NorthFix> Due(std::optional<ToolTime> until);
  /// North from windows at one place.
  NorthFix FixOf(std::span<const StillWindow> windows) const;

  /// A knot of the run, in order.
  void Pass(const RunKnot& knot);
  /// At rest up to the end of the last knot since [s].
  double rested() const { return rested_; }
  /// On the way since this was last asked gravity did not show the roll throughout.
  bool TakeRollHidden();

 private:
  /// The tool is at a stop that has a window.
  bool held() const { return !stops_.empty() && stops_.back().phase == Stop::Phase::kHeld; }
  static bool IsAt(const Stop& stop, ToolTime time, std::optional<double> md);
  void Take(const StillWindow& window);
  void Leave();
  void CheckAtRest(std::span<const StillWindow> windows);
  bool IsStill(const WaitingKnot& knot) const;

  const Job& job_;
  const PathSite& site_;
  WaitingKnots& waiting_;
  RunSummary& summary_;
  StillDetector still_;
  std::deque<Stop> stops_;    ///< those left, and the one held, if any
  double rested_ = 0;         ///< up to the end of the last knot [s]
  bool roll_hidden_ = false;  ///< somewhere since it was last asked for
};

}  // namespace wellgyro

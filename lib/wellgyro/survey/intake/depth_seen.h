#pragma once

#include <optional>
#include <span>

#include "wellgyro/base/time.h"
#include "wellgyro/depth/passes.h"
#include "wellgyro/record/along_hole.h"
#include "wellgyro/record/sample.h"
#include "wellgyro/survey/survey.h"

namespace wellgyro {

/// What a run's samples have seen of the depth: on which pass they are, and how long none of them
/// had one.
///
/// Time without a depth counts where it lies between two samples that had one. Before the first the
/// tool is being made up; behind the last it is not known whether one comes yet, so that it is told
/// apart (seconds_without).
class DepthSeen {
 public:
  /// `summary` must outlive this object: time without a depth is counted there.
  explicit DepthSeen(RunSummary& summary) : summary_(summary) {}

  /// The next sample, `along` at its begin.
  const PassState& Push(const SampleStamp& stamp, UtcTime utc, const AlongHole& along) {
    Count(stamp, along.known);
    return along.known ? passes_.Push(utc, along.md) : passes_.state();
  }
  /// Samples that all have a depth, while none is missing; see PassTracker.
  const PassState& Push(std::span<const UtcTime> utc, std::span<const double> md) {
    return passes_.Push(utc, md);
  }
  std::optional<double> FurthestWithin(std::span<const double> md) const {
    return passes_.FurthestWithin(md);
  }
  /// The depth scale changes before the next sample.
  void Restart() { passes_.Restart(); }

  const PassState& pass() const { return passes_.state(); }
  /// Some sample had a depth.
  bool seen() const { return seen_; }
  /// The last sample had one.
  bool now() const { return seen_ && !(seconds_unknown_ > 0); }
  /// How long it has been since the last that had one [s].
  double seconds_without() const { return seen_ ? seconds_unknown_ : 0; }

 private:
  void Count(const SampleStamp& stamp, bool known) {
    if (!known) {
      seconds_unknown_ += 1e-9 * stamp.period_ns;
      return;
    }
    if (seen_) summary_.seconds_without_depth += seconds_unknown_;
    seconds_unknown_ = 0;
    seen_ = true;
  }

  RunSummary& summary_;
  PassTracker passes_;
  bool seen_ = false;           ///< some sample had a depth
  double seconds_unknown_ = 0;  ///< since the last sample with a depth [s]
};

}  // namespace wellgyro

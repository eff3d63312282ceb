#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "wellgyro/attitude/increment_builder.h"
#include "wellgyro/base/time.h"
#include "wellgyro/record/increment.h"
#include "wellgyro/record/sample.h"
#include "wellgyro/record/sample_block.h"
#include "wellgyro/survey/job.h"
#include "wellgyro/survey/run/waiting_knot.h"

namespace wellgyro {

/// Sums samples to increments and gives each to the knot that waits for it. A knot may end in the
/// gap behind a sample, of which the builder learns only with the sample that follows: until then
/// such cuts wait here, and no samples are taken by the block.
class IncrementFeed {
 public:
  explicit IncrementFeed(const Job& job);

  /// The next sample; ends knots in the gap before it where that was asked for.
  void Push(const ImuSample& sample, bool rests);
  /// See IncrementBuilder: how many samples the sums at hand still hold, none of which ends a knot.
  std::size_t Room(const SampleStamp& next) const {
    return gap_cuts_.empty() ? builder_.Room(next) : 0;
  }
  void Append(const SampleBlock& samples, bool rest) { builder_.Append(samples, rest); }
  /// Ends the knot at `fraction` of the last sample, of this period; beyond 1: in the gap behind.
  void Cut(double fraction, std::int32_t period_ns);
  /// No sample follows for now.
  void Flush() { builder_.Flush(); }

  /// Increments that are ready, to the knots that wait for them. The builder ends a knot by itself
  /// that lasts too long: such a one, which nobody asked for, joins `waiting` with its end's UTC.
  void Give(const std::function<UtcTime(ToolTime)>& utc_of, WaitingKnots& waiting);
  /// Of the knots that wait, in their order, as far as the samples there are end them: increments
  /// that are ready, then those of a copy of the builder that is flushed.
  std::vector<Increment> Ahead(const WaitingKnots& waiting);

 private:
  IncrementBuilder builder_;
  std::optional<IncrementBuilder> ahead_;  ///< scratch: to assign it allocates nothing
  std::vector<Duration> gap_cuts_;         ///< in the gap behind the last sample
};

}  // namespace wellgyro

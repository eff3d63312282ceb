#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "wellgyro/base/time.h"
#include "wellgyro/depth/passes.h"
#include "wellgyro/record/along_hole.h"
#include "wellgyro/record/increment.h"
#include "wellgyro/record/quality.h"
#include "wellgyro/record/sample.h"
#include "wellgyro/survey/intake/located_block.h"
#include "wellgyro/survey/intake/station_marks.h"
#include "wellgyro/survey/job.h"
#include "wellgyro/survey/run/increment_feed.h"
#include "wellgyro/survey/run/waiting_knot.h"
#include "wellgyro/survey/stations/draft.h"
#include "wellgyro/survey/survey.h"

namespace wellgyro {

/// Cuts a run's samples into knots: every second of the tool clock, at every station, where the
/// tool comes to rest, and where the job's azimuth holds.
///
/// A sample is the mean over a period, and the depth is known at instants: where in it a depth is
/// passed is known when the next sample has come. Until then it is the *current* one. What follows
/// it says where it ends (EndBefore); it is summed (Sum), its knots are placed (Place) and cut
/// (Cut), and the next sample takes its place (Begin).
class KnotCutter {
 public:
  /// Where the current sample and the gap after it, if any, end.
  struct End {
    AlongHole along;  ///< there
    PassState pass;   ///< there
    double reach;     ///< from the sample's begin to there, in periods
  };

  /// All must outlive this object. Knots are put behind those of `waiting`, and told their
  /// increments there; of `summary` run and tool are read, its end and samples that turn too far
  /// counted.
  KnotCutter(const Job& job, WaitingKnots& waiting, RunSummary& summary);

  /// Where stations are wanted.
  StationMarks& marks() { return marks_; }
  const StationMarks& marks() const { return marks_; }

  /// What the next sample, taken or not, says of the tool and its clock.
  void Heed(const SampleStamp& stamp);
  /// The sample comes behind all that have been taken.
  bool Follows(const ImuSample& sample) const;
  /// The current sample's end, by a sample that follows; none: there is no current one.
  std::optional<End> EndBefore(const ImuSample& next, UtcTime utc, const AlongHole& along,
                               const PassState& pass);
  /// The same where none follows, a station there included that ends a way down.
  std::optional<End> LastEnd(const PassState& pass);
  /// The current sample into the sums; increments of knots that end before it are given out.
  void Sum();
  /// Finds where knots are wanted up to the end. True: the station made last is among those asked
  /// for, and is to be listed.
  bool Place(const End& end);
  /// Makes those knots; false: none.
  bool Cut(const End& end);
  /// The sample becomes the current one; `along` at its begin, `middle` at its middle.
  void Begin(const ImuSample& sample, UtcTime utc, const AlongHole& along, const AlongHole& middle,
             const PassState& pass);
  /// No sample follows for now: there is no current one, and all increments are given out.
  void Flush();

  /// How many samples from `at` on at most follow the current one without ending a knot or a sum.
  std::size_t Room(const LocatedBlock& block, std::size_t at) const;
  /// No station, and no place of the job's azimuth, lies within such samples, which end at `utc`
  /// and reach `furthest` [m].
  bool IsPlain(UtcTime utc, double furthest);
  /// Such samples, [at, at + count): the last of them, on this pass, becomes the current one; those
  /// before it are summed.
  void Append(const LocatedBlock& block, std::size_t at, std::size_t count, const PassState& pass);

  /// Of the knots that wait, as far as the samples there are end them; see IncrementFeed.
  std::vector<Increment> IncrementsAhead() { return feed_.Ahead(waiting_); }

 private:
  /// The sample that is taken when it is known where the next one is.
  struct Current {
    ToolTime begin;
    std::int32_t period_ns, session;
    bool rests;  ///< by the depth at the middle of it
    ImuSample sample;
    UtcTime utc, utc_end;  ///< of its begin; of its end, by the next sample where that follows
    AlongHole along;       ///< at its begin, and there:
    PassState pass;
  };
  /// Where a knot is wanted within the current sample, or (beyond 1) in the gap after it.
  struct KnotAt {
    double fraction = 1;
    std::optional<Draft> draft;
    bool external = false;
  };

  /// Counts samples between which the roll is ambiguous (TurnsFar), and flags their knot.
  void CountAliased(std::int64_t samples);
  /// Increments that are ready, to their knots.
  void Give();
  bool PlaceTargets(double md_next, double reach);
  void PlaceByTime();
  void CutAt(const KnotAt& cut, const End& end);
  void MakeKnot(ToolTime time, double fraction, const End& end);
  Draft NewDraft(double md) const;

  const Job& job_;
  WaitingKnots& waiting_;
  RunSummary& summary_;
  StationMarks marks_;
  IncrementFeed feed_;
  std::vector<KnotAt> cuts_;               ///< scratch: of the current sample
  std::optional<Current> current_;         ///< none: before the first sample, and behind a Flush
  std::optional<SampleStamp> last_taken_;  ///< what the next one must follow
  std::optional<ToolTime> last_knot_;      ///< where the next one begins
  Quality quality_ = Quality::kGood;       ///< of the samples since the last knot
  bool end_unsynced_ = false;  ///< the sample behind the one being summed doubts its UTC
};

}  // namespace wellgyro

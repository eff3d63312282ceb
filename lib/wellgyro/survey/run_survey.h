#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "wellgyro/alignment/still_detector.h"
#include "wellgyro/attitude/increment_builder.h"
#include "wellgyro/attitude/unseen.h"
#include "wellgyro/depth/passes.h"
#include "wellgyro/estimate/forward_run.h"
#include "wellgyro/record/north_fix.h"
#include "wellgyro/record/sample.h"
#include "wellgyro/survey/draft_book.h"
#include "wellgyro/survey/job.h"
#include "wellgyro/survey/kept_knots.h"
#include "wellgyro/survey/located_block.h"
#include "wellgyro/survey/outside_azimuth.h"
#include "wellgyro/survey/path_site.h"
#include "wellgyro/survey/run_history.h"
#include "wellgyro/survey/run_now.h"
#include "wellgyro/survey/station_plan.h"
#include "wellgyro/survey/survey.h"

namespace wellgyro {

/// One run of one tool: samples with their depth in, drafts of stations out.
///
/// Every second, at every station and where the tool comes to rest samples are cut into knots. A
/// knot waits for its increment, 6 to 12 s, by when the still detector has made up its mind about
/// its time. From the first north on the run is known as it goes, and a station is told at once, by
/// increments that no later sample has bettered; a stop's north fix counts when the tool has left
/// the place, because until then another index position may still join it.
class RunSurvey {
 public:
  /// `job` must outlive this object.
  RunSurvey(const Job& job, std::int32_t run, std::int32_t tool);

  /// The next sample, in order; `along` is the sensor point's at the sample's begin, `middle` at
  /// its middle.
  void Push(const ImuSample& sample, UtcTime utc, const AlongHole& along, const AlongHole& middle);
  /// Samples [at, end) of a block, up to the first that brings news: the number behind it. As Push
  /// of each would, at less cost.
  std::size_t Push(const LocatedBlock& block, std::size_t at, std::size_t end);
  /// Averages at rest, from a tool that sends no samples. `along` at their middle.
  void Push(const StillWindow& window, const AlongHole& along);
  /// Mode or index position changes before the next sample.
  void Cut(std::optional<std::int32_t> index_position);
  /// The depth scale changes before the next sample.
  void RestartDepth() { passes_.Restart(); }
  /// Asks for a station at the next sample; `md`: depth to give it.
  void TakeStation(std::optional<double> md);
  /// No more samples for now: works off all that waits.
  void Flush();

  /// Drafts that have become ready to be told since the last call: indices into drafts().
  std::vector<std::size_t> News() { return book_.News(); }
  bool has_news() const { return book_.has_news(); }
  /// Some sample had a depth.
  bool depth_seen() const { return depth_seen_; }
  /// How long it has been since the last that had one [s].
  double seconds_without_depth() const { return depth_seen_ ? seconds_unknown_ : 0; }
  /// The draft still waits for an azimuth to become known.
  bool IsUnheard(std::size_t draft) const { return book_.IsUnheard(draft); }
  const std::vector<Draft>& drafts() const { return book_.drafts(); }
  std::vector<Draft>& drafts() { return book_.drafts(); }
  /// Of drafts() that are from samples, in this order, as known on the way.
  std::vector<StationState> states() const;
  const StationState& state(std::size_t number) const;
  /// How many of drafts(), the youngest, are told ahead: their knots still wait.
  std::size_t ahead() const { return states_ahead_.size(); }
  /// All that is to be estimated from. Those of drafts() that are from samples stand in this order
  /// among its stations.
  RunHistory History() const;
  const KeptKnots& knots() const { return knots_; }
  RunNow Now() const;
  const RunSummary& summary() const { return summary_; }
  RunSummary& summary() { return summary_; }
  /// How stops that were reached on a roll nobody saw agree with the run as a whole, by its
  /// attitudes at the end of every knot.
  void CloseOnWhole(std::span<const AttitudeSample> whole);
  /// Lists the deepest station of the in-runs, which closes the survey.
  void ListLastDepth();

 private:
  /// The sample that is taken when it is known where the next one is.
  struct Current {
    ToolTime begin;
    std::int32_t period_ns, session;
    bool rests;  ///< by the depth at the middle of it
    ImuSample sample;
    UtcTime utc, utc_end;
    AlongHole along;
    PassState pass;
  };
  /// A knot that waits for its increment.
  struct Waiting {
    ToolTime begin, end;
    UtcTime utc;  ///< of its end, and there:
    AlongHole along;
    std::optional<Draft> draft;
    std::optional<Increment> increment;
    bool external = false;            ///< the job's azimuth holds here
    std::optional<bool> still;        ///< once it is decided
    std::optional<std::size_t> told;  ///< the draft's number, where it is already among drafts()
    bool temperature_outside = false;
    float temperature = 0;  ///< [degC]
  };

  /// Where a knot is wanted within the current sample, or (beyond 1) in the gap after it.
  struct KnotAt {
    double fraction = 1;
    std::optional<Draft> draft;
    bool external = false;
  };

  std::size_t Plain(const LocatedBlock& block, std::size_t at, std::size_t end);
  std::size_t PlainByPlace(const LocatedBlock& block, std::size_t at, std::size_t end) const;
  void TakePlain(const LocatedBlock& block, std::size_t at, std::size_t count);
  void Count(const SampleStamp& stamp, std::int64_t samples);
  void CountDepth(const SampleStamp& stamp, bool known);
  void CountTurn(const ImuSample& sample);
  /// `reach`: from its begin to where `next` and `pass_next` hold, in periods.
  void TakeCurrent(const AlongHole& next, const PassState& pass_next, double reach);
  void AddTargets(double md_next, double reach);
  void ListLastMark();
  void CutAt(const KnotAt& cut, const AlongHole& next, double reach);
  void CutIncrement(double fraction);
  void TakeIncrements();
  bool ComesToRest(const AlongHole& end) const;
  Draft NewDraft(double md) const;
  bool SamePlace(ToolTime time, std::optional<double> md) const;
  void TakeWindow(const StillWindow& window);
  void CheckStop();
  NorthFix FixOf(std::span<const StillWindow> windows) const;
  void CloseGroup();
  bool IsStill(const Waiting& waiting) const;
  void DecideStill(bool all);
  void StepReady(bool all);
  void StepKnot(const Waiting& waiting, const Increment* next);
  RunKnot KnotOf(const Waiting& waiting, const Increment& increment, UnseenTurn& unseen) const;
  AttitudeSample AttitudeNow() const;
  void TellAhead();
  std::vector<Increment> IncrementsAhead();
  void AddDraft(const Draft& waiting, std::size_t state, Quality unseen, bool known);
  void TakeDraft(const Waiting& waiting);
  bool AzimuthKnown() const;
  void BeginForward();
  bool KeepIfSure(std::size_t knots);
  void Tie(NorthFix tie, bool of_mark);
  void UseClosedStops(std::optional<ToolTime> until);
  void UseFix(NorthFix fix);
  void ListStop(const NorthFix& fix);

  const Job& job_;
  PathSite site_;  ///< at the end of the last knot
  OutsideAzimuth outside_;
  StationPlan plan_;
  std::vector<StationPlan::Target> targets_;  ///< scratch
  std::vector<KnotAt> cuts_;                  ///< scratch
  IncrementBuilder builder_;
  std::optional<IncrementBuilder> builder_ahead_;  ///< scratch
  std::vector<Duration> gap_cuts_;  ///< in the gap behind the sample last given to the builder
  UnseenTurn unseen_;
  RunHistory history_;           ///< but for knots and attitudes, which are in ...
  KeptKnots knots_;              ///< ... here, and the last of them in ...
  std::vector<RunKnot> recent_;  ///< ... here, ForwardRun::kLooksBack or all
  AttitudeSample known_;         ///< at the end of the last one
  double rested_ = 0;            ///< at rest until there [s]
  /// What was known at the end of so many knots.
  struct Known {
    std::size_t knots;
    RunState state;
  };
  std::optional<ForwardRun> forward_;  ///< from the first north on
  std::optional<Known> sure_;          ///< when its heading was last sure
  bool begun_roughly_ = false;         ///< about a heading that was not yet sure
  std::size_t next_try_ = 0;           ///< knots, from which a start is tried again
  bool roll_hidden_ = false;           ///< on the way since the last stop
  StillDetector still_;
  PassTracker passes_;
  std::optional<Current> current_;
  std::optional<SampleStamp> last_taken_;
  std::optional<ToolTime> last_knot_;
  double last_mark_md_ = 0;
  bool marked_ = false;
  bool depth_seen_ = false;
  double seconds_unknown_ = 0;  ///< since the last sample with a depth [s]
  std::optional<double> asked_md_;
  bool asked_ = false;
  bool temperature_outside_ = false;  ///< since the last knot
  bool end_unsynced_ = false;         ///< the sample behind the one being summed doubts its UTC
  Quality unseen_since_listed_ = Quality::kGood;  ///< since the last station that is listed
  std::deque<Waiting> waiting_;
  std::vector<StillWindow> group_;  ///< windows at one place
  std::deque<NorthFix> closed_;     ///< of stops that are over, until their knots are known
  DraftBook book_;
  std::deque<StationState> states_ahead_;  ///< of the youngest drafts, whose knots still wait
  RunSummary summary_;
};

}  // namespace wellgyro

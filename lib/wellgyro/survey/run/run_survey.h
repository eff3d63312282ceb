#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "wellgyro/base/time.h"
#include "wellgyro/record/attitude_sample.h"
#include "wellgyro/record/north_fix.h"
#include "wellgyro/record/sample.h"
#include "wellgyro/survey/intake/depth_seen.h"
#include "wellgyro/survey/intake/located_block.h"
#include "wellgyro/survey/job.h"
#include "wellgyro/survey/run/forward_estimate.h"
#include "wellgyro/survey/run/knot_cutter.h"
#include "wellgyro/survey/run/outside_azimuth.h"
#include "wellgyro/survey/run/run_drafts.h"
#include "wellgyro/survey/run/run_history.h"
#include "wellgyro/survey/run/run_now.h"
#include "wellgyro/survey/run/stop_watch.h"
#include "wellgyro/survey/run/waiting_knot.h"
#include "wellgyro/survey/survey.h"

namespace wellgyro {

/// One run of one tool: samples with their depth in, drafts of stations out.
///
/// The way of the data: DepthSeen finds the pass, KnotCutter cuts samples into knots, which wait
/// for their increments, 6 to 12 s, by when the still detector of StopWatch has made up its mind
/// about their time. ForwardEstimate takes the knots and the norths of stops and from outside;
/// RunDrafts tells stations at once, by increments that no later sample has bettered. A stop's
/// north counts when the tool has left the place, because until then another index position may
/// still join it.
class RunSurvey {
 public:
  /// `job` must outlive this object.
  RunSurvey(const Job& job, std::int32_t run, std::int32_t tool);
  RunSurvey(const RunSurvey&) = delete;
  RunSurvey& operator=(const RunSurvey&) = delete;

  /// The next sample, in order; `along` is the sensor point's at the sample's begin, `middle` at
  /// its middle.
  void Push(const ImuSample& sample, UtcTime utc, const AlongHole& along, const AlongHole& middle);
  /// Samples [at, end) of a block, up to the first that brings news: the number behind it. As Push
  /// of each would, at less cost.
  std::size_t Push(const LocatedBlock& block, std::size_t at, std::size_t end);
  /// Averages at rest, from a tool that sends no samples. `along` at their middle.
  void Push(const StillWindow& window, const AlongHole& along);
  /// Mode or index position changes before the next sample.
  void Cut(std::optional<std::int32_t> index_position) { stops_.Cut(index_position); }
  /// The depth scale changes before the next sample.
  void RestartDepth() { depth_.Restart(); }
  /// Asks for a station at the next sample; `md`: depth to give it.
  void TakeStation(std::optional<double> md) { cutter_.marks().Ask(md); }
  /// No more samples for now: works off all that waits.
  void Flush();

  /// Drafts that have become ready to be told since the last call: indices into drafts().
  std::vector<std::size_t> News() { return drafts_.book().News(); }
  bool has_news() const { return drafts_.book().has_news(); }
  /// The depth as its samples saw it.
  const DepthSeen& depth() const { return depth_; }
  /// The draft still waits for an azimuth to become known.
  bool IsUnheard(std::size_t draft) const { return drafts_.book().IsUnheard(draft); }
  const std::vector<Draft>& drafts() const { return drafts_.book().drafts(); }
  std::vector<Draft>& drafts() { return drafts_.book().drafts(); }
  /// Of drafts() that are from samples, in this order, as known on the way.
  std::vector<StationState> states() const { return drafts_.States(estimate_.history().states); }
  const StationState& state(std::size_t number) const;
  /// How often all states have become others.
  std::size_t solutions() const { return estimate_.solutions(); }
  /// How many of drafts(), the youngest, are told ahead: their knots still wait.
  std::size_t ahead() const { return drafts_.ahead(); }
  /// All that is to be estimated from. Those of drafts() that are from samples stand in this order
  /// among its stations.
  RunHistory History() const { return estimate_.History(); }
  /// The knots that have been estimated from, and what was known at their ends.
  const KeptKnots& knots() const { return estimate_.knots(); }
  /// How far the run is known, for advice on its way.
  RunNow Now() const;
  const RunSummary& summary() const { return summary_; }
  RunSummary& summary() { return summary_; }
  /// How norths agree with the whole run that is adjusted.
  void CloseOnWhole(const SmoothedRun& run);
  /// The deepest station of the in-runs so far closes the survey, where stations go by depth.
  void CloseAtDeepest();

 private:
  // The ways of a sample, alone and by the block.
  std::size_t Plain(const LocatedBlock& block, std::size_t at, std::size_t end);
  std::size_t PlainByPlace(const LocatedBlock& block, std::size_t at, std::size_t end) const;
  void TakePlain(const LocatedBlock& block, std::size_t at, std::size_t count);
  void TakeCurrent(const KnotCutter::End& end);
  // The ways of a knot, and of a north.
  void StepReady(bool all);
  void StepKnot(const WaitingKnot& waiting, const Increment* next);
  void TellAhead();
  void Tie(NorthFix tie, bool of_mark);
  void UseStops(std::optional<ToolTime> until);
  void UseStop(NorthFix fix);
  void TellIfSure(bool sure);

  const Job& job_;
  RunSummary summary_;
  WaitingKnots waiting_;  ///< from the cutter to the estimate
  DepthSeen depth_;
  KnotCutter cutter_;
  ForwardEstimate estimate_;
  StopWatch stops_;
  OutsideAzimuth outside_;
  RunDrafts drafts_;
};

}  // namespace wellgyro

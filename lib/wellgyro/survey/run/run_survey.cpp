#include "wellgyro/survey/run/run_survey.h"

#include <utility>

#include "wellgyro/survey/intake/sample_counts.h"
#include "wellgyro/survey/run/stop_closure.h"

namespace wellgyro {

RunSurvey::RunSurvey(const Job& job, std::int32_t run, std::int32_t tool)
    : job_(job),
      depth_(summary_),
      cutter_(job, waiting_, summary_),
      estimate_(job),
      stops_(job, estimate_.site(), waiting_, summary_),
      outside_(job) {
  summary_.run = run;
  summary_.tool = tool;
}

void RunSurvey::Push(const ImuSample& sample, UtcTime utc, const AlongHole& along,
                     const AlongHole& middle) {
  if (summary_.samples == 0) summary_.begin = utc;
  CountSamples(sample.stamp, 1, summary_);
  const PassState& pass = depth_.Push(sample.stamp, utc, along);
  cutter_.Heed(sample.stamp);
  if (cutter_.Follows(sample)) {
    if (const auto end = cutter_.EndBefore(sample, utc, along, pass)) TakeCurrent(*end);
    cutter_.Begin(sample, utc, along, middle, pass);
  }
  stops_.Push(sample, along, middle);
}

/// The current sample is summed, and cut into knots where they are wanted.
void RunSurvey::TakeCurrent(const KnotCutter::End& end) {
  cutter_.Sum();
  StepReady(false);
  if (cutter_.Place(end)) drafts_.ListLast(waiting_);
  if (!cutter_.Cut(end)) return;
  stops_.DecideStill(false);
  TellAhead();
}

void RunSurvey::Flush() {
  if (const auto end = cutter_.LastEnd(depth_.pass())) TakeCurrent(*end);
  stops_.Flush();
  cutter_.Flush();
  StepReady(true);
  UseStops(std::nullopt);
}

/// Knots whose increments are known. What stands behind a knot tells how the tool rolls from there
/// on.
void RunSurvey::StepReady(bool all) {
  while (!waiting_.empty() && waiting_.front().increment) {
    const bool followed = waiting_.size() > 1 && waiting_[1].increment;
    if (!followed && !all) return;
    const WaitingKnot knot = std::move(waiting_.front());
    waiting_.pop_front();
    StepKnot(knot, followed ? &*waiting_.front().increment : nullptr);
  }
}

void RunSurvey::StepKnot(const WaitingKnot& waiting, const Increment* next) {
  stops_.Pass(estimate_.Step(waiting, next));
  drafts_.Take(waiting, estimate_);
  if (const auto tie = outside_.AtBegin()) TellIfSure(estimate_.TieBegin(*tie));
  if (waiting.external) {
    const auto fix = outside_.At(waiting.end, waiting.utc, waiting.along, estimate_.known());
    if (fix) Tie(*fix, job_.alignment.of == AlignmentSpec::Of::kMark);
  }
  TellIfSure(estimate_.TryAgain());
  UseStops(estimate_.last().increment.time);
}

void RunSurvey::TellIfSure(bool sure) {
  if (sure) drafts_.book().TellUnheard();
}

void RunSurvey::TellAhead() {
  if (!estimate_.goes_on() || !RunDrafts::AnyUntold(waiting_)) return;
  drafts_.TellAhead(cutter_.IncrementsAhead(), estimate_, waiting_);
}

/// An azimuth from outside, at the end of the knot just stepped. The run so far is solved with it.
void RunSurvey::Tie(NorthFix tie, bool of_mark) {
  tie.run = summary_.run;
  tie.tool = summary_.tool;
  tie.external = true;
  TellIfSure(estimate_.Tie(tie, of_mark));
  summary_.fixes.push_back(tie);
}

/// Stops that end by then; all of them where no knot follows for now.
void RunSurvey::UseStops(std::optional<ToolTime> until) {
  while (const auto fix = stops_.Due(until)) {
    // Before its own fix, which the magnetic azimuth may tell from its mirror.
    const auto magnetic = outside_.Magnetic(*fix);
    if (magnetic && !estimate_.empty()) Tie(*magnetic, false);
    UseStop(*fix);
  }
}

void RunSurvey::UseStop(NorthFix fix) {
  if (UsesFixes(job_.alignment) && !estimate_.empty()) {
    TellIfSure(estimate_.Use(fix, stops_.TakeRollHidden()));
  }
  summary_.fixes.push_back(fix);
  drafts_.TakeStop(fix, job_.stations.at_stops);
}

void RunSurvey::Push(const StillWindow& window, const AlongHole& along) {
  StillWindow placed = window;
  if (!placed.md && along.known) placed.md = along.md;
  if (summary_.fixes.empty() && summary_.samples == 0) summary_.begin = window.utc_begin;
  summary_.end = window.utc_end;
  NorthFix fix = stops_.FixOf({&placed, 1});
  fix.from_samples = false;
  summary_.fixes.push_back(fix);
  if (fix.md) {
    drafts_.Add(window, fix);
  } else {
    summary_.seconds_without_depth += window.seconds();
  }
}

void RunSurvey::CloseOnWhole(const SmoothedRun& run) {
  wellgyro::CloseOnWhole(estimate_.history(), run, summary_.fixes);
}

void RunSurvey::CloseAtDeepest() {
  if (job_.stations.every > 0) drafts_.CloseAtDeepest();
}

const StationState& RunSurvey::state(std::size_t number) const {
  return drafts_.State(number, estimate_.history().states);
}

RunNow RunSurvey::Now() const {
  RunNow now;
  now.run = summary_.run;
  if (estimate_.empty()) return now;
  const RunKnot& last = estimate_.last();
  now.utc = last.utc;
  if (last.along.known) now.md = last.along.md;
  now.rested = stops_.rested();
  now.state = estimate_.state();
  return now;
}

}  // namespace wellgyro

// Knots into the run, once their increments are known.
#include <algorithm>
#include <cmath>
#include <utility>

#include "wellgyro/base/angle.h"
#include "wellgyro/record/unknown_angle.h"
#include "wellgyro/survey/estimated_run.h"
#include "wellgyro/survey/node_attitude.h"
#include "wellgyro/survey/run_survey.h"
#include "wellgyro/survey/run_survey_internal.h"

namespace wellgyro {
namespace {

// The still detector knows of a block when the one after it has ended.
constexpr Duration kMakeUpMind = Duration::Seconds(3);
// From what is known at a heading as sure as this the rest may be sought without what came before:
// what is made linear about it is wrong by its square. From 5 deg on, which a minute of rolling in
// a vertical hole seems to tell, it went astray, and a run at 88 deg was ten sigmas off.
constexpr double kSureHeading = 1 * kPi / 180;  // [rad]

/// How far the axis turned in this knot where nothing was seen of it, 1-sigma: what the hole may
/// bend, or, of gyros at full scale, as much again as they read.
double UnseenIn(const RunKnot& knot) {
  const UnseenHole hole;
  const Increment& inc = knot.increment;
  const double rate = knot.along.known ? hole.dogleg * std::abs(knot.along.speed) : hole.rate;
  return inc.gap_seconds * std::max(rate, inc.turn_M.norm() / inc.seconds);
}

}  // namespace

/// A stop, or what may still become one, covers all of this knot.
bool RunSurvey::IsStill(const Waiting& waiting) const {
  const auto covers = [&waiting](const StillWindow& window) {
    return window.begin <= waiting.begin && waiting.end <= window.end;
  };
  const std::optional<StillWindow> open = still_.OpenWindow();
  return (open && covers(*open)) || std::any_of(group_.begin(), group_.end(), covers);
}

/// Knots of which the still detector has made up its mind.
void RunSurvey::DecideStill(bool all) {
  for (Waiting& waiting : waiting_) {
    if (waiting.still) continue;
    const bool decided = all || waiting_.back().end - waiting.end >= kMakeUpMind;
    if (const bool still = IsStill(waiting); still || decided) waiting.still = still;
  }
}

/// What stands behind a knot tells how the tool rolls from there on.
void RunSurvey::StepReady(bool all) {
  while (!waiting_.empty() && waiting_.front().increment) {
    const bool followed = waiting_.size() > 1 && waiting_[1].increment;
    if (!followed && !all) return;
    const Waiting knot = std::move(waiting_.front());
    waiting_.pop_front();
    StepKnot(knot, followed ? &*waiting_.front().increment : nullptr);
  }
}

RunKnot RunSurvey::KnotOf(const Waiting& waiting, const Increment& increment,
                          UnseenTurn& unseen) const {
  const bool rests =
      job_.alignment.method == AlignmentSpec::Method::kGyrocompass || job_.alignment.use_fixes;
  RunKnot knot{.increment = increment, .utc = waiting.utc, .along = waiting.along};
  knot.temperature = waiting.temperature;
  knot.still = rests && waiting.still.value_or(false);
  if (waiting.temperature_outside) knot.increment.quality |= Quality::kTemperature;
  knot.unseen = UnseenIn(knot);
  knot.var_unseen = unseen.VarOf(knot.unseen);
  unseen.Add(knot.unseen);
  unseen.Pass(knot.increment.seconds - knot.increment.gap_seconds, UnseenHole().seconds);
  return knot;
}

bool RunSurvey::AzimuthKnown() const { return !knots_.empty() && known_.azimuth_known; }

/// At the end of the last knot.
AttitudeSample RunSurvey::AttitudeNow() const {
  const RunKnot& knot = recent_.back();
  if (forward_) return AttitudeOf(knot, forward_->node(), forward_->CovPhi());
  if (knot.increment.level || knots_.empty()) {
    return LevelOf(knot, job_.errors.accel_bias_sigma, site_.site().gravity);
  }
  AttitudeSample attitude = known_;
  attitude.time = knot.increment.time;
  attitude.quality |= knot.increment.quality;
  return attitude;
}

void RunSurvey::StepKnot(const Waiting& waiting, const Increment* next) {
  if (knots_.empty()) history_.site = site_.site();
  if (recent_.size() >= 2 * ForwardRun::kLooksBack) {
    recent_.erase(recent_.begin(), recent_.end() - ForwardRun::kLooksBack);
  }
  const RunKnot& knot = recent_.emplace_back(KnotOf(waiting, *waiting.increment, unseen_));
  roll_hidden_ |= !knot.still && !knot.increment.roll_seen;
  rested_ = knot.still ? rested_ + knot.increment.seconds : 0;
  const std::size_t knots = knots_.size() + 1;
  if (forward_ && !(forward_->Step(recent_, next) && KeepIfSure(knots))) {
    forward_.reset();
    if (!begun_roughly_) next_try_ = 0;
  }
  known_ = AttitudeNow();
  knots_.Add(knot, known_);
  site_.Move(knot.along, known_);
  unseen_since_listed_ |= knot.increment.quality & kUnseen;
  if (waiting.draft) TakeDraft(waiting);
  if (const auto tie = outside_.AtBegin()) {
    history_.ties.push_back(*tie);
    BeginForward();
  }
  if (waiting.external) {
    const auto fix = outside_.At(waiting.end, waiting.utc, waiting.along, known_);
    if (fix) Tie(*fix, job_.alignment.of == AlignmentSpec::Of::kMark);
  }
  const bool north = !history_.ties.empty() || !history_.fixes.empty();
  if (north && (!forward_ || begun_roughly_)) BeginForward();
  UseClosedStops(recent_.back().increment.time);
}

/// The draft of the last knot, whose state is `state` among those of the run.
void RunSurvey::AddDraft(const Draft& waiting, std::size_t state, Quality unseen, bool known) {
  const RunKnot& knot = recent_.back();
  Draft draft = waiting;
  draft.state = state;
  Station& s = draft.station;
  const Increment& inc = knot.increment;
  s.imu_seq_begin = inc.seq_begin;
  s.imu_seq_end = inc.seq_end;
  s.samples_lost = inc.samples_lost;
  s.quality |= unseen;
  if (!knot.along.known) s.quality |= Quality::kDepth;
  book_.Add(draft, known);
}

/// The draft of the knot just stepped.
void RunSurvey::TakeDraft(const Waiting& waiting) {
  const std::size_t index = knots_.size() - 1;
  const RunKnot& knot = recent_.back();
  const AttitudeSample& attitude = known_;
  const std::size_t state = history_.stations.size();
  history_.stations.push_back(index);
  history_.states.push_back(
      forward_ ? StateOf(index, knot, attitude, forward_->node().R_LT, forward_->Mark(index + 1))
               : StateOf(index, knot, attitude));
  if (waiting.told) {
    states_ahead_.pop_front();
  } else {
    AddDraft(*waiting.draft, state, unseen_since_listed_, attitude.azimuth_known);
  }
  if (drafts()[waiting.told.value_or(drafts().size() - 1)].listed) {
    unseen_since_listed_ = Quality::kGood;
  }
}

/// Solves the run so far together, or what of it came since its heading was last sure, and goes on
/// from there: not while two azimuths are as likely, about one of which the way on would be made
/// linear. Where it leads to none that is sure, it is done again when that part is half as long
/// again: all together cost three times the last.
void RunSurvey::BeginForward() {
  const std::size_t knots = knots_.size(), begin = sure_ ? sure_->knots : 0;
  if (knots < next_try_ || knots == begin) return;
  const RunHistory history = History();
  const RunEstimate solved =
      sure_ ? EstimateSince(begin, sure_->state, history) : EstimateSoFar(job_, history);
  next_try_ = knots + (knots - begin) / 2 + 1;
  forward_.reset();
  if (!solved.solved) sure_.reset();
  if (!solved.solved || solved.ambiguous || !solved.alone) return;
  SmoothedRun part = SmoothedOf(solved, history, begin);
  std::move_backward(part.stations.begin(), part.stations.end(), history_.states.end());
  forward_.emplace(solved.end, recent_);
  begun_roughly_ = !(forward_->SigmaOfHeading() < kSureHeading);
  const bool sure = KeepIfSure(knots);
  if (!sure) {
    forward_.reset();
    ForgetAzimuth(part.attitude.back());
  }
  knots_.Revise(begin, part.attitude);
  known_ = part.attitude.back();
  if (sure) book_.TellUnheard();
}

/// False where what is known at the end of so many knots has lost its heading.
bool RunSurvey::KeepIfSure(std::size_t knots) {
  const double sigma = forward_->SigmaOfHeading();
  if (!begun_roughly_ && sigma < kSureHeading) sure_ = {knots, forward_->state()};
  return sigma < kRoughHeading;
}

/// An azimuth from outside, at the end of the knot just stepped. The run so far is solved with it.
void RunSurvey::Tie(NorthFix tie, bool of_mark) {
  tie.run = summary_.run;
  tie.tool = summary_.tool;
  tie.external = true;
  const AttitudeSample& before = known_;
  if (before.azimuth_known) {
    tie.closure = WrapPi(tie.azimuth - before.azimuth);
    tie.sigma_closure = std::sqrt(tie.cov_attitude(1, 1) + before.cov_attitude(1, 1));
    tie.chi_square = tie.closure * tie.closure / (tie.sigma_closure * tie.sigma_closure);
  }
  history_.ties.push_back({knots_.size(), of_mark ? job_.alignment.azimuth : tie.azimuth,
                           std::sqrt(tie.cov_attitude(1, 1)), of_mark});
  summary_.fixes.push_back(tie);
  next_try_ = 0;
  sure_.reset();
  BeginForward();
}

}  // namespace wellgyro

#include "wellgyro/survey/run/forward_estimate.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "wellgyro/base/angle.h"
#include "wellgyro/survey/hole/node_attitude.h"
#include "wellgyro/survey/run/estimated_run.h"
#include "wellgyro/survey/run/stop_closure.h"

namespace wellgyro {
namespace {

// Largest sigma of the heading about which factors are linearised: the derivative of the Earth's
// rate by the heading changes by a tenth within it. With 20 deg the linearisation error made a run
// that rolls in a vertical hole learn an inclination eight sigmas off.
constexpr double kRoughHeading = 5 * kPi / 180;  // [rad]
// Largest sigma of the heading at which the knots so far are replaced by their linearised
// information, and only later ones solved: the linearisation error grows as its square. With 5 deg,
// which a minute of rolling in a vertical hole seems to give, a run at 88 deg was ten sigmas off.
constexpr double kSureHeading = 1 * kPi / 180;  // [rad]

/// How far the axis turned in this knot where nothing was seen of it, 1-sigma: what the hole may
/// bend, or, of gyros at full scale, as much again as they read.
double UnseenIn(const RunKnot& knot) {
  const Increment& inc = knot.increment;
  const double rate = inc.turn_M.norm() / inc.seconds;
  return inc.gap_seconds * std::max(UnseenHole().RateAt(knot.along), rate);
}

}  // namespace

ForwardEstimate::ForwardEstimate(const Job& job) : job_(job), site_(job) {}

RunKnot ForwardEstimate::KnotOf(const WaitingKnot& waiting, const Increment& increment,
                                UnseenTurn& unseen) const {
  RunKnot knot{.increment = increment, .utc = waiting.utc, .along = waiting.along};
  knot.temperature = waiting.temperature;
  knot.still = UsesFixes(job_.alignment) && waiting.still.value_or(false);
  knot.increment.quality |= waiting.quality;
  knot.unseen = UnseenIn(knot);
  knot.var_unseen = unseen.VarOf(knot.unseen);
  unseen.Add(knot.unseen);
  unseen.Pass(knot.increment.seconds - knot.increment.gap_seconds, UnseenHole().seconds);
  return knot;
}

/// At the end of the last knot.
AttitudeSample ForwardEstimate::AttitudeNow() const {
  const RunKnot& knot = recent_.back();
  if (forward_) return AttitudeOf(knot, forward_->node().R_LT, forward_->CovPhi());
  if (knot.increment.level || knots_.empty()) {
    return LevelOf(knot, job_.errors, site_.site().gravity);
  }
  // Nothing was seen of this knot, and the heading is too vague to go on from.
  AttitudeSample attitude = known_;
  attitude.time = knot.increment.time;
  attitude.quality |= knot.increment.quality;
  ForgetAzimuth(attitude);
  return attitude;
}

const RunKnot& ForwardEstimate::Step(const WaitingKnot& waiting, const Increment* next) {
  if (knots_.empty()) {
    site_.Begin(waiting.along);
    history_.site = site_.site();
  }
  if (recent_.size() >= 2 * ForwardRun::kLooksBack) {
    recent_.erase(recent_.begin(), recent_.end() - ForwardRun::kLooksBack);
  }
  const RunKnot& knot = recent_.emplace_back(KnotOf(waiting, *waiting.increment, unseen_));
  const std::size_t knots = knots_.size() + 1;
  if (forward_ && !(forward_->Step(recent_, next) && KeepIfSure(knots))) {
    forward_.reset();
    if (!begun_roughly_) next_try_ = 0;
  }
  known_ = AttitudeNow();
  knots_.Add(knot, known_);
  site_.Move(knot.along, known_);
  return knot;
}

std::size_t ForwardEstimate::AddStation() {
  const std::size_t index = knots_.size() - 1;
  const RunKnot& knot = recent_.back();
  history_.stations.push_back(index);
  history_.states.push_back(
      forward_ ? StateOf(index, knot, known_, forward_->node().R_LT, forward_->Mark(index + 1))
               : StateOf(index, knot, known_));
  return history_.states.size() - 1;
}

/// Solves the run so far together, or what of it came since its heading was last sure, and goes on
/// from there: not while two azimuths are as likely, about one of which the way on would be made
/// linear. Where it leads to none that is sure, it is done again when that part is half as long
/// again: all together cost three times the last.
bool ForwardEstimate::Begin() {
  const std::size_t knots = knots_.size(), begin = sure_ ? sure_->knots : 0;
  if (knots < next_try_ || knots == begin) return false;
  const RunHistory part = PartSinceSure();
  const RunEstimate solved = sure_ ? EstimateSince(sure_->state, part) : EstimateSoFar(job_, part);
  next_try_ = knots + (knots - begin) / 2 + 1;
  forward_.reset();
  if (!solved.solved) sure_.reset();
  if (!solved.solved || solved.ambiguous || !solved.alone) return false;
  SmoothedRun smoothed = SmoothedOf(solved, part);
  for (StationState& state : smoothed.stations) state.knot += begin;
  std::move_backward(smoothed.stations.begin(), smoothed.stations.end(), history_.states.end());
  ++solutions_;
  forward_.emplace(solved.end, recent_);
  begun_roughly_ = !(forward_->SigmaOfHeading() < kSureHeading);
  const bool sure = KeepIfSure(knots);
  if (!sure) {
    forward_.reset();
    ForgetAzimuth(smoothed.attitude.back());
  }
  knots_.Revise(begin, smoothed.attitude);
  known_ = smoothed.attitude.back();
  return sure;
}

/// False where what is known at the end of so many knots has lost its heading.
bool ForwardEstimate::KeepIfSure(std::size_t knots) {
  const double sigma = forward_->SigmaOfHeading();
  if (!begun_roughly_ && sigma < kSureHeading) sure_ = {knots, forward_->state()};
  return sigma < kRoughHeading;
}

bool ForwardEstimate::TieBegin(const AzimuthTie& tie) {
  history_.ties.push_back(tie);
  return Begin();
}

bool ForwardEstimate::Tie(NorthFix& fix, bool of_mark) {
  CloseOnOutside(known_, fix);
  history_.ties.push_back({knots_.size(), of_mark ? job_.alignment.azimuth : fix.azimuth,
                           std::sqrt(fix.cov_attitude(1, 1)), of_mark});
  next_try_ = 0;
  sure_.reset();
  return Begin();
}

bool ForwardEstimate::Use(NorthFix& fix, bool roll_hidden) {
  history_.fixes.push_back({fix, knots_.size()});
  if (!azimuth_known()) {
    const bool sure = Begin();
    const bool alone = azimuth_known() || !fix.mirror_azimuth;
    fix.quality = alone ? Without(fix.quality, Quality::kMirror) : fix.quality | Quality::kMirror;
    return sure;
  }
  const std::optional<AttitudeSample> before = knots_.KnownAt(fix.begin);
  if (before && before->azimuth_known) {
    ChooseBranch(*before, fix);
    if (!roll_hidden) CloseOn(*before, known_, fix);
  }
  return false;
}

bool ForwardEstimate::TryAgain() {
  const bool north = !history_.ties.empty() || !history_.fixes.empty();
  return north && (!forward_ || begun_roughly_) && Begin();
}

RunHistory ForwardEstimate::PartSinceSure() const {
  const std::size_t begin = sure_ ? sure_->knots : 0;
  // What was told at the begin of a part is in what is known there.
  const std::size_t told = sure_ ? begin + 1 : 0;
  RunHistory part;
  part.site = history_.site;
  KeptKnots::Reader reader(knots_, begin);
  while (const KeptKnot* kept = reader.Next()) part.knots.push_back(kept->knot);
  const auto take = [&](const auto& all, auto& to) {
    for (const auto& at : all) {
      if (at.node < told) continue;
      to.push_back(at);
      to.back().node -= begin;
    }
  };
  take(history_.ties, part.ties);
  take(history_.fixes, part.fixes);
  for (const std::size_t knot : history_.stations) {
    if (knot >= begin) part.stations.push_back(knot - begin);
  }
  return part;
}

RunHistory ForwardEstimate::History() const {
  RunHistory history = history_;
  history.knots.reserve(knots_.size());
  history.attitude.reserve(knots_.size());
  KeptKnots::Reader reader(knots_);
  while (const KeptKnot* kept = reader.Next()) {
    history.knots.push_back(kept->knot);
    history.attitude.push_back(kept->attitude);
  }
  return history;
}

ForwardEstimate::Ahead::Ahead(ForwardEstimate& now)
    : now_(now), forward_(*now.forward_), unseen_(now.unseen_) {}

ForwardEstimate::Ahead::~Ahead() {
  now_.recent_.erase(now_.recent_.end() - static_cast<std::ptrdiff_t>(steps_), now_.recent_.end());
}

bool ForwardEstimate::Ahead::Step(const WaitingKnot& waiting, const Increment& increment,
                                  const Increment* next) {
  now_.recent_.push_back(now_.KnotOf(waiting, increment, unseen_));
  ++steps_;
  return forward_.Step(now_.recent_, next) && forward_.SigmaOfHeading() < kRoughHeading;
}

StationState ForwardEstimate::Ahead::AddStation() {
  const std::size_t knots = now_.knots_.size() + steps_;
  const LinkedErrors errors = forward_.Mark(knots);
  const Eigen::Matrix3d& R_LT = forward_.node().R_LT;
  const AttitudeSample attitude = AttitudeOf(last(), R_LT, forward_.CovPhi());
  return StateOf(knots - 1, last(), attitude, R_LT, errors);
}

}  // namespace wellgyro

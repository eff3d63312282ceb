#include "wellgyro/survey/run/run_drafts.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "wellgyro/survey/run/stop_watch.h"

namespace wellgyro {
namespace {

constexpr Quality kUnseen = Quality::kGap | Quality::kSaturated | Quality::kAliased;

/// What the Earth measured at the stop, and what it is.
void TakeReferences(const NorthFix& fix, Station& station) {
  station.gravity = fix.gravity;
  station.gravity_ref = fix.gravity_ref;
  station.earth_rate = fix.earth_rate;
  station.earth_rate_ref = fix.earth_rate_ref;
}

}  // namespace

const StationState& RunDrafts::State(std::size_t number,
                                     std::span<const StationState> known) const {
  return number < known.size() ? known[number] : states_ahead_[number - known.size()];
}

std::vector<StationState> RunDrafts::States(std::span<const StationState> known) const {
  std::vector<StationState> states(known.begin(), known.end());
  states.insert(states.end(), states_ahead_.begin(), states_ahead_.end());
  return states;
}

void RunDrafts::Add(const Draft& waiting, std::size_t state, const RunKnot& knot, Quality unseen,
                    bool heard) {
  Draft draft = waiting;
  draft.state = state;
  Station& s = draft.station;
  const Increment& inc = knot.increment;
  s.imu_seq_begin = inc.seq_begin;
  s.imu_seq_end = inc.seq_end;
  s.samples_lost = inc.samples_lost;
  s.quality |= unseen;
  if (!knot.along.known) s.quality |= Quality::kDepth;
  book_.Add(draft, heard);
}

void RunDrafts::Take(const WaitingKnot& waiting, ForwardEstimate& estimate) {
  const RunKnot& knot = estimate.last();
  unseen_ |= knot.increment.quality & kUnseen;
  if (!waiting.draft) return;
  const std::size_t state = estimate.AddStation();
  if (waiting.told) {
    states_ahead_.pop_front();
  } else {
    Add(*waiting.draft, state, knot, unseen_, estimate.known().azimuth_known);
  }
  const std::vector<Draft>& drafts = book_.drafts();
  if (drafts[waiting.told.value_or(drafts.size() - 1)].listed) unseen_ = Quality::kGood;
}

bool RunDrafts::AnyUntold(const WaitingKnots& waiting) {
  return std::any_of(waiting.begin(), waiting.end(), [](const WaitingKnot& knot) {
    return knot.draft && knot.draft->listed && !knot.told;
  });
}

void RunDrafts::TellAhead(std::span<const Increment> increments, ForwardEstimate& estimate,
                          WaitingKnots& waiting) {
  ForwardEstimate::Ahead ahead(estimate);
  Quality unseen = unseen_;
  for (std::size_t i = 0; i < increments.size(); ++i) {
    WaitingKnot& knot = waiting[i];
    const Increment* next = i + 1 < increments.size() ? &increments[i + 1] : nullptr;
    if (!ahead.Step(knot, increments[i], next)) return;
    unseen |= ahead.last().increment.quality & kUnseen;
    if (!knot.draft) continue;
    StationState state = ahead.AddStation();
    if (!knot.told) {
      knot.told = book_.drafts().size();
      const std::size_t number = estimate.history().states.size() + states_ahead_.size();
      Add(*knot.draft, number, ahead.last(), unseen, state.attitude.azimuth_known);
      states_ahead_.push_back(std::move(state));
    }
    if (book_.drafts()[*knot.told].listed) unseen = Quality::kGood;
  }
}

void RunDrafts::Add(const StillWindow& window, const NorthFix& fix) {
  Draft draft;
  Station& s = draft.station;
  s.run = fix.run;
  s.tool = fix.tool;
  s.pass = Pass::kStationary;
  s.pass_number = 1;
  s.kind = StationKind::kStill;
  s.md = *fix.md;
  s.utc = window.utc_end;
  s.tool_time = window.end;
  TakeReferences(fix, s);
  draft.attitude = {window.end, fix.inclination,  fix.azimuth, fix.toolface,
                    true,       fix.cov_attitude, fix.quality};
  draft.mirror_azimuth = fix.mirror_azimuth;
  draft.mirror_cost = fix.mirror_cost;
  book_.Add(draft, true);
}

void RunDrafts::ListLast(WaitingKnots& waiting) {
  for (auto knot = waiting.rbegin(); knot != waiting.rend(); ++knot) {
    if (!knot->draft) continue;
    if (knot->told) break;
    knot->draft->listed = true;
    return;
  }
  if (!book_.drafts().empty()) book_.List(book_.drafts().size() - 1);
}

void RunDrafts::TakeStop(const NorthFix& fix, bool list) {
  if (!fix.md) return;
  std::vector<Draft>& drafts = book_.drafts();
  for (std::size_t i = drafts.size(); i-- > 0;) {
    Station& s = drafts[i].station;
    if (s.utc > fix.utc_end) continue;
    if (std::abs(s.md - *fix.md) > kOneStop) return;
    s.kind = StationKind::kGyrocompass;
    TakeReferences(fix, s);
    s.quality |= fix.quality;
    if (list) book_.List(i);
    return;
  }
}

void RunDrafts::CloseAtDeepest() {
  Draft* deepest = nullptr;
  for (Draft& draft : book_.drafts()) {
    draft.closes = false;
    if (draft.station.pass == Pass::kOut) continue;
    if (!deepest || draft.station.md > deepest->station.md) deepest = &draft;
  }
  if (deepest) deepest->closes = true;
}

}  // namespace wellgyro

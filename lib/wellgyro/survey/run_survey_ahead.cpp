// Stations told ahead of their knots.
#include <algorithm>
#include <cmath>

#include "wellgyro/base/angle.h"
#include "wellgyro/record/unknown_angle.h"
#include "wellgyro/survey/node_attitude.h"
#include "wellgyro/survey/run_survey.h"
#include "wellgyro/survey/run_survey_internal.h"

namespace wellgyro {

/// Increments of the knots that wait, as far as the samples there are end them: those that are
/// ready, then those of a copy of the builder that is flushed.
std::vector<Increment> RunSurvey::IncrementsAhead() {
  std::vector<Increment> increments;
  builder_ahead_ = builder_;
  builder_ahead_->Flush();
  for (const Waiting& waiting : waiting_) {
    if (waiting.increment) {
      increments.push_back(*waiting.increment);
      continue;
    }
    if (!builder_ahead_->Ready()) break;
    increments.push_back(builder_ahead_->Pop());
    if (std::abs((increments.back().time - waiting.end).ns) > kSameNs) {
      increments.pop_back();  // the builder's own, or one that ends in a gap
      break;
    }
  }
  return increments;
}

/// Stations of knots that wait for samples to better their increments, by what is known now: a
/// copy of the run goes through these knots.
void RunSurvey::TellAhead() {
  const bool all_told = std::none_of(waiting_.begin(), waiting_.end(),
                                     [](const Waiting& w) { return w.draft && !w.told; });
  if (!forward_ || all_told) return;
  const std::vector<Increment> increments = IncrementsAhead();
  ForwardRun forward = *forward_;
  UnseenTurn turn = unseen_;
  Quality unseen = unseen_since_listed_;
  const std::size_t known = knots_.size(), recent = recent_.size();
  for (std::size_t i = 0; i < increments.size(); ++i) {
    Waiting& waiting = waiting_[i];
    recent_.push_back(KnotOf(waiting, increments[i], turn));
    const Increment* next = i + 1 < increments.size() ? &increments[i + 1] : nullptr;
    if (!forward.Step(recent_, next) || !(forward.SigmaOfHeading() < kRoughHeading)) break;
    unseen |= increments[i].quality & kUnseen;
    if (!waiting.draft) continue;
    const RunKnot& knot = recent_.back();
    const LinkedErrors errors = forward.Mark(known + i + 1);
    if (!waiting.told) {
      const AttitudeSample attitude = AttitudeOf(knot, forward.node(), forward.CovPhi());
      waiting.told = drafts().size();
      states_ahead_.push_back(StateOf(known + i, knot, attitude, forward.node().R_LT, errors));
      AddDraft(*waiting.draft, history_.states.size() + states_ahead_.size() - 1, unseen,
               attitude.azimuth_known);
    }
    if (drafts()[*waiting.told].listed) unseen = Quality::kGood;
  }
  recent_.erase(recent_.begin() + static_cast<std::ptrdiff_t>(recent), recent_.end());
}

const StationState& RunSurvey::state(std::size_t number) const {
  const std::size_t known = history_.states.size();
  return number < known ? history_.states[number] : states_ahead_[number - known];
}

std::vector<StationState> RunSurvey::states() const {
  std::vector<StationState> states = history_.states;
  states.insert(states.end(), states_ahead_.begin(), states_ahead_.end());
  return states;
}

}  // namespace wellgyro

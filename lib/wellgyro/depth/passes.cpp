#include "wellgyro/depth/passes.h"

#include <algorithm>
#include <stdexcept>

namespace wellgyro {

PassTracker::PassTracker(const PassSetup& setup) : setup_(setup) {
  if (!(setup.first_move > 0 && setup.first_move <= setup.reversal)) {
    throw std::invalid_argument("PassTracker: first_move must be above 0 and at most reversal");
  }
}

void PassTracker::Begin(Pass pass, UtcTime utc, double md) {
  // The turn is where the old pass was furthest, before the way back that showed it.
  state_.utc_turn = utc_furthest_;
  state_.md_turn = state_.md;
  state_.pass = pass;
  ++state_.number;
  state_.begins = true;
  state_.md = md;
  utc_furthest_ = utc;
}

void PassTracker::Start(UtcTime utc, double md) {
  const std::int32_t number = restart_ ? state_.number + 1 : 1;
  const Pass pass = restart_ ? state_.pass : Pass::kStationary;
  state_ = {
      .pass = pass, .number = number, .begins = true, .md = md, .utc_turn = utc, .md_turn = md};
  utc_furthest_ = utc;
  md_low_ = md_high_ = md;
  deepest_in_.reset();
  started_ = true;
  restart_ = false;
}

Pass PassTracker::Inward(double md) const {
  return deepest_in_ && md < *deepest_in_ ? Pass::kRepeat : Pass::kIn;
}

void PassTracker::LeaveStationary(UtcTime utc, double md) {
  md_low_ = std::min(md_low_, md);
  md_high_ = std::max(md_high_, md);
  // From the far end of the standstill's own noise, so that a slow drift is seen as well.
  if (md - md_low_ >= setup_.first_move) {
    state_.md = md_low_;
    Begin(Pass::kIn, utc, md);
  } else if (md_high_ - md >= setup_.first_move) {
    state_.md = md_high_;
    Begin(Pass::kOut, utc, md);
  } else {
    utc_furthest_ = utc;
  }
}

const PassState& PassTracker::Push(UtcTime utc, double md) {
  if (!started_ || restart_) {
    Start(utc, md);
    return state_;
  }
  state_.begins = false;
  switch (state_.pass) {
    case Pass::kStationary:
      LeaveStationary(utc, md);
      break;
    case Pass::kIn:
    case Pass::kRepeat:
      if (md <= state_.md - setup_.reversal) {
        Begin(Pass::kOut, utc, md);
      } else if (md > state_.md) {
        state_.md = md;
        utc_furthest_ = utc;
        if (state_.pass == Pass::kRepeat && Inward(md) == Pass::kIn) Begin(Pass::kIn, utc, md);
      }
      break;
    case Pass::kOut:
      if (md >= state_.md + setup_.reversal) {
        Begin(Inward(md), utc, md);
      } else if (md < state_.md) {
        state_.md = md;
        utc_furthest_ = utc;
      }
      break;
  }
  if (state_.pass == Pass::kIn) deepest_in_ = std::max(deepest_in_.value_or(md), state_.md);
  return state_;
}

void PassTracker::Restart() { restart_ = started_; }

}  // namespace wellgyro

#include "wellgyro/depth/passes.h"

#include <algorithm>
#include <stdexcept>

#include <Eigen/Core>

namespace wellgyro {
namespace {

Eigen::Map<const Eigen::ArrayXd> Depths(std::span<const double> md) {
  return {md.data(), static_cast<Eigen::Index>(md.size())};
}

}  // namespace

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

std::optional<double> PassTracker::FurthestWithin(std::span<const double> md) const {
  if (!started_ || restart_ || md.empty()) return std::nullopt;
  const auto depths = Depths(md);
  const double low = depths.minCoeff(), high = depths.maxCoeff();
  switch (state_.pass) {
    case Pass::kStationary: {
      const double way = std::max(md_high_, high) - std::min(md_low_, low);
      if (!(way < setup_.first_move)) return std::nullopt;
      return state_.md;
    }
    case Pass::kIn:
    case Pass::kRepeat: {
      const double furthest = std::max(state_.md, high);
      const bool stays = low > furthest - setup_.reversal;
      const bool repeats = state_.pass == Pass::kRepeat && deepest_in_ && furthest < *deepest_in_;
      if (!stays || (state_.pass == Pass::kRepeat && !repeats)) return std::nullopt;
      return furthest;
    }
    case Pass::kOut: {
      const double furthest = std::min(state_.md, low);
      if (!(high < furthest + setup_.reversal)) return std::nullopt;
      return furthest;
    }
  }
  return std::nullopt;
}

const PassState& PassTracker::Push(std::span<const UtcTime> utc, std::span<const double> md) {
  const double furthest = *FurthestWithin(md);
  state_.begins = false;
  if (state_.pass == Pass::kStationary) {
    md_low_ = std::min(md_low_, Depths(md).minCoeff());
    md_high_ = std::max(md_high_, Depths(md).maxCoeff());
    utc_furthest_ = utc.back();
  } else if (furthest != state_.md) {
    const auto first = std::ranges::find(md, furthest) - md.begin();
    utc_furthest_ = utc[static_cast<std::size_t>(first)];
    state_.md = furthest;
  }
  if (state_.pass == Pass::kIn) {
    deepest_in_ = std::max(deepest_in_.value_or(furthest), furthest);
  }
  return state_;
}

void PassTracker::Restart() { restart_ = started_; }

}  // namespace wellgyro

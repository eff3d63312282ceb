#include "wellgyro/survey/wells/merge.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/survey/wells/leg_orders_internal.h"

namespace wellgyro {
namespace {

// Orders that are gone on with, the best so far: six stretches of two legs each are all tried, 2^6.
constexpr std::size_t kOrdersMax = 64;

class Merger {
 public:
  Merger(std::span<const MergeLeg> legs, const LegOrders& orders, const MergePolicy& policy)
      : legs_(legs), orders_(orders), policy_(policy) {}

  MergedSurvey Run() const;

 private:
  LegOrder FirstOfList() const;
  LegOrder Best() const;
  LegOrder WithoutSmallGains(LegOrder order) const;
  std::string ReasonFor(const LegOrder& order, std::size_t first, std::size_t last) const;
  void AddChoices(const LegOrder& order, MergedSurvey& merged) const;

  std::span<const MergeLeg> legs_;
  const LegOrders& orders_;
  const MergePolicy& policy_;
};

LegOrder Merger::FirstOfList() const {
  LegOrder order;
  for (const LegStretch& s : orders_.stretches()) order.push_back(s.candidates.front());
  return order;
}

/// Every order where there are few, the best so far otherwise, and those of single legs.
LegOrder Merger::Best() const {
  std::vector<LegOrder> orders = {{}};
  for (const LegStretch& s : orders_.stretches()) {
    std::vector<std::pair<double, LegOrder>> longer;
    for (const LegOrder& order : orders) {
      for (const std::size_t leg : s.candidates) {
        longer.emplace_back(0, order);
        longer.back().second.push_back(leg);
      }
    }
    if (longer.size() > kOrdersMax) {
      for (auto& [measure, order] : longer) measure = orders_.MeasureOf(order);
      std::ranges::stable_sort(longer, {}, &std::pair<double, LegOrder>::first);
      longer.resize(kOrdersMax);
    }
    orders.clear();
    for (auto& [measure, order] : longer) orders.push_back(std::move(order));
  }
  for (std::size_t leg = 0; leg < legs_.size(); ++leg) {
    LegOrder order = FirstOfList();
    for (std::size_t i = 0; i < order.size(); ++i) {
      if (std::ranges::count(orders_.stretches()[i].candidates, leg) > 0) order[i] = leg;
    }
    orders.push_back(std::move(order));
  }
  const LegOrder* best = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const LegOrder& order : orders) {
    const double measure = orders_.MeasureOf(order);
    if (measure < least) least = measure, best = &order;
  }
  if (!best) throw std::invalid_argument("no leg's error model reaches to the end of the survey");
  return *best;
}

/// A change of leg is undone, by letting the leg above go on or the one below begin earlier, where
/// that costs less than the policy's share in all.
LegOrder Merger::WithoutSmallGains(LegOrder order) const {
  const std::vector<LegStretch>& stretches = orders_.stretches();
  const double limit = orders_.MeasureOf(order) * (1 + policy_.min_gain);
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t i = 1; i < order.size() && !changed; ++i) {
      if (order[i] == order[i - 1]) continue;
      LegOrder down = order, up = order;
      for (std::size_t k = i; k < order.size() && order[k] == order[i]; ++k) {
        if (std::ranges::count(stretches[k].candidates, order[i - 1]) > 0) down[k] = order[i - 1];
      }
      for (std::size_t k = i; k-- > 0 && order[k] == order[i - 1];) {
        if (std::ranges::count(stretches[k].candidates, order[i]) > 0) up[k] = order[i];
      }
      const auto changes = [](const LegOrder& o) {
        std::size_t n = 0;
        for (std::size_t k = 1; k < o.size(); ++k) n += o[k] != o[k - 1];
        return n;
      };
      for (LegOrder* simpler : {&down, &up}) {
        if (changes(*simpler) >= changes(order) || orders_.MeasureOf(*simpler) > limit) continue;
        order = std::move(*simpler);
        changed = true;
        break;
      }
    }
  }
  return order;
}

std::string MeasureWords(MergeMeasure measure) {
  switch (measure) {
    case MergeMeasure::kVertical:
      return "vertical sigma";
    case MergeMeasure::kVolume:
      return "sixth root of the covariance's determinant";
    case MergeMeasure::kHorizontal:
      break;
  }
  return "horizontal semi-major axis";
}

/// Why stretches [first, last] are of the leg that they are.
std::string Merger::ReasonFor(const LegOrder& order, std::size_t first, std::size_t last) const {
  const std::size_t leg = order[first];
  if (legs_[leg].kept) return "the parent hole, above the kick-off";
  std::vector<std::size_t> others;
  for (std::size_t i = first; i <= last; ++i) {
    for (const std::size_t other : orders_.stretches()[i].candidates) {
      if (other != leg && std::ranges::count(others, other) == 0) others.push_back(other);
    }
  }
  if (others.empty()) return "no other leg reaches here";
  if (policy_.in_order) return "the first in the list that reaches here";
  const double measure = orders_.MeasureOf(order);
  std::string reason = fmt::format("{} {:.2f} m", MeasureWords(policy_.measure), measure);
  for (const std::size_t other : others) {
    LegOrder instead = order;
    for (std::size_t i = first; i <= last; ++i) {
      if (std::ranges::count(orders_.stretches()[i].candidates, other) > 0) instead[i] = other;
    }
    const double theirs = orders_.MeasureOf(instead);
    reason += std::isfinite(theirs)
                  ? fmt::format(", {:.2f} m with {} instead", theirs, legs_[other].name)
                  : fmt::format(", the model of {} does not reach", legs_[other].name);
  }
  return reason;
}

void Merger::AddChoices(const LegOrder& order, MergedSurvey& merged) const {
  std::vector<std::string> reasons;
  for (std::size_t first = 0; first < order.size();) {
    std::size_t last = first;
    while (last + 1 < order.size() && order[last + 1] == order[first]) ++last;
    const AssembledLegs upto =
        orders_.Assemble({order.begin(), order.begin() + static_cast<std::ptrdiff_t>(last) + 1});
    // A stretch whose only station belongs to the leg above makes no leg.
    if (upto.legs.size() > reasons.size()) reasons.push_back(ReasonFor(order, first, last));
    first = last + 1;
  }
  const AssembledLegs all = orders_.Assemble(order);
  for (std::size_t i = 0; i < all.legs.size(); ++i) {
    merged.choices.push_back({all.stations[all.legs[i].begin].md,
                              all.stations[all.legs[i].end - 1].md, all.leg_of[i], reasons[i]});
  }
  for (std::size_t leg = 0; leg < legs_.size(); ++leg) {
    if (std::ranges::count(all.leg_of, leg) > 0) continue;
    merged.unused.push_back(
        legs_[leg].left_out.empty()
            ? fmt::format("{}: others are {} wherever it reaches", legs_[leg].name,
                          policy_.in_order ? "before it" : "surer, or it gains too little,")
            : fmt::format("{}: ruled out: {}", legs_[leg].name, legs_[leg].left_out));
  }
}

MergedSurvey Merger::Run() const {
  const LegOrder order = policy_.in_order ? FirstOfList() : WithoutSmallGains(Best());
  MergedSurvey merged;
  AssembledLegs assembled = orders_.Assemble(order);
  merged.well = orders_.WellOf(assembled);
  merged.errors = orders_.Errors(merged.well, assembled);
  merged.measure = orders_.MeasureOf(order);
  AddChoices(order, merged);
  merged.legs = std::move(assembled.legs);
  return merged;
}

}  // namespace

MergedSurvey Merge(std::span<const MergeLeg> legs, const Eigen::Vector3d& start_W,
                   const Eigen::Matrix3d& cov_tie_in_W, const Surroundings& surroundings,
                   const MergePolicy& policy) {
  for (const MergeLeg& leg : legs) {
    if (leg.stations.empty() || !leg.model) {
      throw std::invalid_argument("leg " + leg.name + " needs stations and a model");
    }
  }
  const LegOrders orders(legs, start_W, cov_tie_in_W, surroundings, policy);
  return Merger(legs, orders, policy).Run();
}

}  // namespace wellgyro

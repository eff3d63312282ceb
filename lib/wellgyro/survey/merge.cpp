#include "wellgyro/survey/merge.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include <Eigen/LU>
#include <fmt/core.h>

#include "wellgyro/survey/same_depth_internal.h"
#include "wellgyro/uncertainty/ellipse.h"

namespace wellgyro {
namespace {

constexpr std::size_t kOrdersMax = 64;

/// One leg for each stretch between two breaks.
using Order = std::vector<std::size_t>;

struct Stretch {
  double begin = 0, end = 0;            // stations of (begin, end]
  std::vector<std::size_t> candidates;  // legs that reach all through it
};

/// The survey that an order makes.
struct Assembled {
  std::vector<SurveyPoint> stations;
  std::vector<ToolLeg> legs;
  std::vector<std::size_t> leg_of;  // of each tool leg
};

class Merger {
 public:
  Merger(std::span<const MergeLeg> legs, const Eigen::Vector3d& start_W,
         const Eigen::Matrix3d& cov_tie_in_W, const Surroundings& surroundings,
         const MergePolicy& policy)
      : legs_(legs),
        start_W_(start_W),
        cov_tie_in_W_(cov_tie_in_W),
        surroundings_(surroundings),
        policy_(policy) {}

  MergedSurvey Run();

 private:
  bool Reaches(std::size_t leg, double begin, double end) const;
  void FindStretches();
  Assembled Assemble(const Order& order) const;
  PositionUncertainty Errors(const SurveyedWell& well, const Assembled& assembled) const;
  double MeasureOf(const Order& order) const;
  Order FirstOfList() const;
  Order Best() const;
  Order WithoutSmallGains(Order order) const;
  std::string ReasonFor(const Order& order, std::size_t first, std::size_t last) const;
  void AddChoices(const Order& order, MergedSurvey& merged) const;

  std::span<const MergeLeg> legs_;
  Eigen::Vector3d start_W_;
  Eigen::Matrix3d cov_tie_in_W_;
  const Surroundings& surroundings_;
  const MergePolicy& policy_;
  std::vector<Stretch> stretches_;
};

bool Merger::Reaches(std::size_t leg, double begin, double end) const {
  const auto& stations = legs_[leg].stations;
  if (!legs_[leg].left_out.empty()) return false;
  return stations.front().md <= begin + kRoundedDepth && stations.back().md >= end - kRoundedDepth;
}

/// Breaks are where a leg begins or ends. Stretches that no leg reaches through are courses between
/// two legs, and belong to the stretch below.
void Merger::FindStretches() {
  std::vector<double> breaks;
  for (const MergeLeg& leg : legs_) {
    if (!leg.left_out.empty()) continue;
    breaks.push_back(leg.stations.front().md);
    breaks.push_back(leg.stations.back().md);
  }
  if (breaks.empty()) throw std::invalid_argument("every leg is ruled out");
  std::ranges::sort(breaks);
  const auto same = [](double a, double b) { return b - a < kRoundedDepth; };
  breaks.erase(std::unique(breaks.begin(), breaks.end(), same), breaks.end());
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    Stretch stretch{breaks[i], breaks[i + 1], {}};
    for (std::size_t leg = 0; leg < legs_.size(); ++leg) {
      if (Reaches(leg, stretch.begin, stretch.end)) stretch.candidates.push_back(leg);
    }
    const auto kept =
        std::ranges::find_if(stretch.candidates, [&](std::size_t leg) { return legs_[leg].kept; });
    if (kept != stretch.candidates.end()) stretch.candidates = {*kept};
    if (stretch.candidates.empty() && stretch.end - stretch.begin > policy_.max_gap) {
      throw std::invalid_argument(
          fmt::format("no leg has stations from MD {:.2f} to {:.2f} m: a gap of more than {:g} m",
                      stretch.begin, stretch.end, policy_.max_gap));
    }
    if (!stretch.candidates.empty()) stretches_.push_back(std::move(stretch));
  }
  if (stretches_.empty()) throw std::invalid_argument("the legs hold fewer than two stations");
}

Assembled Merger::Assemble(const Order& order) const {
  Assembled made;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const MergeLeg& leg = legs_[order[i]];
    const bool goes_on = i > 0 && order[i] == order[i - 1];
    const std::size_t begin = made.stations.size();
    for (const SurveyPoint& p : leg.stations) {
      const double above = made.stations.empty() ? -std::numeric_limits<double>::infinity()
                                                 : made.stations.back().md;
      if (p.md > above + kRoundedDepth && p.md >= stretches_[i].begin - kRoundedDepth &&
          p.md <= stretches_[i].end + kRoundedDepth) {
        made.stations.push_back(p);
      }
    }
    if (made.stations.size() == begin) continue;
    if (goes_on && !made.legs.empty() && made.leg_of.back() == order[i]) {
      made.legs.back().end = made.stations.size();
    } else {
      made.legs.push_back({leg.model, begin, made.stations.size(), leg.run});
      made.leg_of.push_back(order[i]);
    }
  }
  return made;
}

PositionUncertainty Merger::Errors(const SurveyedWell& well, const Assembled& assembled) const {
  PropagateOptions options;
  options.cov_tie_in_W = cov_tie_in_W_;
  return PropagateErrors(well.survey, surroundings_, assembled.legs, options);
}

/// At the deepest station of the order, or where the policy says if it reaches there; infinite
/// where a model ends before.
double Merger::MeasureOf(const Order& order) const {
  const Assembled assembled = Assemble(order);
  if (assembled.stations.size() < 2) return 0;
  const SurveyedWell well = SurveyWell(assembled.stations, start_W_);
  const PositionUncertainty errors = Errors(well, assembled);
  if (errors.refusal) return std::numeric_limits<double>::infinity();
  std::size_t at = well.survey.size() - 1;
  if (policy_.at_md && *policy_.at_md < well.survey.back().md) {
    const auto place =
        std::ranges::lower_bound(well.survey, *policy_.at_md - kRoundedDepth, {}, &SurveyPoint::md);
    at = static_cast<std::size_t>(place - well.survey.begin());
  }
  const Eigen::Matrix3d& cov = errors.cov_p_W[at];
  switch (policy_.measure) {
    case MergeMeasure::kVertical:
      return std::sqrt(std::max(0.0, cov(2, 2)));
    case MergeMeasure::kVolume:
      return std::pow(std::max(0.0, cov.determinant()), 1.0 / 6);
    case MergeMeasure::kHorizontal:
      break;
  }
  return HorizontalEllipse(cov, 0.5).semi_major / ConfidenceFactor(0.5, 2);
}

Order Merger::FirstOfList() const {
  Order order;
  for (const Stretch& s : stretches_) order.push_back(s.candidates.front());
  return order;
}

/// Every order where there are few, the best so far otherwise, and those of single legs.
Order Merger::Best() const {
  std::vector<Order> orders = {{}};
  for (const Stretch& s : stretches_) {
    std::vector<std::pair<double, Order>> longer;
    for (const Order& order : orders) {
      for (const std::size_t leg : s.candidates) {
        longer.emplace_back(0, order);
        longer.back().second.push_back(leg);
      }
    }
    if (longer.size() > kOrdersMax) {
      for (auto& [measure, order] : longer) measure = MeasureOf(order);
      std::ranges::stable_sort(longer, {}, &std::pair<double, Order>::first);
      longer.resize(kOrdersMax);
    }
    orders.clear();
    for (auto& [measure, order] : longer) orders.push_back(std::move(order));
  }
  for (std::size_t leg = 0; leg < legs_.size(); ++leg) {
    Order order = FirstOfList();
    for (std::size_t i = 0; i < order.size(); ++i) {
      if (std::ranges::count(stretches_[i].candidates, leg) > 0) order[i] = leg;
    }
    orders.push_back(std::move(order));
  }
  const Order* best = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const Order& order : orders) {
    const double measure = MeasureOf(order);
    if (measure < least) least = measure, best = &order;
  }
  if (!best) throw std::invalid_argument("no leg's error model reaches to the end of the survey");
  return *best;
}

/// A change of leg is undone, by letting the leg above go on or the one below begin earlier, where
/// that costs less than the policy's share in all.
Order Merger::WithoutSmallGains(Order order) const {
  const double limit = MeasureOf(order) * (1 + policy_.min_gain);
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t i = 1; i < order.size() && !changed; ++i) {
      if (order[i] == order[i - 1]) continue;
      Order down = order, up = order;
      for (std::size_t k = i; k < order.size() && order[k] == order[i]; ++k) {
        if (std::ranges::count(stretches_[k].candidates, order[i - 1]) > 0) down[k] = order[i - 1];
      }
      for (std::size_t k = i; k-- > 0 && order[k] == order[i - 1];) {
        if (std::ranges::count(stretches_[k].candidates, order[i]) > 0) up[k] = order[i];
      }
      const auto changes = [](const Order& o) {
        std::size_t n = 0;
        for (std::size_t k = 1; k < o.size(); ++k) n += o[k] != o[k - 1];
        return n;
      };
      for (Order* simpler : {&down, &up}) {
        if (changes(*simpler) >= changes(order) || MeasureOf(*simpler) > limit) continue;
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
std::string Merger::ReasonFor(const Order& order, std::size_t first, std::size_t last) const {
  const std::size_t leg = order[first];
  if (legs_[leg].kept) return "the parent hole, above the kick-off";
  std::vector<std::size_t> others;
  for (std::size_t i = first; i <= last; ++i) {
    for (const std::size_t other : stretches_[i].candidates) {
      if (other != leg && std::ranges::count(others, other) == 0) others.push_back(other);
    }
  }
  if (others.empty()) return "no other leg reaches here";
  if (policy_.in_order) return "the first in the list that reaches here";
  const double measure = MeasureOf(order);
  std::string reason = fmt::format("{} {:.2f} m", MeasureWords(policy_.measure), measure);
  for (const std::size_t other : others) {
    Order instead = order;
    for (std::size_t i = first; i <= last; ++i) {
      if (std::ranges::count(stretches_[i].candidates, other) > 0) instead[i] = other;
    }
    const double theirs = MeasureOf(instead);
    reason += std::isfinite(theirs)
                  ? fmt::format(", {:.2f} m with {} instead", theirs, legs_[other].name)
                  : fmt::format(", the model of {} does not reach", legs_[other].name);
  }
  return reason;
}

void Merger::AddChoices(const Order& order, MergedSurvey& merged) const {
  std::vector<std::string> reasons;
  for (std::size_t first = 0; first < order.size();) {
    std::size_t last = first;
    while (last + 1 < order.size() && order[last + 1] == order[first]) ++last;
    const Assembled upto =
        Assemble({order.begin(), order.begin() + static_cast<std::ptrdiff_t>(last) + 1});
    // A stretch whose only station belongs to the leg above makes no leg.
    if (upto.legs.size() > reasons.size()) reasons.push_back(ReasonFor(order, first, last));
    first = last + 1;
  }
  const Assembled all = Assemble(order);
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

MergedSurvey Merger::Run() {
  for (const MergeLeg& leg : legs_) {
    if (leg.stations.empty() || !leg.model) {
      throw std::invalid_argument("leg " + leg.name + " needs stations and a model");
    }
  }
  FindStretches();
  const Order order = policy_.in_order ? FirstOfList() : WithoutSmallGains(Best());
  MergedSurvey merged;
  Assembled assembled = Assemble(order);
  merged.well = SurveyWell(assembled.stations, start_W_);
  merged.errors = Errors(merged.well, assembled);
  merged.measure = MeasureOf(order);
  AddChoices(order, merged);
  merged.legs = std::move(assembled.legs);
  return merged;
}

}  // namespace

MergedSurvey Merge(std::span<const MergeLeg> legs, const Eigen::Vector3d& start_W,
                   const Eigen::Matrix3d& cov_tie_in_W, const Surroundings& surroundings,
                   const MergePolicy& policy) {
  return Merger(legs, start_W, cov_tie_in_W, surroundings, policy).Run();
}

}  // namespace wellgyro

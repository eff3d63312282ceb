#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include <Eigen/LU>
#include <fmt/core.h>

#include "wellgyro/survey/hole/same_depth_internal.h"
#include "wellgyro/survey/wells/leg_orders_internal.h"
#include "wellgyro/uncertainty/ellipse.h"

namespace wellgyro {
namespace {

/// A leg that is ruled out reaches nowhere.
bool Reaches(const MergeLeg& leg, double begin, double end) {
  if (!leg.left_out.empty()) return false;
  return leg.stations.front().md <= begin + kRoundedDepth &&
         leg.stations.back().md >= end - kRoundedDepth;
}

/// Depths at which a leg begins or ends.
std::vector<double> BreaksOf(std::span<const MergeLeg> legs) {
  std::vector<double> breaks;
  for (const MergeLeg& leg : legs) {
    if (!leg.left_out.empty()) continue;
    breaks.push_back(leg.stations.front().md);
    breaks.push_back(leg.stations.back().md);
  }
  if (breaks.empty()) throw std::invalid_argument("every leg is ruled out");
  std::ranges::sort(breaks);
  const auto same = [](double a, double b) { return b - a < kRoundedDepth; };
  breaks.erase(std::unique(breaks.begin(), breaks.end(), same), breaks.end());
  return breaks;
}

/// Between breaks. Stretches that no leg reaches through are courses between two legs, and belong
/// to the stretch below.
std::vector<LegStretch> StretchesOf(std::span<const MergeLeg> legs, const MergePolicy& policy) {
  const std::vector<double> breaks = BreaksOf(legs);
  std::vector<LegStretch> stretches;
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    LegStretch stretch{breaks[i], breaks[i + 1], {}};
    for (std::size_t leg = 0; leg < legs.size(); ++leg) {
      if (Reaches(legs[leg], stretch.begin, stretch.end)) stretch.candidates.push_back(leg);
    }
    const auto kept =
        std::ranges::find_if(stretch.candidates, [&](std::size_t leg) { return legs[leg].kept; });
    if (kept != stretch.candidates.end()) stretch.candidates = {*kept};
    if (stretch.candidates.empty() && stretch.end - stretch.begin > policy.max_gap) {
      throw std::invalid_argument(
          fmt::format("no leg has stations from MD {:.2f} to {:.2f} m: a gap of more than {:g} m",
                      stretch.begin, stretch.end, policy.max_gap));
    }
    if (!stretch.candidates.empty()) stretches.push_back(std::move(stretch));
  }
  if (stretches.empty()) throw std::invalid_argument("the legs hold fewer than two stations");
  return stretches;
}

}  // namespace

void CheckLegs(std::span<const MergeLeg> legs, const MergePolicy& policy) {
  static_cast<void>(StretchesOf(legs, policy));
}

LegOrders::LegOrders(std::span<const MergeLeg> legs, const Eigen::Vector3d& start_W,
                     const Eigen::Matrix3d& cov_tie_in_W, const Surroundings& surroundings,
                     const MergePolicy& policy)
    : legs_(legs),
      start_W_(start_W),
      cov_tie_in_W_(cov_tie_in_W),
      surroundings_(surroundings),
      policy_(policy),
      stretches_(StretchesOf(legs, policy)) {}

AssembledLegs LegOrders::Assemble(const LegOrder& order) const {
  AssembledLegs made;
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

SurveyedWell LegOrders::WellOf(const AssembledLegs& assembled) const {
  return SurveyWell(assembled.stations, start_W_);
}

PositionUncertainty LegOrders::Errors(const SurveyedWell& well,
                                      const AssembledLegs& assembled) const {
  PropagateOptions options;
  options.cov_tie_in_W = cov_tie_in_W_;
  return PropagateErrors(well.survey, surroundings_, assembled.legs, options);
}

double LegOrders::MeasureOf(const LegOrder& order) const {
  const AssembledLegs assembled = Assemble(order);
  if (assembled.stations.size() < 2) return 0;
  const SurveyedWell well = WellOf(assembled);
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

}  // namespace wellgyro

#include "wellgyro/plan/stop_plan.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/plan/stop_pairs.h"

namespace wellgyro {
namespace {

using Rest = StopStand::Rest;

// Places for a stop: one a stand, or as many to the way as make the matrices of a second's work.
// Half as many places make the plan of the demonstration's well 10 s longer, of 650 s at rest.
constexpr double kPlacesMost = 100;
// Rounds of search and verification; each holds the search to what the last was above the limit,
// and to kBelow of it, so that what is mended ends below the limit and not at it: 0.998^8 = 0.984
// after the last.
constexpr int kVerifications = 8;
constexpr double kBelow = 0.998;
// And of a fault, which the search knows less well, at most this: 0.95^8 = 0.66 after the last.
constexpr double kHiddenShare = 0.95;
// Of the limit, that the whole run may say: half of what kBelow takes off.
constexpr double kMet = 1.001;

void CheckLimits(const PlanLimits& limits) {
  const auto need = [](bool holds, const char* name, double value, const char* what) {
    if (holds) return;
    throw std::invalid_argument(fmt::format("{} {}, is {:g}", name, what, value));
  };
  need(limits.ellipse > 0, "ellipse", limits.ellipse, "must be positive");
  if (limits.hidden) need(*limits.hidden > 0, "hidden", *limits.hidden, "must be positive");
  need(limits.least_stop >= plan_range::kStopLeast, "least_stop", limits.least_stop,
       "must be 10 s at least");
  need(limits.longest_stop >= limits.least_stop && limits.longest_stop <= plan_range::kStopMost,
       "longest_stop", limits.longest_stop, "must lie between least_stop and two hours");
  need(limits.overhead >= 0, "overhead", limits.overhead, "must not be negative");
}

std::vector<PlannedStop> StopsOf(const StopInformation& info, const std::vector<Rest>& rests,
                                 bool turns) {
  std::vector<PlannedStop> stops;
  for (const Rest& rest : rests) {
    const StopPlace& place = info.place(rest.place);
    PlannedStop stop{place.out, place.md, rest.seconds, {}};
    if (turns) stop.toolface = WrapTwoPi(place.toolface + rest.turn);
    stops.push_back(stop);
  }
  return stops;
}

/// Of an ellipse by the whole run again, to which the search's sums are off by a tenth where few
/// stops bear it; of a hidden fault by those sums, which know the gyros' steps.
std::vector<StopWorth> WorthOf(const PlanCase& c, const StopPlan& plan, const StopStand& stand) {
  std::vector<StopWorth> worth;
  for (std::size_t i = 0; i < plan.stops.size(); ++i) {
    std::vector<PlannedStop> others = plan.stops;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    const Rest& rest = stand.stops()[i];
    worth.push_back({ExpectEnd(c, others, false).semi_major,
                     stand.ValueWith({rest.place, rest.turn, -rest.seconds}).hidden});
  }
  return worth;
}

std::string WhyNot(const PlanLimits& limits, const PlanValue& best, const ExpectedEnd& expected) {
  if (best.ellipse > limits.ellipse) {
    return fmt::format(
        "no plan has an ellipse of {:g} m: an hour at rest at every fortieth of the way leaves "
        "{:.2f} m",
        limits.ellipse, best.ellipse);
  }
  if (limits.hidden && best.hidden > *limits.hidden) {
    return fmt::format(
        "no plan shows every fault that moves the end by {:g} m: after an hour at rest at every "
        "fortieth of the way one of {:.2f} m stays unseen",
        *limits.hidden, best.hidden);
  }
  if (limits.hidden && expected.hidden > *limits.hidden * kMet) {
    return fmt::format(
        "{} may still move the end by {:.2f} m and stay unseen, above {:g} m: the search found no "
        "stops that show it",
        expected.hidden_cause, expected.hidden, *limits.hidden);
  }
  return fmt::format("the limits would take more than {:.0f} s at rest", limits.most_at_rest);
}

/// Tightened by as much as the whole run was above the limits; false: it was not.
bool Tighten(const PlanLimits& limits, const ExpectedEnd& expected, const PlanValue& sought,
             PlanLimits& aim) {
  bool missed = false;
  if (expected.semi_major > limits.ellipse * kMet) {
    aim.ellipse *= kBelow * limits.ellipse / expected.semi_major;
    missed = true;
  }
  if (limits.hidden && expected.hidden > *limits.hidden * kMet) {
    // Of steps the search knows those of the gyros alone; what shows them shows others too.
    const double share = std::min(kHiddenShare, kBelow * *limits.hidden / expected.hidden);
    aim.hidden = std::min(*aim.hidden, sought.hidden) * share;
    missed = true;
  }
  return missed;
}

double LeastCost(const StopInformation& info, const PlanLimits& limits, double at_rest) {
  if (limits.fewest == 0 && at_rest == 0) return 0;
  const double stops = std::max(3.0, std::ceil(at_rest / limits.longest_stop));
  const double more = stops * limits.overhead + std::max(at_rest, stops * limits.least_stop);
  const auto few = BestOfTwo(info, limits, more + kStopGrain);
  if (!few) return more;
  double cost = limits.overhead * static_cast<double>(few->size());
  for (const Rest& rest : *few) cost += rest.seconds;
  return std::min(cost, more);
}

/// Bounds of what a plan takes; the times that come to the first.
std::vector<Rest> AddBounds(const StopInformation& info, const PlanLimits& limits, StopPlan& plan) {
  const auto relaxed = LeastAtRest(info, limits);
  if (!relaxed) return {};
  plan.least_at_rest = relaxed->least;
  plan.least_cost = LeastCost(info, limits, relaxed->least);
  return relaxed->rests;
}

}  // namespace

StopPlan PlanStops(const PlanCase& c, const PlanLimits& limits) {
  CheckLimits(limits);
  CheckPlanCase(c, {});
  const double length = c.way.end_md - c.way.begin_md;
  const StopInformation info(c, PlacesEvery(c.way, std::max(units::kStand, length / kPlacesMost)),
                             {.with_faults = limits.hidden.has_value()});
  StopPlan plan;
  plan.without = ExpectEnd(c, {}, true);
  plan.best_possible = BestPossible(info, limits);
  const bool possible = plan.best_possible.Meets(limits.ellipse, limits.hidden.value_or(HUGE_VAL));
  PlanLimits aim = limits;
  if (c.sigma_start_azimuth) aim.fewest = 0;
  std::vector<Rest> start;
  if (possible) start = AddBounds(info, aim, plan);
  StopStand stand(info, limits.ellipse, limits.hidden.value_or(HUGE_VAL));
  std::optional<std::vector<Rest>> rests;
  for (int i = 0; possible && !plan.feasible && i < kVerifications; ++i) {
    if (rests) rests = MendStops(info, aim, *rests);
    if (!rests) rests = FindStops(info, aim, start);
    if (!rests) break;
    plan.stops = StopsOf(info, *rests, limits.turns);
    plan.expected = ExpectEnd(c, plan.stops, limits.hidden.has_value());
    stand = StopStand(info, limits.ellipse, limits.hidden.value_or(HUGE_VAL));
    for (const Rest& rest : *rests) stand.Add(rest);
    plan.feasible = !Tighten(limits, plan.expected, stand.Value(), aim);
  }
  if (!limits.hidden && !plan.stops.empty()) plan.expected = ExpectEnd(c, plan.stops, true);
  plan.worth = WorthOf(c, plan, stand);
  for (const PlannedStop& stop : plan.stops) plan.at_rest += stop.seconds;
  plan.cost = plan.at_rest + limits.overhead * static_cast<double>(plan.stops.size());
  if (!plan.feasible) plan.why_not = WhyNot(limits, plan.best_possible, plan.expected);
  return plan;
}

PlanCase WorseTool(PlanCase c, double factor) {
  NoiseCoefficients& gyro = c.gyro;
  gyro.bias_instability *= factor;
  gyro.rate_random_walk *= factor;
  gyro.rate_ramp *= factor;
  ErrorPriors& errors = c.errors;
  errors.gyro_bias_sigma *= factor;
  errors.mass_unbalance_sigma *= factor;
  errors.quadrature_sigma *= factor;
  return c;
}

}  // namespace wellgyro

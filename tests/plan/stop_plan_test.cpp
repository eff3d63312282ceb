#include "wellgyro/plan/stop_plan.h"

#include <cstdio>
#include <stdexcept>

#include <gtest/gtest.h>

#include "plan/cases.h"

namespace wellgyro {
namespace {

/// At a speed that leaves little to sum up; what is planned is of the same kind.
PlanCase Fast(PlanCase c) {
  c.way.speed_in = c.way.speed_out = 3;
  return c;
}

double CostOf(const std::vector<PlannedStop>& stops, double overhead) {
  double cost = 0;
  for (const PlannedStop& stop : stops) cost += stop.seconds + overhead;
  return cost;
}

/// The plan for the ellipse that three minutes every 300 m come to.
struct Compared {
  ExpectedEnd practice;
  double practice_cost = 0;
  PlanLimits limits;
  StopPlan plan;
};
Compared Compare(const PlanCase& c) {
  Compared r;
  const std::vector<PlannedStop> stops = Practice(c.way, 300, 180);
  r.practice = ExpectEnd(c, stops, false);
  r.practice_cost = CostOf(stops, r.limits.overhead);
  r.limits.ellipse = r.practice.semi_major;
  r.plan = PlanStops(c, r.limits);
  return r;
}

/// Meets the ellipse in `share` of the practice's time, and never in less than the bound.
void ExpectSaving(const PlanCase& c, double share) {
  const Compared r = Compare(c);
  ASSERT_TRUE(r.plan.feasible) << r.plan.why_not;
  EXPECT_LE(r.plan.expected.semi_major, 1.001 * r.limits.ellipse);
  EXPECT_LE(r.plan.cost, share * r.practice_cost);
  EXPECT_DOUBLE_EQ(r.plan.cost, CostOf(r.plan.stops, r.limits.overhead));
  ASSERT_TRUE(r.plan.least_at_rest);
  EXPECT_GE(r.plan.at_rest, *r.plan.least_at_rest * 0.99);
  EXPECT_LE(r.plan.at_rest, *r.plan.least_at_rest * 1.35);
  std::printf("practice %.2f m in %.0f s; plan %.2f m in %.0f s, %.0f s at rest, bound %.0f s\n",
              r.practice.semi_major, r.practice_cost, r.plan.expected.semi_major, r.plan.cost,
              r.plan.at_rest, *r.plan.least_at_rest);
}

TEST(StopPlan, SavesTimeAgainstStopsEvery300MetresOnASlant) { ExpectSaving(test::Slant(), 0.2); }
TEST(StopPlan, SavesTimeAgainstStopsEvery300MetresSlidingOnAnS) {
  ExpectSaving(test::SShape(), 0.5);
}
TEST(StopPlan, SavesTimeAgainstStopsEvery300MetresToHorizontal) {
  ExpectSaving(test::Horizontal(), 0.2);
}

// What a plan takes beyond the bound is what its stops cost, not what the search misses.
TEST(StopPlan, WhereStopsAreFreeItComesNearTheBound) {
  for (const PlanCase& c : {test::Slant(), test::SShape(), test::Horizontal()}) {
    PlanLimits limits{.least_stop = 10, .overhead = 0};
    limits.ellipse = ExpectEnd(c, Practice(c.way, 300, 180), false).semi_major;
    const StopPlan plan = PlanStops(c, limits);
    ASSERT_TRUE(plan.feasible && plan.least_at_rest);
    EXPECT_GE(plan.at_rest, *plan.least_at_rest * 0.99);
    EXPECT_LE(plan.at_rest, *plan.least_at_rest * 1.05);
    std::printf("%zu stops, %.0f s at rest, bound %.0f s\n", plan.stops.size(), plan.at_rest,
                *plan.least_at_rest);
  }
}

TEST(StopPlan, AStopLeftOutCostsWhatThePlanSays) {
  const PlanCase c = Fast(test::SShape());
  const StopPlan plan = PlanStops(c, {.ellipse = 6});
  ASSERT_TRUE(plan.feasible) << plan.why_not;
  ASSERT_GE(plan.stops.size(), 2u);
  for (std::size_t i = 0; i < plan.stops.size(); ++i) {
    std::vector<PlannedStop> others = plan.stops;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    const ExpectedEnd without = ExpectEnd(c, others, false);
    // It is this stop's and no other's.
    EXPECT_NEAR(without.semi_major / plan.worth[i].ellipse_without, 1, 1e-9);
    EXPECT_GT(without.semi_major, 6) << "the plan has a stop that it does not need";
  }
}

TEST(StopPlan, AHiddenLimitIsKeptAndCostsMore) {
  const PlanCase c = Fast(test::Slant());
  PlanLimits limits{.ellipse = 7.5};
  const StopPlan free = PlanStops(c, limits);
  limits.hidden = 0.8 * free.expected.hidden;
  const StopPlan held = PlanStops(c, limits);
  ASSERT_TRUE(free.feasible && held.feasible) << held.why_not;
  EXPECT_LE(held.expected.hidden, 1.001 * *limits.hidden);
  EXPECT_LE(held.expected.semi_major, 1.001 * limits.ellipse);
  EXPECT_GT(held.cost, free.cost);
}

TEST(StopPlan, SaysPlainlyWhereNoPlanMeetsALimit) {
  const PlanCase c = Fast(test::Slant());
  const StopPlan ellipse = PlanStops(c, {.ellipse = 0.3});
  EXPECT_FALSE(ellipse.feasible);
  EXPECT_TRUE(ellipse.stops.empty());
  EXPECT_FALSE(ellipse.least_at_rest);
  EXPECT_NE(ellipse.why_not.find("no plan has an ellipse of 0.30 m"), std::string::npos);
  const StopPlan hidden = PlanStops(c, {.ellipse = 7, .hidden = 0.2});
  EXPECT_FALSE(hidden.feasible);
  EXPECT_NE(hidden.why_not.find("unseen"), std::string::npos);
  EXPECT_THROW(PlanStops(c, {.ellipse = -1}), std::invalid_argument);
  EXPECT_THROW(PlanStops(c, {.least_stop = 100, .longest_stop = 50}), std::invalid_argument);
}

TEST(StopPlan, ChosenToolfacesSaveTime) {
  const PlanCase c =
      Fast(test::SShape());  // it slides: as the tool comes it shows its gyros one face
  PlanLimits limits{.ellipse = 6};
  const StopPlan as_it_comes = PlanStops(c, limits);
  limits.turns = true;
  const StopPlan turned = PlanStops(c, limits);
  ASSERT_TRUE(as_it_comes.feasible && turned.feasible) << turned.why_not;
  EXPECT_LE(turned.expected.semi_major, 6.01);
  EXPECT_LT(turned.cost, as_it_comes.cost);
  for (const PlannedStop& stop : turned.stops) EXPECT_TRUE(stop.toolface);
}

// The north that a run begins with is found at rest, however loose the limit.
TEST(StopPlan, ALooseLimitTakesOneStopForTheNorthAndNoneWhereItIsTold) {
  PlanCase c = Fast(test::Slant());
  const StopPlan plan = PlanStops(c, {.ellipse = 100});
  EXPECT_TRUE(plan.feasible);
  ASSERT_EQ(plan.stops.size(), 1u);
  EXPECT_EQ(plan.stops[0].seconds, PlanLimits().least_stop);
  EXPECT_EQ(plan.least_at_rest, 0);
  c.sigma_start_azimuth = 0.5 * units::kDeg;
  EXPECT_TRUE(PlanStops(c, {.ellipse = 100}).stops.empty());
}

TEST(StopPlan, AWorseToolIsWorse) {
  const PlanCase c = Fast(test::Slant());
  const std::vector<PlannedStop> stops = Practice(c.way, 600, 120);
  EXPECT_GT(ExpectEnd(WorseTool(c, 5), stops, false).semi_major,
            1.2 * ExpectEnd(c, stops, false).semi_major);
}

}  // namespace
}  // namespace wellgyro

#include "wellgyro/plan/stop_plan.h"

#include <cstdio>
#include <stdexcept>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "wellgyro/plan/stop_pairs.h"
#include "wellgyro/plan/stop_search.h"

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
Compared Compare(const PlanCase& c, bool turns) {
  Compared r;
  r.limits.turns = turns;
  const std::vector<PlannedStop> stops = Practice(c.way, 300, 180);
  r.practice = ExpectEnd(c, stops, false);
  r.practice_cost = CostOf(stops, r.limits.overhead);
  r.limits.ellipse = r.practice.semi_major;
  r.plan = PlanStops(c, r.limits);
  return r;
}

/// Meets the ellipse in `share` of the practice's time; what it takes at rest is within a tenth of
/// the bound of its cost less the overhead that this has for as many stops.
void ExpectSaving(const PlanCase& c, bool turns, double share) {
  const Compared r = Compare(c, turns);
  ASSERT_TRUE(r.plan.feasible) << r.plan.why_not;
  EXPECT_LE(r.plan.expected.semi_major, 1.001 * r.limits.ellipse);
  EXPECT_LE(r.plan.cost, share * r.practice_cost);
  EXPECT_DOUBLE_EQ(r.plan.cost, CostOf(r.plan.stops, r.limits.overhead));
  ASSERT_TRUE(r.plan.least_at_rest && r.plan.least_cost);
  EXPECT_GE(r.plan.at_rest, *r.plan.least_at_rest * 0.99);
  EXPECT_GE(r.plan.cost, *r.plan.least_cost * 0.99);
  const double overhead = r.plan.cost - r.plan.at_rest;
  EXPECT_LE(0.9 * r.plan.at_rest, *r.plan.least_cost - overhead);
  std::printf(
      "practice %.2f m in %.0f s; plan %.2f m in %.0f s, bound %.0f s; %.0f s at rest, bound %.0f "
      "s\n",
      r.practice.semi_major, r.practice_cost, r.plan.expected.semi_major, r.plan.cost,
      *r.plan.least_cost, r.plan.at_rest, *r.plan.least_at_rest);
}

TEST(StopPlan, SavesTimeAgainstStopsEvery300MetresOnASlant) {
  ExpectSaving(test::Slant(), false, 0.2);
}
TEST(StopPlan, SavesTimeAgainstStopsEvery300MetresSlidingOnAnS) {
  ExpectSaving(test::SShape(), false, 0.45);
}
TEST(StopPlan, SavesTimeAgainstStopsEvery300MetresToHorizontal) {
  ExpectSaving(test::Horizontal(), false, 0.2);
}
// Where it slides every stop shows the gyros much the same face, unless the tool is turned.
TEST(StopPlan, ChosenToolfacesSaveMostOfTheTimeOfASlidingTool) {
  ExpectSaving(test::SShape(), true, 0.12);
}

// One after the other on a tool that rolls, each shows the gyros another face: what by itself buys
// little is found from the times of the bound.
TEST(StopPlan, StopsNearEachOtherAreFound) {
  const PlanCase c =
      test::CaseOf({{300, 5, 38}, {900, 40, 41}, {1500, 60, 40}, {3000, 60, 40}}, 80, 1);
  const StopPlan plan = PlanStops(c, {.ellipse = 18});
  ASSERT_TRUE(plan.feasible && plan.least_cost);
  EXPECT_LE(plan.cost, 1.05 * *plan.least_cost);
  EXPECT_GE(plan.cost, 0.99 * *plan.least_cost);
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

/// The least cost of one stop or two by trying every time at every place.
double LeastByTrying(const StopInformation& info, const PlanLimits& limits) {
  const int turns = limits.turns ? kToolfaces : 1, size = static_cast<int>(info.places()) * turns;
  const auto rest = [&](int i, double seconds) {
    return StopStand::Rest{static_cast<std::size_t>(i / turns), kTwoPi * (i % turns) / kToolfaces,
                           seconds};
  };
  double least = HUGE_VAL;
  for (int i = 0; i < size; ++i) {
    for (double first = limits.least_stop; first <= limits.longest_stop; first += kStopGrain) {
      StopStand stand(info, limits.ellipse, HUGE_VAL);
      stand.Add(rest(i, first));
      if (stand.Meets()) least = std::min(least, first + limits.overhead);
      for (int j = (i / turns + 1) * turns; j < size; ++j) {
        const double most =
            std::min(limits.longest_stop, least - kStopGrain - first - 2 * limits.overhead);
        for (double next = limits.least_stop; next <= most; next += kStopGrain) {
          if (!stand.MeetsWith(rest(j, next))) continue;
          least = first + next + 2 * limits.overhead;
          break;
        }
      }
    }
  }
  return least;
}

TEST(StopPairs, TheBestOfTwoIsTheBestThatTryingFinds) {
  for (const bool turns : {false, true}) {
    const PlanCase c = Fast(turns ? test::SShape() : test::Slant());
    const PlanLimits limits{.ellipse = turns ? 5 : 7.6, .longest_stop = 400, .turns = turns};
    const StopInformation info(c, PlacesEvery(c.way, turns ? 650 : 90), {.with_faults = false});
    const double least = LeastByTrying(info, limits);
    ASSERT_LT(least, 1e4);
    const auto best = BestOfTwo(info, limits, HUGE_VAL);
    ASSERT_TRUE(best);
    StopStand stand(info, limits.ellipse, HUGE_VAL);
    for (const StopStand::Rest& rest : *best) stand.Add(rest);
    EXPECT_TRUE(stand.Meets());
    const double cost = stand.at_rest() + limits.overhead * static_cast<double>(best->size());
    EXPECT_EQ(cost, least);
    EXPECT_FALSE(BestOfTwo(info, limits, least));
    std::printf("%zu stops, %.0f s\n", best->size(), cost);
  }
}

/// Covariance of end and faults after stops, all their rows at once: A - C (S + V)^-1 C'.
Eigen::MatrixXd CovarianceAfter(const StopInformation& info,
                                const std::vector<StopStand::Rest>& stops) {
  const Eigen::Index size = info.covariance().rows(), rows = 2 * std::ssize(stops);
  Eigen::MatrixXd mix = Eigen::MatrixXd::Zero(rows, size);
  Eigen::VectorXd noise(rows);
  for (std::size_t i = 0; i < stops.size(); ++i) {
    const auto at = 2 * static_cast<Eigen::Index>(i);
    mix.block(at, info.place_row(stops[i].place), 2, StopInformation::kBasis) =
        StopInformation::Mix(stops[i].turn);
    noise.segment<2>(at).setConstant(10 / stops[i].seconds);  // of unit variance in ten seconds
  }
  const Eigen::MatrixXd S = mix * info.covariance() * mix.transpose(),
                        C = info.covariance() * mix.transpose();
  const Eigen::MatrixXd V = noise.asDiagonal();
  return info.covariance() - C * (S + V).llt().solve(C.transpose());
}

// Rank-two updates of a triangle, a stop at a time, and what stays unseen of the worst fault.
TEST(StopStand, ComesToTheCovarianceOfAllStopsAtOnce) {
  const PlanCase c = Fast(test::SShape());
  const StopInformation info(c, PlacesEvery(c.way, 300));
  const std::vector<StopStand::Rest> stops{{9, 0, 120}, {3, 2.1, 90}, {9, 0, 60}, {5, 0.4, 300}};
  StopStand stand(info, 5, 20);
  for (std::size_t i = 0; i < stops.size(); ++i) {
    const PlanValue looked_at = stand.ValueWith(stops[i]), before = stand.Value();
    // Looked at with a bound it is the same, or told to be above it.
    EXPECT_EQ(stand.ValueWith(stops[i], 1.01 * looked_at.soft).soft, looked_at.soft);
    EXPECT_EQ(stand.ValueWith(stops[i], 0.99 * looked_at.soft).soft, HUGE_VAL);
    stand.Add(stops[i]);
    const PlanValue value = stand.Value();
    EXPECT_LT(value.soft, before.soft);
    EXPECT_NEAR(looked_at.ellipse, value.ellipse, 1e-9 * value.ellipse);
    EXPECT_NEAR(looked_at.hidden, value.hidden, 1e-9 * value.hidden);
    EXPECT_NEAR(looked_at.soft, value.soft, 1e-9 * value.soft);

    const Eigen::MatrixXd after =
        CovarianceAfter(info, {stops.begin(), stops.begin() + static_cast<std::ptrdiff_t>(i) + 1});
    const Eigen::Matrix2d end = after.topLeftCorner<2, 2>();
    const double axis = std::sqrt(
        2 * std::log(20) * Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(end).eigenvalues()[1]);
    EXPECT_NEAR(value.ellipse, axis, 1e-9 * axis);
    double hidden = 0;
    for (std::size_t f = 0; f < info.faults().size(); ++f) {
      const HiddenFault& fault = info.faults()[f];
      const Eigen::Index row = info.fault_row(f);
      // Noticed at a Bayes factor of this limit, in four runs of five.
      const double m = (1 - after(row, row)) / (fault.unit * fault.unit);
      const double vm = fault.size * fault.size * m;
      const double w =
          std::sqrt((1 + vm) / vm * (2 * (info.ln_limit() + fault.ln_onsets) + std::log(1 + vm)));
      const double smallest = std::min((w + 0.8416212335729143) / std::sqrt(m), 5 * fault.size);
      hidden = std::max(hidden, smallest / fault.unit * after.col(row).head<2>().norm());
    }
    EXPECT_NEAR(value.hidden, hidden, 1e-6 * hidden);
  }
}

double CostOf(const std::vector<StopStand::Rest>& stops, const PlanLimits& limits) {
  double cost = 0;
  for (const StopStand::Rest& stop : stops) cost += stop.seconds + limits.overhead;
  return cost;
}

// Limits that are missed by little are had for little more, as by a search from nothing.
TEST(StopSearch, MendsStopsThatAreNearlyEnough) {
  for (PlanCase c : {test::Slant(), test::SShape()}) {
    c = Fast(c);
    const StopInformation info(c, PlacesEvery(c.way, 60));
    PlanLimits limits{.ellipse = 7};
    const auto before = FindStops(info, limits);
    ASSERT_TRUE(before);
    StopStand stand(info, limits.ellipse, HUGE_VAL);
    for (const StopStand::Rest& rest : *before) stand.Add(rest);
    limits.ellipse = 0.97 * stand.Value().ellipse;
    const auto mended = MendStops(info, limits, *before), anew = FindStops(info, limits);
    ASSERT_TRUE(mended && anew);
    StopStand after(info, limits.ellipse, HUGE_VAL);
    for (const StopStand::Rest& rest : *mended) after.Add(rest);
    EXPECT_TRUE(after.Meets());
    EXPECT_GT(CostOf(*mended, limits), CostOf(*before, limits));
    EXPECT_LE(CostOf(*mended, limits), 1.1 * CostOf(*anew, limits));
    std::printf("%.0f s, mended %.0f s, anew %.0f s\n", CostOf(*before, limits),
                CostOf(*mended, limits), CostOf(*anew, limits));
    // What no stops can do they cannot be mended to.
    limits.ellipse = 0.01;
    EXPECT_FALSE(MendStops(info, limits, *before));
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
  EXPECT_NE(ellipse.why_not.find("no plan has an ellipse of 0.3 m"), std::string::npos);
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

#include "wellgyro/plan/live_advice.h"

#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "wellgyro/estimate/linear_run.h"
#include "wellgyro/plan/expected_end.h"
#include "wellgyro/plan/stop_plan.h"
#include "wellgyro/plan/synthetic_run.h"

#include "plan/cases.h"
#include "plan/followed_run.h"

namespace wellgyro {
namespace {

/// What a run that has gone as planned knows where it stands.
RunState StateAfter(const PlanCase& c, const std::vector<PlannedStop>& stops) {
  SyntheticRun rows(c, stops, SetupOfPlan(c));
  LinearRun run(rows);
  RunState state;
  EXPECT_TRUE(run.Solve());
  const Elimination& e = run.elimination();
  const auto nodes = rows.nodes();
  state.setup = SetupOfPlan(c);
  state.setup.site = c.site;
  state.border = BorderVector::Zero(rows.layout().border);
  state.information = e.edge_information().selfadjointView<Eigen::Lower>();
  state.seconds = rows.seconds();
  state.way = WayFrom(rows.layout(), nodes.front());
  for (std::size_t k = 0; k + 1 < nodes.size(); ++k) {
    CarryWay(rows.layout(), nodes[k], nodes[k + 1], e.Gain(k), e.Remainder(k), state.way);
  }
  for (std::size_t i = 0; i < RunState::kTail; ++i) {
    state.nodes[i] = nodes[nodes.size() - RunState::kTail + i];
  }
  return state;
}

/// As far as this depth, and not up again.
PlanCase DownTo(PlanCase c, double md) {
  c.way.end_md = md;
  c.way.speed_out = 0;
  return c;
}

// Smoothing: what stops and motion still to come tell of the way behind counts as in one run.
TEST(LiveAdvice, WhatIsKnownHalfWayAndWhatIsLeftMakeTheWholeRun) {
  for (PlanCase c : {test::Slant(), test::Horizontal()}) {
    c.way.speed_in = c.way.speed_out = 2;
    const std::vector<PlannedStop> early{{false, 300, 200, {}}};
    const RunState state = StateAfter(DownTo(c, 1500), early);
    const RunSoFar so_far{&state, false};
    const std::vector<StopPlace> places{{false, 1500}, {false, 2400}};
    const StopInformation left(c, places, {.so_far = &so_far, .knots = kAdviceKnots});
    ASSERT_TRUE(left.solved());
    StopStand stand(left, 5, HUGE_VAL);
    EXPECT_NEAR(stand.Value().ellipse / ExpectEnd(c, early, false).semi_major, 1, 0.02);
    stand.Add({1, 0, 300});
    std::vector<PlannedStop> both = early;
    both.push_back({false, 2400, 300, {}});
    EXPECT_NEAR(stand.Value().ellipse / ExpectEnd(c, both, false).semi_major, 1, 0.03);
  }
}

// Before the first north an advice is a plan with longer knots; what it says is what the plan says.
TEST(LiveAdvice, LongerKnotsSayOfStopsWhatThePlanDoes) {
  for (const PlanCase& c : {test::Slant(), test::SShape(), test::Horizontal()}) {
    const auto places = PlacesEvery(c.way, 150);
    const StopInformation info(c, places, {.with_faults = false, .knots = kAdviceKnots});
    ASSERT_TRUE(info.solved());
    StopStand stand(info, 5, HUGE_VAL);
    std::vector<PlannedStop> stops;
    for (const std::size_t i : {std::size_t{0}, std::size_t{5}, places.size() / 2 + 4}) {
      stops.push_back({info.place(i).out, info.place(i).md, 200, {}});
      stand.Add({i, 0, 200});
      EXPECT_NEAR(stand.Value().ellipse / ExpectEnd(c, stops, false).semi_major, 1, 0.02);
    }
  }
}

/// What the end of a run at `md` on its way down will be without another stop, as it is foreseen.
double ForeseenAt(const PlanCase& c, const RunState& state, double md) {
  const RunSoFar so_far{&state, false};
  const StopInformation left(c, std::vector<StopPlace>{{false, md}},
                             {.so_far = &so_far, .with_faults = false, .knots = kAdviceKnots});
  return StopStand(left, 5, HUGE_VAL).Value().ellipse;
}

// 2026-11-25: a sliding tool was taken to swing about the toolface it happened to have, from there
// on: what was foreseen went up and down with the swing by a fifth, and at each look another stop
// seemed needed.
TEST(LiveAdvice, WhatIsForeseenOfASlidingToolDoesNotGoByWhereItHasSwungTo) {
  PlanCase c = test::SShape();
  c.way.speed_in = c.way.speed_out = 2;
  c.way.swing_period = 360;
  const std::vector<PlannedStop> early{{false, 300, 120, {}}};
  const double whole = ExpectEnd(c, early, false).semi_major;
  for (const double md : {500., 700., 860., 1040., 1220., 1500., 1900.}) {
    EXPECT_NEAR(ForeseenAt(c, StateAfter(DownTo(c, md), early), md) / whole, 1, 0.02) << md;
  }
}

// 2026-11-25: the way ahead was that of the plan from the next knot on.
TEST(LiveAdvice, AHoleThatDepartsFromItsPlanIsForeseenToGoOnDoingSo) {
  for (PlanCase c : {test::Slant(), test::SShape()}) {
    c.way.speed_in = c.way.speed_out = 2;
    const PlanCase truth = test::Drilled(c, 3, 0);
    const std::vector<PlannedStop> early{{false, 300, 120, {}}};
    const double whole = ExpectEnd(truth, early, false).semi_major;
    ASSERT_LT(ExpectEnd(c, early, false).semi_major, 0.95 * whole);
    for (const double md : {500., 900., 1300.}) {
      EXPECT_NEAR(ForeseenAt(c, StateAfter(DownTo(truth, md), early), md) / whole, 1, 0.02) << md;
    }
  }
}

// 2026-11-25: where ten seconds more would have done, a stop of a minute was advised further down:
// it bought more in a second, and more than was needed.
TEST(LiveAdvice, LittleThatLacksIsHadByRestingALittle) {
  const PlanCase c = test::Horizontal();
  const double md = 435;
  const RunState state = StateAfter(
      DownTo(c, md), {{false, 300, 117, {}}, {false, 367.5, 77, {}}, {false, md, 160, {}}});
  AskingRun run{.md = md, .deepest = md, .rested = 161, .rest_known = 160, .state = &state};
  for (const double lacks : {1e-9, 1e-6, 1e-4, 1e-3}) {
    const double now = Advise(c, {.ellipse = 100}, run).ellipse_now;
    const Advice advice = Advise(c, {.ellipse = now * (1 - lacks)}, run);
    EXPECT_EQ(advice.action, Advice::Action::kStay) << lacks << " " << advice.text;
    EXPECT_LE(advice.rest_left, 15) << lacks;
  }
}

TEST(LiveAdvice, FollowedItMeetsTheLimitInThePlansTime) {
  PlanCase c = test::Slant();
  c.way.speed_in = c.way.speed_out = 3;
  const PlanLimits limits{.ellipse = 7.5};
  const StopPlan plan = PlanStops(c, limits);
  ASSERT_TRUE(plan.feasible);
  const test::Followed followed = test::FollowedRun(c, c, limits, 8).Follow();
  EXPECT_LE(followed.ellipse, 1.01 * limits.ellipse);
  EXPECT_GT(followed.ellipse, 0.9 * limits.ellipse);
  EXPECT_NEAR(followed.cost / plan.cost, 1, 0.25);
}

TEST(LiveAdvice, BeforeTheFirstNorthItIsThePlanFromHere) {
  const PlanCase c = test::Slant();
  const PlanLimits limits{.ellipse = 7.5};
  AskingRun run{.md = 300};
  Advice advice = Advise(c, limits, run);
  EXPECT_EQ(advice.action, Advice::Action::kStop);
  EXPECT_TRUE(advice.reachable);
  EXPECT_LE(advice.ellipse, limits.ellipse);
  EXPECT_GT(advice.ellipse_now, advice.ellipse);
  const double seconds = advice.seconds;
  // What it has rested counts, second by second.
  run.rested = run.rest_known = 40;
  advice = Advise(c, limits, run);
  EXPECT_EQ(advice.action, Advice::Action::kStay);
  EXPECT_NEAR(advice.seconds, seconds - 40, 15);
  run.rested = run.rest_known = 3600;
  EXPECT_EQ(Advise(c, limits, run).action, Advice::Action::kMoveOn);
}

TEST(LiveAdvice, SaysWhyItHasNone) {
  const PlanCase c = test::Slant();
  const PlanLimits limits{.ellipse = 7.5};
  EXPECT_EQ(Advise(c, limits, {}).action, Advice::Action::kNone);
  EXPECT_EQ(Advise(c, limits, {.md = 1000, .deepest = 2000}).text,
            "no north was found on the way down");
  const RunState end = StateAfter(DownTo(c, 3000), {{false, 300, 200, {}}});
  EXPECT_EQ(Advise(DownTo(c, 3000), limits, {.md = 3000, .deepest = 3000, .state = &end}).text,
            "no way is left");
  const Advice none = Advise(c, {.ellipse = 0.1}, {.md = 3000, .deepest = 3000, .state = &end});
  EXPECT_EQ(none.action, Advice::Action::kMoveOn);
  EXPECT_FALSE(none.reachable);
  EXPECT_NE(none.text.find("no longer be met"), std::string::npos);
}

// A depth that jumps, or a plan that ends short of the hole, takes nothing down.
// 2026-11-24: a plan's last stop was where its way ends, and there nothing was said.
TEST(LiveAdvice, ARestWhereTheWayEndsIsToldItsLength) {
  const PlanCase c = DownTo(test::Slant(), 3000);
  const std::vector<PlannedStop> first{{false, 300, 120, {}}};
  const RunState end = StateAfter(c, first);
  const double without = ExpectEnd(c, first, false).semi_major;
  for (const double md : {2995.0, 3000.0, 3001.0}) {
    AskingRun run{.md = md, .deepest = md, .rested = 20, .state = &end};
    const Advice stay = Advise(c, {.ellipse = 0.95 * without}, run);
    EXPECT_EQ(stay.action, Advice::Action::kStay) << stay.text;
    EXPECT_GT(stay.seconds, 10);
    EXPECT_EQ(Advise(c, {.ellipse = 1.1 * without}, run).action, Advice::Action::kMoveOn);
    run.rested = 0;
    EXPECT_EQ(Advise(c, {.ellipse = 0.95 * without}, run).action, Advice::Action::kNone);
  }
}

TEST(LiveAdvice, ADepthOffThePlansWayIsTakenToItsEnds) {
  const PlanCase c = test::Slant();
  const RunState state = StateAfter(DownTo(c, 1500), {{false, 300, 200, {}}});
  for (const double md : {-1e5, 0., 299., 3001., 1e9}) {
    for (const double deepest : {md, 1500., 1e9}) {
      EXPECT_NO_THROW(Advise(c, {.ellipse = 7}, {.md = md, .deepest = deepest, .state = &state}))
          << md << " " << deepest;
    }
  }
  EXPECT_NO_THROW(Advise(c, {.ellipse = 7}, {.md = -1e5}));
}

}  // namespace
}  // namespace wellgyro

#include "wellgyro/simulate/run_plan.h"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "cases.h"

namespace wellgyro {
namespace {

const TruthWell& Well() {
  static const TruthWell well(WeavingWell(), {.latitude = 1});
  return well;
}

TEST(RunPlan, RatesAreTheSlopesOfWhatTheyMove) {
  const RunPlan plan(WeavingRun().run, Well());
  constexpr double kStep = 1e-3;
  for (double t = 0.3; t < plan.seconds(); t += 0.77) {
    const RunMotion a = plan.At(t - kStep), b = plan.At(t), c = plan.At(t + kStep);
    EXPECT_NEAR(b.speed, (c.md - a.md) / (2 * kStep), 1e-7) << t;
    EXPECT_NEAR(b.acceleration, (c.speed - a.speed) / (2 * kStep), 1e-6) << t;
    EXPECT_NEAR(b.roll_rate, (c.roll - a.roll) / (2 * kStep), 1e-6) << t;
    // No rate jumps anywhere, neither in speed nor in roll.
    EXPECT_NEAR(a.roll_rate, c.roll_rate, 0.5 * kStep) << t;
    EXPECT_NEAR(a.acceleration, c.acceleration, 0.2 * kStep) << t;
  }
}

TEST(RunPlan, ArrivesAndTurnsAsTold) {
  const SimulatedRun run = WeavingRun().run;
  const RunPlan plan(run, Well());
  EXPECT_EQ(plan.At(-5).md, 150);
  const double azimuth = Well().PointAt(150).azimuth;
  EXPECT_NEAR(plan.At(30).roll, FromDegrees(25) + azimuth, 1e-14);
  EXPECT_NEAR(plan.At(100).roll, FromDegrees(25) + azimuth + kPi, 1e-14);
  // Two stands of 60 s and a turn of 10 s, then 1150 m at 0.9 m/s and a ramp.
  const double arrival = 130 + 1150 / 0.9 + 8;
  EXPECT_NEAR(plan.At(arrival).md, 1300, 1e-9);
  EXPECT_GT(plan.At(arrival - 1).speed, 1e-4);
  EXPECT_NEAR(plan.At(130 + 600).speed, 0.9, 1e-15);
  EXPECT_NEAR(WrapPi(plan.At(arrival + 25).roll - Well().PointAt(1300).azimuth), kPi / 2, 1e-12);
  EXPECT_EQ(plan.At(plan.seconds() + 9).md, 600);
  EXPECT_TRUE(plan.At(plan.seconds() + 9).still);
  EXPECT_TRUE(plan.At(30).still);
  EXPECT_FALSE(plan.At(65).still);
  EXPECT_FALSE(plan.At(500).still);
}

TEST(RunPlan, AnnouncesItsModes) {
  const RunPlan plan(WeavingRun().run, Well());
  const auto& modes = plan.modes();
  ASSERT_EQ(modes.size(), 10u);
  EXPECT_EQ(modes[0].mode, ToolMode::Mode::kGyrocompass);
  EXPECT_EQ(modes[0].index_position, 0);
  EXPECT_EQ(modes[1].mode, ToolMode::Mode::kMoving);
  EXPECT_EQ(modes[1].time, 60);
  EXPECT_EQ(modes[2].index_position, 1);
  EXPECT_EQ(modes[2].index_angle, kPi);
  EXPECT_EQ(modes[3].mode, ToolMode::Mode::kContinuous);
  EXPECT_EQ(modes[3].time, 130);
  EXPECT_FALSE(modes[9].index_position.has_value());
}

TEST(RunPlan, AShortMoveKeepsItsRamps) {
  SimulatedRun run;
  run.start_md = 500;
  run.steps = {RunMove{.to_md = 497, .speed = 2, .ramp = 10}};
  const RunPlan plan(run, Well());
  EXPECT_DOUBLE_EQ(plan.seconds(), 20);
  EXPECT_NEAR(plan.At(20).md, 497, 1e-12);
  EXPECT_NEAR(plan.At(10).speed, -0.3, 1e-12);
}

TEST(RunPlan, BreaksAreWhereLegsAndRampsMeet) {
  SimulatedRun run;
  run.start_md = 500;
  run.steps = {RunStop{.seconds = 5}, RunMove{.to_md = 540, .speed = 2, .ramp = 10}};
  const RunPlan plan(run, Well());
  std::vector<double> breaks;
  for (double t = plan.NextBreak(-1); std::isfinite(t); t = plan.NextBreak(t)) breaks.push_back(t);
  EXPECT_EQ(breaks, (std::vector<double>{0, 5, 15, 25, 35}));
}

template <class Change>
void ExpectRefused(const std::string& names, Change change) {
  SimulatedRun run = WeavingRun().run;
  change(run);
  try {
    RunPlan plan(run, Well());
    ADD_FAILURE() << "accepted: " << names;
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find(names), std::string::npos) << e.what();
  }
}

TEST(RunPlan, NamesWhatMakesNoSense) {
  ExpectRefused("[run] start_md_m: 99", [](auto& r) { r.start_md = 99; });
  ExpectRefused("[[run.step]] 2: to_md_m 2601",
                [](auto& r) { std::get<RunMove>(r.steps[1]).to_md = 2601; });
  ExpectRefused("[[run.step]] 2: speed_mps",
                [](auto& r) { std::get<RunMove>(r.steps[1]).speed = -1; });
  ExpectRefused("[run] takes inf", [](auto& r) { std::get<RunMove>(r.steps[3]).ramp = HUGE_VAL; });
  ExpectRefused("[[run.step]] 4: ramp_s", [](auto& r) { std::get<RunMove>(r.steps[3]).ramp = 0; });
  ExpectRefused("[[run.step]] 4: roll_period_s",
                [](auto& r) { std::get<RunMove>(r.steps[3]).roll.period = 0; });
  ExpectRefused("[[run.step]] 1: stop_s",
                [](auto& r) { std::get<RunStop>(r.steps[0]).seconds = -1; });
  // Each once kept the simulator busy for good, 2026-11-21.
  ExpectRefused("a speed is too low",
                [](auto& r) { std::get<RunMove>(r.steps[1]).speed = 1e-300; });
  ExpectRefused("a stop too long", [](auto& r) { std::get<RunStop>(r.steps[0]).seconds = 1e300; });
  ExpectRefused("a roll rate is too high",
                [](auto& r) { std::get<RunMove>(r.steps[1]).roll.rate = 1e300; });
  ExpectRefused("a ramp", [](auto& r) {
    std::get<RunMove>(r.steps[1]).ramp = 1e-300;
    std::get<RunMove>(r.steps[1]).speed = 1e300;
  });
  ExpectRefused("[[run.step]] 1: turn_s",
                [](auto& r) { std::get<RunStop>(r.steps[0]).turn_seconds = 0; });
}

}  // namespace
}  // namespace wellgyro

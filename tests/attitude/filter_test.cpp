#include "wellgyro/attitude/filter.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>

#include <gtest/gtest.h>

#include "wellgyro/attitude/smoother.h"
#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/math/random.h"

#include "attitude/filter_truth.h"

namespace wellgyro {
namespace {

using filter_truth::ExternalFix;
using filter_truth::FixOf;
using filter_truth::MakeKnots;
using filter_truth::Plan;
using filter_truth::Pose;
using filter_truth::SetupAt;
using filter_truth::Truth;
using units::kDegPerHour;
using units::kDegPerSqrtHour;

// A hole that builds and turns, one metre a second, the tool rolling.
Pose TurningHole(double t, double inclination, double rpm) {
  return {.inclination = FromDegrees(inclination + 1.8 * std::sin(t / 250)),
          .azimuth = FromDegrees(200 + 50 * std::sin(t / 700)),
          .toolface = 0.4 + rpm * kTwoPi / 60 * t,
          .md = 500 + t};
}

TEST(AzimuthFilter, FollowsATurningHoleWithoutSensorErrors) {
  for (const double latitude : {-35.0, 0.0, 72.0}) {
    for (const double inclination : {5.0, 60.0, 110.0}) {
      for (const double length : {1.0, 10.0}) {
        FilterSetup setup = SetupAt(FromDegrees(latitude));
        Plan plan;
        plan.motion = [&](double t) { return TurningHole(t, inclination, 3); };
        plan.seconds = 3600;
        plan.knot_seconds = length;
        plan.steps_per_knot = static_cast<int>(4 * length);
        const Truth truth = MakeKnots(plan, setup, 0);
        setup.start_azimuth = truth.start.azimuth;
        AzimuthFilter filter(setup);
        double worst = 0;
        for (std::size_t i = 0; i < truth.knots.size(); ++i) {
          const AttitudeSample& a = filter.Step(truth.knots[i]);
          worst = std::max(worst, std::abs(WrapPi(a.azimuth - truth.poses[i].azimuth)));
        }
        // Mid-point over a knot: the error falls as its square.
        EXPECT_LT(ToDegrees(worst), length < 2 ? 3e-5 : 3e-3)
            << latitude << " " << inclination << " " << length;
      }
    }
  }
}

// A tool with drift and a stop from 300 s to 600 s.
struct ToolRun {
  FilterSetup setup;
  Truth truth;
};

ToolRun StopRun(std::uint64_t seed, double inclination = 40) {
  ToolRun run;
  run.setup = SetupAt(FromDegrees(55));
  run.setup.gyro.angle_random_walk = 0.01 * kDegPerSqrtHour;
  run.setup.errors.gyro_bias_sigma = 0.05 * kDegPerHour;
  Plan plan;
  plan.motion = [=](double t) {
    const double way = t < 300 ? t : std::max(300.0, t - 300);
    return TurningHole(way, inclination, 1);
  };
  plan.still = [](double t) { return t > 300 && t < 600; };
  plan.seconds = 1200;
  plan.steps_per_knot = 8;
  run.truth = MakeKnots(plan, run.setup, seed);
  return run;
}

NorthFix StopFix(const ToolRun& run) {
  return FixOf(run.truth.knots, 30, 60, run.setup, run.truth.poses[40].azimuth);
}

double ErrorAt(const ToolRun& run, const AttitudeSample& a, std::size_t i) {
  return WrapPi(a.azimuth - run.truth.poses[i].azimuth);
}

TEST(AzimuthFilter, KnowsNoAzimuthBeforeAFixAndSaysSo) {
  const ToolRun run = StopRun(1);
  AzimuthFilter filter(run.setup);
  for (std::size_t i = 0; i < 60; ++i) {
    const AttitudeSample& a = filter.Step(run.truth.knots[i]);
    EXPECT_FALSE(a.azimuth_known);
    EXPECT_NEAR(a.cov_attitude(1, 1), kPi * kPi / 3, 1e-12);
  }
  const FilterFix fix = filter.Update(StopFix(run));
  EXPECT_EQ(fix.use, FixUse::kUsed);
  EXPECT_TRUE(fix.rates);
  EXPECT_EQ(fix.epoch_begin, 30u);
  EXPECT_EQ(fix.epoch_end, 60u);
  EXPECT_TRUE(filter.attitude().azimuth_known);
  const double sigma = std::sqrt(filter.attitude().cov_attitude(1, 1));
  EXPECT_LT(std::abs(ErrorAt(run, filter.attitude(), 59)), 4 * sigma);
  EXPECT_LT(sigma, FromDegrees(2));
}

TEST(AzimuthFilter, TheSameFixLateGivesTheSameState) {
  const ToolRun run = StopRun(2);
  AzimuthFilter prompt(run.setup), late(run.setup);
  for (std::size_t i = 0; i < run.truth.knots.size(); ++i) {
    prompt.Step(run.truth.knots[i]);
    late.Step(run.truth.knots[i]);
    if (i % 7 == 6) {
      prompt.MarkStation();
      late.MarkStation();
    }
    if (i == 59) prompt.Update(StopFix(run));
    if (i == 111) late.Update(StopFix(run));
  }
  EXPECT_EQ(prompt.attitude().azimuth, late.attitude().azimuth);
  EXPECT_EQ(prompt.attitude().cov_attitude, late.attitude().cov_attitude);
  ASSERT_EQ(prompt.stations().size(), late.stations().size());
  for (std::size_t k = 0; k < late.stations().size(); ++k) {
    EXPECT_EQ(prompt.stations()[k].epoch, late.stations()[k].epoch);
    EXPECT_EQ(prompt.stations()[k].cov, late.stations()[k].cov);
    EXPECT_EQ(prompt.stations()[k].cov_with_previous, late.stations()[k].cov_with_previous);
  }
}

TEST(AzimuthFilter, AnExternalAzimuthMayHoldInsideAKnot) {
  ToolRun run = StopRun(0);
  const double when = 146;  // knots end at 140 and 150
  const double azimuth = TurningHole(when, 40, 1).azimuth;
  NorthFix fix = ExternalFix(run.truth.knots[14], azimuth, FromDegrees(0.1));
  fix.begin = fix.end = ToolTime{} + Duration::Seconds(when);
  AzimuthFilter filter(run.setup);
  EXPECT_EQ(filter.Update(fix).use, FixUse::kUsed);  // before the first knot: at the start
  AzimuthFilter after(run.setup);
  for (std::size_t i = 0; i <= 20; ++i) after.Step(run.truth.knots[i]);
  const FilterFix used = after.Update(fix);
  EXPECT_EQ(used.use, FixUse::kUsed);
  EXPECT_FALSE(used.rates);
  EXPECT_EQ(used.epoch_end, 15u);
  // Linear inside the knot: what is left is curvature, below A'' t^2 / 8 = 1.3e-3 deg.
  EXPECT_LT(ToDegrees(std::abs(ErrorAt(run, after.attitude(), 20))), 1.3e-3);
  EXPECT_NEAR(std::sqrt(after.attitude().cov_attitude(1, 1)), FromDegrees(0.1), FromDegrees(0.02));
  fix.begin = fix.end = ToolTime{} + Duration::Seconds(211);
  EXPECT_EQ(after.Update(fix).use, FixUse::kNoKnot);
}

TEST(AzimuthFilter, ContinuityTellsAFixFromItsMirror) {
  const ToolRun run = StopRun(3, 85);
  const double truth = run.truth.poses[40].azimuth;
  NorthFix fix = StopFix(run);
  const double right = fix.azimuth;
  fix.azimuth = WrapTwoPi(kPi - right);  // the data prefer the wrong one
  fix.mirror_azimuth = right;
  fix.mirror_cost = 2;
  {
    AzimuthFilter filter(run.setup);
    for (std::size_t i = 0; i < 60; ++i) filter.Step(run.truth.knots[i]);
    EXPECT_EQ(filter.Update(fix).use, FixUse::kAmbiguous);
    EXPECT_FALSE(filter.attitude().azimuth_known);
  }
  FilterSetup setup = run.setup;
  setup.start_azimuth = run.truth.start.azimuth;
  setup.start_sigma = FromDegrees(3);
  AzimuthFilter filter(setup);
  for (std::size_t i = 0; i < 60; ++i) filter.Step(run.truth.knots[i]);
  const FilterFix used = filter.Update(fix);
  EXPECT_EQ(used.use, FixUse::kMirror);
  EXPECT_LT(std::abs(WrapPi(used.azimuth - right)), 1e-12);
  EXPECT_LT(std::abs(WrapPi(filter.attitude().azimuth - truth)), FromDegrees(3));
}

TEST(AzimuthFilter, AVerticalStretchLosesAzimuthAndAFixBringsItBack) {
  ToolRun run = StopRun(4);
  run.setup.start_azimuth = run.truth.start.azimuth;
  run.setup.start_sigma = FromDegrees(0.5);
  for (std::size_t i = 10; i < 14; ++i) {
    run.truth.knots[i].vertical = true;
    run.truth.knots[i].turn += 1;  // means nothing there
  }
  AzimuthFilter filter(run.setup);
  for (std::size_t i = 0; i < 60; ++i) {
    const AttitudeSample& a = filter.Step(run.truth.knots[i]);
    EXPECT_EQ(a.azimuth_known, i < 10);
    EXPECT_LE(a.cov_attitude(1, 1), kPi * kPi / 3 + 1e-12);
    EXPECT_EQ(Has(a.quality, Quality::kVertical), i >= 10 && i < 14);
  }
  EXPECT_EQ(filter.Update(StopFix(run)).use, FixUse::kUsed);
  EXPECT_TRUE(filter.attitude().azimuth_known);
  EXPECT_LT(std::abs(ErrorAt(run, filter.attitude(), 59)),
            4 * std::sqrt(filter.attitude().cov_attitude(1, 1)));

  // Looking back, the azimuth before the stretch is that from the start, after it that of the fix.
  const SmoothedRun smooth = Smooth(filter.history());
  EXPECT_NEAR(std::sqrt(smooth.attitude[5].cov_attitude(1, 1)), FromDegrees(0.5),
              FromDegrees(0.05));
  EXPECT_LT(std::abs(ErrorAt(run, smooth.attitude[5], 5)), FromDegrees(2));
  EXPECT_LT(smooth.attitude[20].cov_attitude(1, 1), 1.1 * filter.attitude().cov_attitude(1, 1));
  EXPECT_LT(std::abs(ErrorAt(run, smooth.attitude[20], 20)),
            4 * std::sqrt(smooth.attitude[20].cov_attitude(1, 1)));
}

TEST(AzimuthFilter, AGapWidensByTheBendTheHoleMayTake) {
  ToolRun run = StopRun(0);
  run.setup.start_azimuth = run.truth.start.azimuth;
  run.truth.knots[5].gap_seconds = 10;
  run.truth.knots[5].unseen = FromDegrees(1);
  run.truth.knots[5].var_unseen = FromDegrees(1) * FromDegrees(1);
  AzimuthFilter filter(run.setup);
  for (std::size_t i = 0; i < 5; ++i) filter.Step(run.truth.knots[i]);
  const double before = filter.attitude().cov_attitude(1, 1);
  const double after = filter.Step(run.truth.knots[5]).cov_attitude(1, 1);
  const double i = (run.truth.poses[4].inclination + run.truth.poses[5].inclination) / 2;
  const double bend = FromDegrees(1) / std::sin(i);
  EXPECT_NEAR(after - before, bend * bend, 0.01 * bend * bend);
}

TEST(AzimuthFilter, AtRestAzimuthAndItsVarianceStand) {
  ToolRun run = StopRun(5);
  run.setup.start_azimuth = run.truth.start.azimuth;
  run.setup.start_sigma = FromDegrees(0.2);
  AzimuthFilter filter(run.setup);
  for (std::size_t i = 0; i < 30; ++i) filter.Step(run.truth.knots[i]);
  const AttitudeSample before = filter.attitude();
  for (std::size_t i = 30; i < 60; ++i) filter.Step(run.truth.knots[i]);
  EXPECT_NEAR(filter.attitude().azimuth, before.azimuth, 1e-15);
  EXPECT_NEAR(filter.attitude().cov_attitude(1, 1), before.cov_attitude(1, 1), 1e-18);
}

// The toolface of a tool at rest jitters; a misaligned gyro does not feel that.
TEST(AzimuthFilter, AJitterOfTheToolfaceAtRestTeachesNothing) {
  ToolRun run = StopRun(7);
  run.setup.errors.gyro_misalignment_sigma = 1e-3;
  run.setup.errors.time_skew_sigma = 1e-2;
  Random random(7);
  AzimuthFilter quiet(run.setup), jittered(run.setup);
  for (std::size_t i = 0; i < 80; ++i) {
    quiet.Step(run.truth.knots[i]);
    Knot knot = run.truth.knots[i];
    if (knot.still) {
      knot.d_lift[Knot::kMisalignmentX] += 0.01 * random.Normal();
      knot.d_turn[Knot::kMisalignmentY] += 0.01 * random.Normal();
      knot.d_turn[Knot::kTimeSkew] += 0.01 * random.Normal();
    }
    jittered.Step(knot);
    if (i != 60) continue;
    quiet.Update(StopFix(run));
    jittered.Update(StopFix(run));
  }
  EXPECT_EQ(quiet.attitude().azimuth, jittered.attitude().azimuth);
  EXPECT_EQ(quiet.attitude().cov_attitude, jittered.attitude().cov_attitude);
  EXPECT_TRUE(quiet.attitude().azimuth_known);
}

TEST(Smoother, AtTheLastKnotItIsTheFilter) {
  const ToolRun run = StopRun(6);
  AzimuthFilter filter(run.setup);
  for (std::size_t i = 0; i < run.truth.knots.size(); ++i) {
    filter.Step(run.truth.knots[i]);
    if (i == 60) filter.Update(StopFix(run));
  }
  const SmoothedRun smooth = Smooth(filter.history());
  const AttitudeSample& a = filter.attitude();
  const AttitudeSample& b = smooth.attitude.back();
  // Not the same: made linear about another path.
  EXPECT_NEAR(WrapPi(a.azimuth - b.azimuth), 0, 0.01 * std::sqrt(a.cov_attitude(1, 1)));
  EXPECT_NEAR(a.cov_attitude(1, 1), b.cov_attitude(1, 1), 0.01 * a.cov_attitude(1, 1));
}

// Between two exact azimuths white noise makes a Brownian bridge: N^2/sin^2 I x t (T - t)/T.
TEST(Smoother, BetweenTwoTiesTheVarianceIsThatOfABridge) {
  FilterSetup setup = SetupAt(FromDegrees(60));
  setup.gyro.angle_random_walk = 0.1 * kDegPerSqrtHour;
  setup.start_azimuth = 0;
  Plan plan;
  plan.motion = [](double t) {
    return Pose{.inclination = 0.5, .azimuth = 0, .toolface = t / 20, .md = t};
  };
  plan.seconds = 1000;
  const Truth truth = MakeKnots(plan, setup, 7);
  AzimuthFilter filter(setup);
  for (const Knot& knot : truth.knots) filter.Step(knot);
  filter.Update(ExternalFix(truth.knots.back(), 0, 1e-9));
  const SmoothedRun smooth = Smooth(filter.history());
  const double n2 = std::pow(setup.gyro.angle_random_walk / std::sin(0.5), 2);
  for (const std::size_t i : {9u, 49u, 89u}) {
    const double t = 10.0 * static_cast<double>(i + 1);
    const double expected = n2 * t * (1000 - t) / 1000;
    EXPECT_NEAR(smooth.attitude[i].cov_attitude(1, 1), expected,
                1e-4 * expected);  // Earth's feedback
    EXPECT_LT(std::abs(WrapPi(smooth.attitude[i].azimuth)), 4 * std::sqrt(expected));
  }
}

TEST(AzimuthFilter, RefusesWhatMakesNoSense) {
  FilterSetup setup = SetupAt(0.5);
  setup.errors.gyro_bias_sigma = -1;
  EXPECT_THROW(AzimuthFilter{setup}, std::invalid_argument);
  setup = {};
  EXPECT_THROW(AzimuthFilter{setup}, std::invalid_argument);
  AzimuthFilter filter(SetupAt(0.5));
  EXPECT_THROW(filter.MarkStation(), std::logic_error);
  Knot knot;
  knot.time = ToolTime{1000};
  filter.Step(knot);
  EXPECT_THROW(filter.Step(knot), std::invalid_argument);
}

}  // namespace
}  // namespace wellgyro

#include "wellgyro/depth/depth_motion.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/math/random.h"

namespace wellgyro {
namespace {

constexpr double kRamp = 8, kMove = 100, kRest = 30, kCycle = kMove + kRamp + kRest;

/// A string that goes 100 m at a time at 1 m/s, with starts and stops of 8 s and rests of 30 s.
double Depth(double t) {
  const double cycles = std::floor(t / kCycle), u = t - cycles * kCycle;
  // Speed 1 - cos over the ramps: its integral.
  const auto ramp = [](double x) {
    const double s = std::min(std::max(x, 0.0), kRamp);
    return s / 2 - kRamp / (2 * M_PI) * std::sin(M_PI * s / kRamp) + std::max(x - kRamp, 0.0);
  };
  return kMove * cycles + ramp(u) - ramp(u - kMove);
}

struct Depths {
  std::function<double(double)> read = [](double t) { return Depth(t); };
  double noise = 0.01, period = 0.5;
  double ahead = 5;   ///< marks of the samples [s]
  double jitter = 0;  ///< 1-sigma of the samples' UTC [s]
  double late = 0;    ///< by which samples are in the first rest, by a fiftieth less with each [s]
  double build = 0;   ///< [rad/m], from 49 deg on
  double roll = 0;    ///< [rad/s]
  std::uint64_t seed = 1;
};

void PushMark(UtcTime utc, double md, DepthTrack& track) {
  DepthMark mark;
  mark.utc = utc;
  mark.seq = utc.ns / 1'000'000;
  mark.md = md;
  EXPECT_FALSE(track.Push(mark));
}

DepthMotion::Found FoundOf(const Depths& depths, double seconds) {
  Random random(depths.seed), force(depths.seed + 1000), clock(depths.seed + 2000);
  DepthMotion motion;
  DepthTrack track;
  const UtcTime begin{1'700'000'000'000'000'000};
  double next_mark = 0;
  constexpr double kStep = 0.1;
  for (double t = 0; t < seconds; t += kStep) {
    for (; next_mark < t + depths.ahead; next_mark += depths.period) {
      PushMark(begin + Duration::Seconds(next_mark),
               depths.read(next_mark) + depths.noise * random.Normal(), track);
    }
    const double h = 0.02, middle = t + kStep / 2;
    const double felt = (Depth(middle + h) - 2 * Depth(middle) + Depth(middle - h)) / (h * h);
    const double rest = (t - kMove - kRamp) / kStep;
    const double late =
        depths.jitter * clock.Normal() + (rest < 0 ? 0 : depths.late * std::pow(0.98, rest));
    const UtcTime utc = begin + Duration::Seconds(t + late);
    // Gravity's share in a tool that rolls while its inclination grows.
    const double inclination = 0.85 + depths.build * Depth(middle), roll = depths.roll * middle;
    const double across = 9.8 * std::sin(inclination);
    const double turn = depths.build * (Depth(middle + h) - Depth(middle - h)) / (2 * h);
    SixAxes sample;
    sample << turn * std::sin(roll), turn * std::cos(roll), 0, across * std::cos(roll),
        -across * std::sin(roll), felt - 9.8 * std::cos(inclination) + 1e-3 * force.Normal();
    motion.Feel({&utc, 1}, Duration::Seconds(kStep), {&sample, 1}, track);
  }
  return motion.found();
}

TEST(DepthMotion, AGoodTrackHasNoStepAndNoLag) {
  double squares = 0;
  constexpr int kSeeds = 20;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    Depths depths;
    depths.seed = seed;
    const DepthMotion::Found found = FoundOf(depths, 3000);
    EXPECT_GT(found.compared, 1000);
    // Of white marks the coefficients -1/2, 3/2, -3/2, 1/2 leave 2.24 times their sigma.
    EXPECT_NEAR(found.sigma_step, 2.236 * 0.01, 0.003);
    EXPECT_LT(std::abs(found.step), 5 * found.sigma_step);
    EXPECT_LT(found.sigma_lag, 0.05);
    squares += std::pow(found.lag / found.sigma_lag, 2);
  }
  // Chi-square of 20: 7 to 40 hold 99.7 %; neighbouring groups share marks, which widens it.
  EXPECT_GT(squares / kSeeds, 0.2);
  EXPECT_LT(squares / kSeeds, 3);
}

// Gravity, summed up for hours, times the microseconds by which samples and marks are not in step.
TEST(DepthMotion, TheFourthHourIsJudgedAsTheFirstMinuteIs) {
  Depths depths;
  depths.jitter = 2e-6;
  const DepthMotion::Found found = FoundOf(depths, 4 * 3600);
  EXPECT_NEAR(found.sigma_step, 2.236 * 0.01, 0.003);
  EXPECT_LT(std::abs(found.step), 5 * found.sigma_step);
}

// A message comes late, and the clocks' tie gets over it: the fall goes by UTC as marks do.
TEST(DepthMotion, ATieThatSettlesIsNoStepAndNoLag) {
  Depths depths;
  depths.late = 0.1;
  const DepthMotion::Found found = FoundOf(depths, 3000);
  EXPECT_LT(std::abs(found.step), 5 * found.sigma_step);
  EXPECT_LT(std::abs(found.lag), 5 * found.sigma_lag);
  depths.late = -0.1;
  EXPECT_LT(std::abs(FoundOf(depths, 3000).step), 5 * found.sigma_step);
}

// How marks and samples interleave does not matter.
TEST(DepthMotion, MarksMayBeAheadByAnyTime) {
  Depths near, far;
  near.ahead = 1;
  far.ahead = 2000;
  const DepthMotion::Found a = FoundOf(near, 1500), b = FoundOf(far, 1500);
  EXPECT_EQ(a.compared, b.compared);
  EXPECT_EQ(a.step, b.step);
  EXPECT_EQ(a.sigma_step, b.sigma_step);
  EXPECT_EQ(a.lag, b.lag);
}

// Rounded to a step the third differences of a good track reach two of them at most, 1/2 (1 + 3 + 3
// + 1) / 2. Of marks with noise of 1 cm nothing is common.
TEST(DepthMotion, DepthInWholeStepsIsToldByItsMarks) {
  double worst = 0;
  for (const double step : {0.1, 0.5, 1.0}) {
    const auto found = FoundOf(
        {.read = [step](double t) { return step * std::round(Depth(t) / step); }, .noise = 0},
        1000);
    EXPECT_NEAR(found.resolution, step, 1e-9);
    EXPECT_LT(std::abs(found.step), 2 * step);
    worst = std::max(worst, std::abs(found.step));
  }
  EXPECT_GT(worst, 0.2) << "beyond what a check allows else";
  EXPECT_LT(FoundOf({}, 1000).resolution, 0.01);
  EXPECT_EQ(FoundOf({.read = [](double) { return 100; }, .noise = 0}, 1000).resolution, 0);
}

TEST(DepthMotion, AJumpOfTheCounterStandsOut) {
  Depths depths;
  depths.read = [](double t) { return Depth(t) + (t > 700 ? 1.0 : 0.0); };
  const DepthMotion::Found found = FoundOf(depths, 1500);
  EXPECT_NEAR(found.step, 1, 0.1);
  EXPECT_GT(found.step, 20 * found.sigma_step);
  EXPECT_NEAR(found.step_md.value_or(0), Depth(701), 4);
}

// Through horizontal at 10 deg/30 m, marks four seconds apart: gravity's share along the tool
// changes by .057 m/s^2 a second, which alone would bow the way by 1.8 m.
TEST(DepthMotion, AHoleThatBuildsThroughHorizontalIsNoStep) {
  for (const double roll : {0.0, 0.6}) {
    Depths depths;
    depths.build = 5.8e-3;
    depths.roll = roll;
    depths.noise = 0.005;
    depths.period = 4;
    const DepthMotion::Found found = FoundOf(depths, 500);
    EXPECT_GT(found.compared, 100);
    EXPECT_NEAR(found.sigma_step, 2.236 * 0.005, 0.006);
    EXPECT_LT(std::abs(found.step), 0.06);
  }
}

TEST(DepthMotion, TellsLateMarksFromPromptOnes) {
  for (const double lag : {0.5, -0.3}) {
    Depths depths;
    depths.read = [lag](double t) { return Depth(t - lag); };
    const DepthMotion::Found found = FoundOf(depths, 3000);
    EXPECT_NEAR(found.lag, lag, 0.1);
    EXPECT_GT(std::abs(found.lag), 8 * found.sigma_lag);
  }
}

// Of a block the track is asked for a mark once for all samples in front of it: by UTC that steps
// back, and behind gaps, too.
TEST(DepthMotion, BlocksAreTheirSamples) {
  Random random(7);
  DepthMotion alone, blocks;
  DepthTrack track;
  const UtcTime begin{1'700'000'000'000'000'000};
  constexpr int kBlock = 100, kSamples = 400 * kBlock;
  for (int k = 0; k < kSamples / 10; ++k) {
    PushMark(begin + Duration::Seconds(0.1 * k), Depth(0.1 * k) + 0.01 * random.Normal(), track);
  }
  std::vector<UtcTime> utc(kBlock);
  std::vector<SixAxes> samples(kBlock);
  for (int k = 0; k < kSamples; ++k) {
    const double gap = k < kSamples / 4 ? 0 : k < kSamples / 2 ? 0.3 : 3;
    const double late = k % 777 == 0 ? -2e-3 : 1e-8 * random.Normal();
    const auto i = static_cast<std::size_t>(k % kBlock);
    utc[i] = begin + Duration::Seconds(0.01 * k + late + gap);
    samples[i] << 1e-3, 2e-3, 0, 3 + random.Normal(), 4, -8 + 0.1 * random.Normal();
    alone.Feel({&utc[i], 1}, Duration::Seconds(0.01), {&samples[i], 1}, track);
    if (i + 1 == kBlock) blocks.Feel(utc, Duration::Seconds(0.01), samples, track);
  }
  const DepthMotion::Found a = alone.found(), b = blocks.found();
  EXPECT_GT(a.compared, 150);
  EXPECT_EQ(a.compared, b.compared);
  EXPECT_EQ(a.step, b.step);
  EXPECT_EQ(a.step_md, b.step_md);
  EXPECT_EQ(a.sigma_step, b.sigma_step);
  EXPECT_EQ(a.lag, b.lag);
  EXPECT_EQ(a.scale, b.scale);
  EXPECT_EQ(a.sigma_scale, b.sigma_scale);
}

TEST(DepthMotion, AReZeroIsNoStep) {
  DepthMotion motion;
  DepthTrack track;
  const UtcTime begin{1'700'000'000'000'000'000};
  for (int k = 0; k < 200; ++k) {
    const UtcTime utc = begin + Duration::Seconds(2.0 * k);
    if (k == 100) motion.Restart();
    PushMark(utc, k + (k < 100 ? 0 : 7), track);
    SixAxes sample = SixAxes::Zero();
    sample[5] = -9.8;
    motion.Feel({&utc, 1}, Duration::Seconds(2), {&sample, 1}, track);
  }
  EXPECT_LT(std::abs(motion.found().step), 1e-6);
  EXPECT_GT(motion.found().compared, 180);
}

}  // namespace
}  // namespace wellgyro

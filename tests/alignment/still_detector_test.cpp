#include "wellgyro/alignment/still_detector.h"

#include <cmath>
#include <functional>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/base/units.h"
#include "wellgyro/math/random.h"
#include "wellgyro/math/statistics.h"

namespace wellgyro {
namespace {

using units::kDeg;
using units::kDegPerHour;

constexpr double kG = 9.81;

/// A tool whose inclination and toolface are functions of time; rates by their difference, the
/// Earth's added in the tool. Slow, but nobody's formulas.
struct Tool {
  std::function<double(double)> inclination = [](double) { return 0.5; };
  std::function<double(double)> toolface = [](double) { return 0.3; };
  std::function<AlongHole(double)> along = [](double) { return AlongHole{}; };
  double period = 0.01;
  double gyro_noise = 0.01 * units::kDegPerSqrtHour;
  double accel_noise = 50e-6 * kG;
  std::int64_t tool0 = 12'345'678'901;
  Random random{1};

  ImuSample Sample(std::int64_t seq) {
    const double t = static_cast<double>(seq) * period, h = period / 2;
    const double I = inclination(t + h), T = toolface(t + h);
    const double dI = (inclination(t + period) - inclination(t)) / period;
    const double dT = (toolface(t + period) - toolface(t)) / period;
    ImuSample sample;
    sample.stamp.seq = seq;
    sample.stamp.session = 1;
    sample.stamp.period_ns = static_cast<std::int32_t>(Duration::Seconds(period).ns);
    sample.stamp.tool_time = {tool0 + seq * sample.stamp.period_ns};
    sample.stamp.utc = {1'700'000'000'000'000'000 + seq * sample.stamp.period_ns};
    sample.has_gz = true;
    sample.w_IT_T = {dI * std::sin(T) + 5e-5 * std::cos(T), dI * std::cos(T) - 5e-5 * std::sin(T),
                     dT + 3e-5};
    sample.f_T =
        kG * Eigen::Vector3d(std::sin(I) * std::cos(T), -std::sin(I) * std::sin(T), -std::cos(I));
    for (int i = 0; i < 3; ++i) {
      sample.w_IT_T[i] += gyro_noise / std::sqrt(period) * random.Normal();
      sample.f_T[i] += accel_noise / std::sqrt(period) * random.Normal();
    }
    return sample;
  }
};

StillSetup SetupFor(const Tool& tool, double min_still = 60) {
  return {.gyro = {.angle_random_walk = tool.gyro_noise},
          .errors = {.gyro_bias_sigma = 0.1 * kDegPerHour, .accel_noise = tool.accel_noise},
          .min_still = Duration::Seconds(min_still)};
}

std::vector<StillWindow> Detect(Tool& tool, const StillSetup& setup, double seconds) {
  StillDetector detector(setup);
  std::vector<StillWindow> windows;
  const auto keep = [&](std::optional<StillWindow> window) {
    if (window) windows.push_back(*window);
  };
  for (std::int64_t k = 0; k < std::llround(seconds / tool.period); ++k) {
    keep(detector.Push(tool.Sample(k), tool.along((static_cast<double>(k) + 0.5) * tool.period)));
  }
  keep(detector.Flush());
  return windows;
}

double Begin(const Tool& tool, const StillWindow& w) {
  return static_cast<double>(w.begin.ns - tool.tool0) * 1e-9;
}
double End(const Tool& tool, const StillWindow& w) {
  return static_cast<double>(w.end.ns - tool.tool0) * 1e-9;
}

/// Moves but between 100 s and 100 + `length`.
Tool StopAt100(double length) {
  Tool tool;
  const auto clock = [length](double t) {
    return t < 100 ? t - 100 : t < 100 + length ? 0 : t - 100 - length;
  };
  tool.inclination = [clock](double t) { return 0.5 + 1e-3 * clock(t); };
  tool.toolface = [clock](double t) { return 0.3 + 0.05 * clock(t); };
  return tool;
}

TEST(StillDetector, AStopIsOneWindowInsideItWithItsMeans) {
  for (const double period : {0.0025, 0.01, 0.1, 0.5}) {
    Tool tool = StopAt100(180);
    tool.period = period;
    const auto windows = Detect(tool, SetupFor(tool), 400);
    ASSERT_EQ(windows.size(), 1u) << period;
    const StillWindow& w = windows[0];
    EXPECT_GE(Begin(tool, w), 100) << period;
    EXPECT_LE(End(tool, w), 280) << period;
    EXPECT_GT(w.seconds(), 174) << period;
    EXPECT_EQ(w.samples, w.seq_end - w.seq_begin);
    const ImuSample truth = [&] {
      Tool quiet = tool;
      quiet.gyro_noise = quiet.accel_noise = 0;
      return quiet.Sample(std::llround(200 / period));
    }();
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(w.w_IT_T[i], truth.w_IT_T[i], 4.5 * w.sigma_w_IT_T[i]) << period;
      EXPECT_NEAR(w.f_T[i], truth.f_T[i], 4.5 * w.sigma_f_T[i]) << period;
      EXPECT_NEAR(w.sigma_w_IT_T[i], tool.gyro_noise / std::sqrt(w.seconds()), 1e-12);
      EXPECT_NEAR(w.sigma_f_T[i], tool.accel_noise / std::sqrt(w.seconds()), 1e-9);
    }
    EXPECT_TRUE(w.has_gz);
    EXPECT_EQ(w.quality, Quality::kGood);
    EXPECT_FALSE(w.md.has_value());
  }
}

TEST(StillDetector, AStopOfMinStillGivesAWindowAndAShorterOneNone) {
  for (int seed = 0; seed < 5; ++seed) {
    Tool tool = StopAt100(60);
    tool.tool0 += 237'000'000 * seed;
    tool.random = Random(static_cast<std::uint64_t>(seed));
    EXPECT_EQ(Detect(tool, SetupFor(tool), 200).size(), 1u);
    tool = StopAt100(51);
    EXPECT_EQ(Detect(tool, SetupFor(tool), 200).size(), 0u);
  }
}

// Dated 2026-11-22: samples that begin on whole seconds, by a clock that jitters by a nanosecond.
TEST(StillDetector, ABlockNeedNotBeHitToTheNanosecond) {
  Tool tool = StopAt100(180);
  tool.period = 0.1;
  tool.tool0 = 12'000'000'000;
  const auto detect = [&](std::int64_t jitter) {
    StillDetector detector(SetupFor(tool));
    Random random(5);
    std::vector<StillWindow> windows;
    for (std::int64_t k = 0; k < 4000; ++k) {
      ImuSample sample = tool.Sample(k);
      sample.stamp.tool_time.ns += std::llround(static_cast<double>(jitter) * random.Normal());
      if (auto window = detector.Push(sample, {})) windows.push_back(*window);
    }
    if (auto window = detector.Flush()) windows.push_back(*window);
    return windows;
  };
  for (const std::int64_t jitter : {0, 1, 1000, 10'000'000}) {
    const auto windows = detect(jitter);
    ASSERT_EQ(windows.size(), 1u) << jitter << " ns";
    EXPECT_GT(windows[0].seconds(), 174) << jitter << " ns";
  }
}

TEST(StillDetector, AMovingToolGivesNone) {
  Tool tool;
  tool.inclination = [](double t) { return 0.5 + 2e-4 * t; };
  tool.toolface = [](double t) { return 0.3 * std::sin(0.2 * t); };
  EXPECT_TRUE(Detect(tool, SetupFor(tool), 600).empty());
  Tool roll;  // slow roll about its own axis, no third gyro needed
  roll.toolface = [](double t) { return 0.02 * kDeg * t; };
  EXPECT_TRUE(Detect(roll, SetupFor(roll), 600).empty());
}

// 10 deg/h of inclination: within the rate that the Earth and a bias can have, a hundredth of the
// gyros' noise in a second; gravity shows it.
TEST(StillDetector, SlowCreepIsNotStill) {
  Tool tool;
  tool.inclination = [](double t) { return 0.5 + 10 * kDegPerHour * t; };
  EXPECT_TRUE(Detect(tool, SetupFor(tool), 600).empty());
  tool.inclination = [](double t) { return 0.5 + 0.02 * kDegPerHour * t; };
  EXPECT_EQ(Detect(tool, SetupFor(tool), 600).size(), 1u) << "an accelerometer drifts as much";
}

TEST(StillDetector, CreepThatShowsOnlyAfterMinStillIsFlagged) {
  Tool tool;
  tool.inclination = [](double t) { return 0.5 + 0.6 * kDegPerHour * t; };
  const auto windows = Detect(tool, SetupFor(tool, 40), 600);
  ASSERT_FALSE(windows.empty());
  EXPECT_TRUE(Has(windows[0].quality, Quality::kMoved));
}

TEST(StillDetector, RollTooSlowToEndTheStopIsTold) {
  double squares = 0;
  constexpr int kSeeds = 20;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    Tool tool;
    tool.random = Random(static_cast<std::uint64_t>(seed));
    tool.period = 0.1;
    const double rate = (seed % 2 == 0 ? 0.05 : -0.05) * kDegPerHour;
    tool.toolface = [rate](double t) { return 2.1 + rate * t; };
    const auto windows = Detect(tool, SetupFor(tool), 300);
    ASSERT_EQ(windows.size(), 1u);
    ASSERT_TRUE(windows[0].roll_rate.has_value());
    // A line through n seconds: sigma_T sqrt(12 / n^3), sigma_T of one second 1e-4 / sin 0.5.
    EXPECT_NEAR(windows[0].sigma_roll_rate,
                50e-6 / std::sin(0.5) * std::sqrt(12 / std::pow(windows[0].seconds(), 3)),
                0.1 * windows[0].sigma_roll_rate);
    squares += std::pow((*windows[0].roll_rate - rate) / windows[0].sigma_roll_rate, 2);
  }
  EXPECT_GT(squares, ChiSquareQuantile(0.001, kSeeds));
  EXPECT_LT(squares, ChiSquareQuantile(0.999, kSeeds));
}

TEST(StillDetector, SlidingInAStraightHoleIsVetoedByDepth) {
  const auto slide = [](double speed, double from) {
    return [=](double t) {
      const double v = t < from ? 0 : speed;
      return AlongHole{.md = 1000 + (t < from ? 0 : v * (t - from)), .speed = v, .known = true};
    };
  };
  Tool tool;
  tool.along = slide(0.5, 0);
  EXPECT_TRUE(Detect(tool, SetupFor(tool), 300).empty());
  tool.along = slide(0.0, 0);
  ASSERT_EQ(Detect(tool, SetupFor(tool), 300).size(), 1u);
  EXPECT_NEAR(*Detect(tool, SetupFor(tool), 300)[0].md, 1000, 1e-9);
  tool.along = slide(0.5, 150.5);
  const auto windows = Detect(tool, SetupFor(tool), 300);
  ASSERT_EQ(windows.size(), 1u);
  EXPECT_LE(End(tool, windows[0]), 150.5);
  EXPECT_GT(End(tool, windows[0]), 147);
  tool.along = slide(0.003, 0);  // below the speed limit, but the way adds up
  for (const auto& w : Detect(tool, SetupFor(tool, 20), 300)) EXPECT_LT(w.seconds() * 0.003, 0.11);
}

// Marks at 2 Hz that scatter by 0.1 m: a DepthTrack errs by 0.06 m and by 0.12 m/s, and says so.
TEST(StillDetector, DepthThatScattersDoesNotMoveAToolAtRest) {
  Random random(7);
  std::vector<AlongHole> scatter(301);
  for (AlongHole& at : scatter) {
    at = {.md = 0.06 * random.Normal(), .speed = 0.12 * random.Normal(), .sigma_speed = 0.12};
  }
  const auto depth = [&](double speed) {
    return [&scatter, speed](double t) {
      AlongHole along = scatter[static_cast<std::size_t>(t)];
      along.md += 1000 + speed * t;
      along.speed += speed;
      along.known = true;
      return along;
    };
  };
  Tool tool;
  tool.along = depth(0);
  const auto windows = Detect(tool, SetupFor(tool), 300);
  ASSERT_EQ(windows.size(), 1u);
  EXPECT_GT(windows[0].seconds(), 290);
  tool.along = depth(0.02);
  EXPECT_TRUE(Detect(tool, SetupFor(tool), 300).empty()) << "1.2 m in a minute is seen through it";
}

TEST(StillDetector, CutsAndGapsEndTheWindow) {
  Tool tool;
  StillDetector detector(SetupFor(tool));
  std::vector<StillWindow> windows;
  const auto keep = [&](std::optional<StillWindow> window) {
    if (window) windows.push_back(*window);
  };
  std::int64_t k = 0;
  const auto run = [&](double seconds) {
    for (const std::int64_t end = k + std::llround(seconds / tool.period); k < end; ++k) {
      keep(detector.Push(tool.Sample(k), {}));
    }
  };
  run(100.37);
  keep(detector.Cut(1));
  ASSERT_EQ(windows.size(), 1u);
  EXPECT_FALSE(windows[0].index_position.has_value());
  EXPECT_LE(windows[0].seq_end, k);
  const std::int64_t cut = k;
  run(90);
  k += 1;  // one sample lost
  run(0.01);
  ASSERT_EQ(windows.size(), 2u);
  EXPECT_EQ(windows[1].index_position, 1);
  EXPECT_GE(windows[1].seq_begin, cut);
  EXPECT_LE(windows[1].seq_end, k - 2);
  run(80);
  tool.period = 0.005;  // another rate
  k *= 2;
  run(30);
  ASSERT_EQ(windows.size(), 3u);
  keep(detector.Flush());
  EXPECT_EQ(windows.size(), 3u) << "too short";
}

TEST(StillDetector, StillNowBeginsWithTheThirdBlockAndEndsWithTheMotion) {
  Tool tool = StopAt100(60);
  tool.along = [](double t) {
    const double v = t < 100 || t > 160 ? 0.3 : 0;
    return AlongHole{.md = 0, .speed = v, .known = true};
  };
  StillDetector detector(SetupFor(tool));
  double first = 0, last = 0, since = 0;
  for (std::int64_t k = 0; k < 20000; ++k) {
    const double t = (static_cast<double>(k) + 0.5) * tool.period;
    (void)detector.Push(tool.Sample(k), tool.along(t));
    if (!detector.still()) {
      EXPECT_EQ(detector.OpenWindow().has_value() && t < 100, false);
      continue;
    }
    const std::optional<StillWindow> open = detector.OpenWindow();
    ASSERT_TRUE(open.has_value());
    if (first == 0) {
      first = t;
      since = static_cast<double>(open->begin.ns - tool.tool0) * 1e-9;
    }
    last = t;
  }
  EXPECT_GT(first, 103);
  EXPECT_LT(first, 104.1);
  EXPECT_GT(since, 101);
  EXPECT_LT(since, 102.1);
  EXPECT_LT(last, 160.02);
  EXPECT_GT(last, 159.9);
}

// Where the stream is picked up moves the begin by whole seconds of the tool clock only.
TEST(StillDetector, BlocksAreTheToolClocks) {
  Tool tool = StopAt100(120);
  std::vector<ImuSample> samples;
  for (std::int64_t k = 0; k < 25000; ++k) samples.push_back(tool.Sample(k));
  std::vector<StillWindow> windows;
  for (const std::size_t from : {0u, 777u, 5003u}) {
    StillDetector detector(SetupFor(tool));
    for (std::size_t k = from; k < samples.size(); ++k) {
      const auto window = detector.Push(samples[k], {});
      if (window) windows.push_back(*window);
      EXPECT_FALSE(detector.Push(samples[k], {}).has_value()) << "seen";
    }
  }
  ASSERT_EQ(windows.size(), 3u);
  for (const auto& w : windows) {
    EXPECT_EQ(w.begin, windows[0].begin);
    EXPECT_EQ(w.seq_end, windows[0].seq_end);
    EXPECT_EQ(w.w_IT_T, windows[0].w_IT_T);
    EXPECT_EQ(w.f_T, windows[0].f_T);
  }
}

TEST(StillDetector, SaturationIsFlagged) {
  Tool tool;
  StillDetector detector(SetupFor(tool));
  for (std::int64_t k = 0; k < 10000; ++k) {
    ImuSample sample = tool.Sample(k);
    sample.stamp.accel_saturated = k == 5000;
    EXPECT_FALSE(detector.Push(sample, {}).has_value());
  }
  const auto window = detector.Flush();
  ASSERT_TRUE(window.has_value());
  EXPECT_TRUE(Has(window->quality, Quality::kSaturated));
}

// Noise three times the coefficients': the sigma is that of the blocks' own scatter.
TEST(StillDetector, SigmaFollowsTheScatterWhereTheCoefficientsDoNot) {
  Tool tool;
  StillSetup setup = SetupFor(tool);
  tool.gyro_noise *= 3;
  const auto windows = Detect(tool, setup, 300);
  ASSERT_EQ(windows.size(), 1u);
  EXPECT_NEAR(windows[0].sigma_w_IT_T[0] / (tool.gyro_noise / std::sqrt(windows[0].seconds())), 1,
              0.2);
  // And with none at all.
  const auto blind = Detect(tool, StillSetup{}, 300);
  ASSERT_EQ(blind.size(), 1u);
  EXPECT_NEAR(blind[0].sigma_w_IT_T[1] / (tool.gyro_noise / std::sqrt(blind[0].seconds())), 1, 0.2);
}

// Errors of the means over their sigmas, many stops.
TEST(StillDetector, SigmaOfTheMeansIsHonest) {
  double sum = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    Tool tool;
    tool.period = 0.05;
    tool.random = Random(seed);
    const auto windows = Detect(tool, SetupFor(tool), 100);
    ASSERT_EQ(windows.size(), 1u);
    Tool quiet = tool;
    quiet.gyro_noise = quiet.accel_noise = 0;
    const ImuSample truth = quiet.Sample(1000);
    for (int i = 0; i < 3; ++i) {
      sum += std::pow((windows[0].w_IT_T[i] - truth.w_IT_T[i]) / windows[0].sigma_w_IT_T[i], 2);
      sum += std::pow((windows[0].f_T[i] - truth.f_T[i]) / windows[0].sigma_f_T[i], 2);
    }
  }
  EXPECT_GT(sum, ChiSquareQuantile(0.0005, 240));
  EXPECT_LT(sum, ChiSquareQuantile(0.9995, 240));
}

TEST(StillDetector, RefusesASetUpThatCannotBe) {
  EXPECT_THROW(StillDetector({.min_still = Duration::Seconds(1)}), std::invalid_argument);
  EXPECT_THROW(StillDetector({.speed_limit = 0}), std::invalid_argument);
  EXPECT_THROW(StillDetector({.errors = {.accel_noise = -1}}), std::invalid_argument);
}

}  // namespace
}  // namespace wellgyro

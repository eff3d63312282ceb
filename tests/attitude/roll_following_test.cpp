// What the noise that psi follows does to a knot's mean force.
#include <cmath>
#include <functional>
#include <ostream>
#include <string>
#include <utility>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "wellgyro/attitude/increment_builder.h"
#include "wellgyro/attitude/roll_following_internal.h"
#include "wellgyro/base/angle.h"
#include "wellgyro/math/random.h"

namespace wellgyro::increment {
namespace {

/// The integral itself, by the middle of steps of a thousandth.
double ByQuadrature(double a) {
  const double step = 1e-3, end = 2000 + 20 * a;
  double sum = 0;
  for (double x = 0.5 * step; x < end; x += step) {
    const double passed = 1 / (1 + std::pow(x / a, 4));
    const double s = std::sin(x / 2) / (x / 2), c = std::cos(x / 2);
    sum += step * (s - passed * (s - c)) * (s - passed * (s - c));
  }
  return sum / kPi;
}

TEST(LateralVariance, IsTheIntegral) {
  constexpr double kMany = 1e6;
  for (const double a : {0.2, 0.5, 1., 1.5, 2.5, 3., 4., 4.5, 6.5, 7., 9., 10., 11., 25., 90.}) {
    EXPECT_NEAR(LateralVariance(a, kMany), ByQuadrature(a), 0.03 * ByQuadrature(a)) << a;
  }
}

TEST(LateralVariance, IsOneWhereThereIsNothingToFollow) {
  EXPECT_EQ(LateralVariance(0, 50), 1);
  EXPECT_EQ(LateralVariance(7, 3), 1);
  EXPECT_EQ(LateralVariance(1e3, 10), 5);
}

struct Way {
  std::string name;
  std::function<double(double)> roll;  ///< at a time [rad]
  double hz;
};
void PrintTo(const Way& way, std::ostream* out) { *out << way.name; }

class Following : public testing::TestWithParam<Way> {};

// A tool that lies and rolls. Where a knot's force stands about the axis against where the roll
// has it, the straight line of psi's error taken back as the estimator does.
TEST_P(Following, IsOfTheSizeTold) {
  const Way& way = GetParam();
  const double noise = 3e-4, across = 8, period = 1 / way.hz;
  const int knots = 2000, samples = static_cast<int>(way.hz) * knots;
  Random random(17);
  IncrementOptions options;
  options.accel_noise = noise;
  options.angle_random_walk = 1e-6;
  IncrementBuilder builder(options);
  double squares = 0, told = 0, count = 0, begin = 0;
  for (int i = 0; i < samples; ++i) {
    ImuSample sample;
    sample.stamp.seq = i;
    sample.stamp.tool_time.ns = std::llround(1e9 * i * period);
    sample.stamp.period_ns = static_cast<std::int32_t>(std::lround(1e9 * period));
    // The mean over the sample, by Simpson's rule.
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (const auto& [at, weight] : {std::pair(0., 1.), {0.5, 4.}, {1., 1.}}) {
      const double roll = way.roll((i + at) * period);
      mean += weight / 6 * Eigen::Vector2d(std::cos(roll), -std::sin(roll));
    }
    const double sigma = noise / std::sqrt(period);
    sample.f_T << across * mean.x() + sigma * random.Normal(),
        across * mean.y() + sigma * random.Normal(), -5 + sigma * random.Normal();
    ASSERT_TRUE(builder.Push(sample, false));
    if ((i + 1) % static_cast<int>(way.hz) == 0) builder.Cut();
    if (i + 1 == samples) builder.Flush();
    while (builder.Ready()) {
      const Increment inc = builder.Pop();
      const double end = begin + inc.seconds, from = way.roll(begin);
      const double psi = inc.roll_before + inc.roll_after, truth = way.roll(end) - from;
      const double middle = from + inc.roll_before + 0.5 * (truth - psi);
      const double stands = std::atan2(inc.force_M.y(), inc.force_M.x());
      const double off = across * WrapPi(stands + middle);
      begin = end;
      if (end < 20 || end > knots - 20) continue;
      squares += off * off * inc.seconds / (noise * noise);
      told += inc.lateral;
      ++count;
    }
  }
  RecordProperty("told", std::to_string(told / count));
  RecordProperty("is", std::to_string(squares / count));
  // Some 2000 squares, of neighbours that share an end: 5 %.
  EXPECT_NEAR(squares / told, 1, 0.15) << squares / count << " " << told / count;
}

double Rolling(double t) { return 0.2 * t; }

double Sway(double t) { return FromDegrees(2) * std::sin(kTwoPi * 0.15 * t); }

double Swing(double t) { return FromDegrees(8) * std::sin(kTwoPi * 0.7 * t); }

INSTANTIATE_TEST_SUITE_P(Tool, Following,
                         testing::Values(Way{"rests", [](double) { return 0.4; }, 100},
                                         Way{"rests_10_Hz", [](double) { return 0.4; }, 10},
                                         Way{"rolls", Rolling, 50}, Way{"swings", Swing, 100},
                                         Way{"sways_10_Hz", Sway, 10}));

}  // namespace
}  // namespace wellgyro::increment

// Where the roll may start.
#include "wellgyro/estimate/roll_start.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/math/random.h"

namespace wellgyro {
namespace {

// On the way only the newest knot's is asked for.
TEST(SpeedStarts, OfTheLastKnotAreThoseOfAll) {
  Random random(5);
  std::vector<RunKnot> knots(300);
  double speed = 0;
  for (std::size_t k = 0; k < knots.size(); ++k) {
    if (k % 20 < 4) speed += 0.1 * random.Normal();
    knots[k].increment.seconds = 0.3 + 0.9 * static_cast<double>(k % 7) / 7;
    knots[k].along.known = k % 31 != 0;
    knots[k].along.speed = speed;
    knots[k].along.sigma_speed = 1e-3;
  }
  int starts = 0;
  for (std::size_t n = 1; n <= knots.size(); ++n) {
    const std::span<const RunKnot> behind = std::span(knots).first(n);
    EXPECT_EQ(LastSpeedStart(behind), SpeedStarts(behind).back()) << n;
    starts += LastSpeedStart(behind) > 0 ? 1 : 0;
  }
  EXPECT_GT(starts, 50);
  EXPECT_LT(starts, 250);
}

// -2 ln of 1 / C(n, m) but for half its ln, and of the ratio of N(x; 0, s), averaged over ln s
// between the bounds of the walk, to N(x; 0, |x|), m times.
TEST(CostOfStarts, IsThatOfWhichAndOfHowLarge) {
  constexpr double kChange = 1e-3;
  const auto density = [](double s) {
    return std::exp(-0.5 * kChange * kChange / (s * s)) / (s * std::sqrt(kTwoPi));
  };
  const double from = std::log(kRollWalkLeast), to = std::log(kRollWalkMost);
  constexpr int kSteps = 20'000;
  double mean = 0;
  for (int i = 0; i < kSteps; ++i)
    mean += density(std::exp(from + (to - from) * (i + 0.5) / kSteps));
  mean /= kSteps;
  const double size = -2 * std::log(mean / density(kChange));
  for (const auto& [m, n] : {std::pair(1, 1000), std::pair(7, 1042), std::pair(406, 1042)}) {
    std::vector<double> starts(static_cast<std::size_t>(n), 0);
    std::fill_n(starts.begin(), m, 0.02);
    const double which = 2 * (std::lgamma(n + 1) - std::lgamma(m + 1) - std::lgamma(n - m + 1));
    EXPECT_NEAR(CostOfStarts(starts), which + m * size, 0.01 * m * size + std::log(n)) << m;
  }
  EXPECT_EQ(CostOfStarts(std::vector<double>(50, 0.)), 0);
  EXPECT_NEAR(CostOfStarts(std::vector<double>(50, 1.)), 50 * size, 0.5 * size);
}

}  // namespace
}  // namespace wellgyro

#include "wellgyro/math/golden_section.h"

#include <cmath>

#include <gtest/gtest.h>

namespace wellgyro {
namespace {

TEST(GoldenSection, FindsTheMinimumInsideAndAtEitherEnd) {
  for (const double at : {-1.0, -0.3, 0.0, 0.7, 2.0}) {
    const auto cost = [&](double x) { return std::abs(x - at); };
    const auto goes_on = [](double low, double high) { return high - low > 1e-10; };
    EXPECT_NEAR(GoldenSection(-1, 2, cost, goes_on), at, 1e-10) << at;
  }
}

// ((sqrt(5) - 1) / 2)^n of the interval is left after n turns.
TEST(GoldenSection, EachTurnLeavesTheGoldenFraction) {
  double left = 0;
  int turn = 0;
  const auto goes_on = [&](double low, double high) {
    left = high - low;
    return turn++ < 20;
  };
  GoldenSection(
      0, 1, [](double x) { return (x - 0.4) * (x - 0.4); }, goes_on);
  EXPECT_NEAR(left, std::pow((std::sqrt(5.0) - 1) / 2, 20), 1e-14);
}

}  // namespace
}  // namespace wellgyro

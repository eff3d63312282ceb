// Readings that are few or rounded: the sigmas of a bench hold what these leave open.
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "wellgyro/fit/position_fit.h"

#include "fit/bench_simulation.h"

namespace wellgyro::test {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

const FitQuantity& BiasOf(const FitReport& report) {
  const auto found = std::ranges::find(report.result, "Vb_V", &FitQuantity::name);
  if (found == report.result.end()) throw std::runtime_error("no quantity Vb_V");
  return *found;
}

// Few readings a position, in a transient: sigmas three times too small.
TEST(BenchRounding, ShortRunsOnATransientHaveItInTheirSigmas) {
  Random random(19);
  double square = 0;
  constexpr int kBenches = 30;
  for (int bench = 0; bench < kBenches; ++bench) {
    const VoltTool tool = VoltTool::Any(random);
    const BenchTable data = TwentyFour(
        tool, {.sigma = 1e-5, .readings = 5, .transient = 1e-4, .transient_readings = 4}, random);
    const auto fitted = FitTwentyFourPositions(data, {.settle_tolerance = 2e-4});
    ASSERT_TRUE(fitted.has_value()) << fitted.fault().text;
    EXPECT_THAT(fitted->report.remarks, Contains(HasSubstr("still change")));
    const FitQuantity& Vb = BiasOf(fitted->report);
    square += (Vb.value - tool.Vb).cwiseQuotient(Vb.sigma).squaredNorm() / 3 / kBenches;
  }
  EXPECT_LT(square, 1.5);
  EXPECT_GT(square, 0.1);
}

/// Of sixty benches read in so many steps a volt: squares of the biases over their number.
double SquaresOfRounded(double steps_per_volt, const VoltBench& setup, const std::string& remark,
                        Random& random) {
  constexpr int kBenches = 60;
  double square = 0;
  for (int bench = 0; bench < kBenches; ++bench) {
    const VoltTool tool = VoltTool::Any(random);
    BenchTable data = TwentyFour(tool, setup, random);
    for (double& value : data.values.col(*data.Find("volt"))) {
      value = std::round(value * steps_per_volt) / steps_per_volt;
    }
    const auto fitted = FitTwentyFourPositions(data, {.settle_tolerance = 2e-4});
    if (!fitted) return NAN;
    EXPECT_THAT(fitted->report.remarks, Contains(HasSubstr(remark)));
    const FitQuantity& Vb = BiasOf(fitted->report);
    square += (Vb.value - tool.Vb).cwiseQuotient(Vb.sigma).squaredNorm() / 3 / kBenches;
  }
  return square;
}

// 16 bits of 5 V, and a tenth of that noise; and steps of 1e-5 V without noise on an exact bench,
// where the few values that are read lie many of them apart.
TEST(BenchRounding, RoundingThatNoNoiseSpreadsIsInTheSigmas) {
  Random random(23);
  // Where rotations differ by more than a step their rounding averages: less than the bound.
  const double noisy =
      SquaresOfRounded(1 / 76e-6, {.sigma = 1e-5, .readings = 5}, "in steps of 7.6e-05 V", random);
  EXPECT_LT(noisy, 1.6);
  EXPECT_GT(noisy, 0.2);
  const double still =
      SquaresOfRounded(1e5, {.sigma = 0, .readings = 6}, "in steps of 1e-05 V", random);
  EXPECT_LT(still, 1.6);
  EXPECT_GT(still, 0.2);
  const BenchTable fine = TwentyFour(VoltTool::Any(random), {.sigma = 1e-5, .readings = 5}, random);
  const auto fitted = FitTwentyFourPositions(fine, {.settle_tolerance = 2e-4});
  ASSERT_TRUE(fitted.has_value());
  EXPECT_THAT(fitted->report.remarks, Not(Contains(HasSubstr("in steps of"))));
}

}  // namespace
}  // namespace wellgyro::test

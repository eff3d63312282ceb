#include "wellgyro/math/interpolation.h"

#include <cmath>

#include <gtest/gtest.h>

namespace wellgyro {
namespace {

TEST(Interpolation, AParabolaIsFoundWhateverTheWeightsAndSpacing) {
  LocalFit fit;
  for (const double t : {-0.9, -0.35, -0.3, 0.1, 0.7, 1.0}) {
    fit.Add(t, 1500.25 - 3 * t + 0.5 * t * t, 1.01 - t * t);
  }
  EXPECT_EQ(fit.count(), 6);
  const auto value = fit.Fit(2);
  EXPECT_NEAR(value.value, 1500.25, 1e-11);
  EXPECT_NEAR(value.slope, -3, 1e-10);
  EXPECT_NEAR(value.curvature, 1, 1e-9);
}

// Savitzky and Golay (1964), five points, quadratic: value (-3 12 17 12 -3)/35, slope
// (-2 -1 0 1 2)/10, second derivative (2 -1 -2 -1 2)/7; the variance of the value is 17/35.
TEST(Interpolation, EqualWeightsAreSavitzkyAndGolays) {
  const double y[] = {0.3, -1.2, 2.5, 0.9, 4.4};
  LocalFit fit;
  for (int i = 0; i < 5; ++i) fit.Add(i - 2, y[i], 1);
  const auto value = fit.Fit(2);
  EXPECT_NEAR(value.value, (-3 * (y[0] + y[4]) + 12 * (y[1] + y[3]) + 17 * y[2]) / 35, 1e-14);
  EXPECT_NEAR(value.slope, (-2 * y[0] - y[1] + y[3] + 2 * y[4]) / 10, 1e-14);
  EXPECT_NEAR(value.curvature, (2 * (y[0] + y[4]) - y[1] - y[3] - 2 * y[2]) / 7, 1e-14);
  EXPECT_NEAR(value.variance_value, 17.0 / 35, 1e-14);
}

TEST(Interpolation, FallsToWhatThePointsDetermine) {
  LocalFit fit;
  EXPECT_EQ(fit.Fit(2).value, 0);
  fit.Add(0.5, 7, 1);
  EXPECT_EQ(fit.Fit(2).value, 7);
  fit.Add(0.5, 9, 1);
  EXPECT_EQ(fit.Fit(2).value, 8);
  EXPECT_EQ(fit.Fit(2).slope, 0);
  EXPECT_NEAR(fit.Fit(2).variance_value, 0.5, 1e-15);
  fit.Add(-0.5, 10, 0);
  EXPECT_EQ(fit.count(), 2);
  fit.Add(-0.5, 10, 2);
  EXPECT_NEAR(fit.Fit(2).value, 9, 1e-14);
  EXPECT_NEAR(fit.Fit(2).slope, -2, 1e-14);
}

}  // namespace
}  // namespace wellgyro

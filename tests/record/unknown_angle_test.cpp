#include "wellgyro/record/unknown_angle.h"

#include <cmath>

#include <gtest/gtest.h>

namespace wellgyro {
namespace {

TEST(UnknownAngle, IsAFlatDistributionRoundTheCircle) {
  const int n = 1000000;
  double sum = 0;
  for (int i = 0; i < n; ++i) sum += std::pow(kPi * (2 * (i + 0.5) / n - 1), 2) / n;
  EXPECT_NEAR(kUnknownAngleVariance, sum, 1e-10);
}

}  // namespace
}  // namespace wellgyro

#include "wellgyro/simulate/smooth_window.h"

#include <cmath>

#include <gtest/gtest.h>

namespace wellgyro {
namespace {

TEST(SmoothWindow, IsItsOwnIntegralAndSlope) {
  constexpr double kStep = 1e-4;
  for (const auto& [in, out] : {std::pair{3.0, 2.0}, {0.5, 5.0}, {4.0, 6.0}}) {
    for (double x = 0.05; x < 10; x += 0.1) {
      const auto at = [&, in = in, out = out](double d) {
        return SmoothWindowAt(x + d, 10, in, out);
      };
      EXPECT_NEAR(at(0).slope, (at(kStep).value - at(-kStep).value) / (2 * kStep), 1e-6) << x;
      EXPECT_NEAR(at(0).value, (at(kStep).integral - at(-kStep).integral) / (2 * kStep), 1e-7) << x;
    }
    EXPECT_NEAR(SmoothWindowAt(10, 10, in, out).integral, 10 - (in + out) / 2, 1e-14);
    EXPECT_DOUBLE_EQ(SmoothWindowAt(11, 10, in, out).integral, 10 - (in + out) / 2);
  }
}

TEST(SmoothWindow, HasTwoContinuousDerivatives) {
  constexpr double kStep = 1e-5;
  for (const double joint : {0.0, 2.0, 7.0, 10.0}) {
    const SmoothWindow before = SmoothWindowAt(joint - kStep, 10, 2, 3);
    const SmoothWindow after = SmoothWindowAt(joint + kStep, 10, 2, 3);
    EXPECT_NEAR(before.value, after.value, 1e-9);
    EXPECT_NEAR(before.slope, after.slope, 1e-8);  // 60/ramp^3 * step: the second derivative is 0
  }
}

TEST(SmoothWindow, WithoutRampsIsWhole) {
  for (const double x : {0.0, 3.0, 10.0}) {
    EXPECT_EQ(SmoothWindowAt(x, 10, 0, 0).value, 1);
    EXPECT_EQ(SmoothWindowAt(x, 10, 0, 0).integral, x);
  }
}

}  // namespace
}  // namespace wellgyro

#include "wellgyro/base/angle.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace wellgyro {
namespace {

TEST(Angle, WrapsIntoItsHalfOpenRange) {
  EXPECT_EQ(WrapTwoPi(0), 0);
  EXPECT_EQ(WrapTwoPi(kTwoPi), 0);
  EXPECT_DOUBLE_EQ(WrapTwoPi(-0.25), kTwoPi - 0.25);
  EXPECT_LT(WrapTwoPi(-1e-20), kTwoPi);
  EXPECT_EQ(WrapPi(-kPi), kPi);
  EXPECT_EQ(WrapPi(kPi), kPi);
  EXPECT_NEAR(WrapPi(7 * kTwoPi + 1), 1, 1e-14);
}

TEST(Angle, WhatIsNotFiniteIsNoDirectionAndNotNorth) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  for (const double odd : {std::numeric_limits<double>::quiet_NaN(), kInf, -kInf}) {
    EXPECT_TRUE(std::isnan(WrapTwoPi(odd))) << odd;
    EXPECT_TRUE(std::isnan(WrapPi(odd))) << odd;
  }
}

TEST(Angle, DegreesAndBackKeepTheTurnsQuarters) {
  EXPECT_EQ(FromDegrees(180), kPi);
  EXPECT_EQ(FromDegrees(90), kPi / 2);
  EXPECT_EQ(ToDegrees(kPi), 180);
}

}  // namespace
}  // namespace wellgyro

#include "wellgyro/math/median.h"

#include <gtest/gtest.h>

#include "wellgyro/math/statistics.h"

namespace wellgyro {
namespace {

TEST(Median, IsTheMiddleOfAnEvenNumberTheUpper) {
  EXPECT_EQ(Median({}), 0);
  EXPECT_EQ(Median({7}), 7);
  EXPECT_EQ(Median({3, -1, 2}), 2);
  EXPECT_EQ(Median({4, 1, 3, 2}), 3);
}

TEST(Median, OfTheSizesOfNormalDeviationsGivesSigma) {
  EXPECT_NEAR(kSigmaPerMedianSize, 1 / NormalQuantile(0.75), 5e-5);
  EXPECT_EQ(RobustSigma({5, 1, 2}), kSigmaPerMedianSize * 2);
  EXPECT_EQ(RobustSigma({9, 10, 12}, 10), kSigmaPerMedianSize);
}

}  // namespace
}  // namespace wellgyro

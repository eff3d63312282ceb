// sin(x) / x against long double, over the seam between series and quotient too.
#include "wellgyro/math/sinc.h"

#include <cmath>

#include <gtest/gtest.h>

namespace wellgyro {
namespace {

TEST(Sinc, IsThatOfLongDouble) {
  EXPECT_EQ(Sinc(0), 1);
  for (double x = 1e-9; x < 40; x *= 1.01) {
    const long double exact = std::sin(static_cast<long double>(x)) / x;
    // The quotient's own rounding, and that of the sine where it is near nought.
    EXPECT_NEAR(Sinc(x), static_cast<double>(exact), 2e-16) << x;
    EXPECT_EQ(Sinc(-x), Sinc(x));
  }
}

}  // namespace
}  // namespace wellgyro

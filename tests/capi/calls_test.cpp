#include <gtest/gtest.h>

#include "capi/random_calls.h"

namespace wellgyro {
namespace {

TEST(Calls, InAnyOrderAreAnsweredOrRefused) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const std::int64_t refused = support::CallAtRandom(seed, 300);
    EXPECT_GT(refused, 0) << seed;
    EXPECT_LT(refused, 300) << seed;
  }
}

}  // namespace
}  // namespace wellgyro

#include <gtest/gtest.h>

#include "capi/random_calls.h"

namespace wellgyro {
namespace {

// A million in the long run. What would do harm is told by assertions and by the sanitizers.
TEST(Calls, InAnyOrderDoNoHarm) {
  constexpr std::int64_t kCalls = 500;
  const std::uint64_t seeds = WELLGYRO_LONG ? 2000 : 8;
  std::int64_t refused = 0;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed)
    refused += support::CallAtRandom(seed, kCalls);
  EXPECT_GT(refused, static_cast<std::int64_t>(seeds) * kCalls / 20);
  EXPECT_LT(refused, static_cast<std::int64_t>(seeds) * kCalls / 2);
}

}  // namespace
}  // namespace wellgyro

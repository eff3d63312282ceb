#include <gtest/gtest.h>

#include "capi/random_calls.h"

namespace wellgyro {
namespace {

TEST(Calls, AMillionInAnyOrder) {
  for (std::uint64_t seed = 1; seed <= 2000; ++seed) support::CallAtRandom(seed, 500);
}

}  // namespace
}  // namespace wellgyro

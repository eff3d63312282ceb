#include "wellgyro/survey/verdict/depth_checks.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/survey/surveyor.h"

#include "support/small_hole.h"

namespace wellgyro {
namespace {

Check LagOf(const DepthAgainstMotion& felt) {
  std::vector<Check> checks;
  AddDepthChecks(felt, 1, checks);
  const auto lag = std::ranges::find(checks, "depth_lag", &Check::code);
  if (lag == checks.end()) throw std::runtime_error("no depth_lag");
  return *lag;
}

// A memory tool of 2026-11-29, its clock joined by six stops to 0.208 s.
TEST(DepthChecks, ALagWithinTheTieOfTheClocksIsNone) {
  DepthAgainstMotion felt;
  felt.found.lag = -0.263;
  felt.found.sigma_lag = 1.55e-3;
  EXPECT_EQ(LagOf(felt).verdict, Verdict::kFail) << "one clock serves both";
  felt.sigma_utc = 0.208;
  const Check tied = LagOf(felt);
  EXPECT_NE(tied.verdict, Verdict::kFail);
  EXPECT_NEAR(tied.sigma.value_or(0), 0.208006, 1e-6) << "the root of the sum of squares";
  EXPECT_NEAR(tied.limit.value_or(0), 0.1 + 5 * 0.208006, 1e-5);
  felt.found.lag = 1.2;
  EXPECT_EQ(LagOf(felt).verdict, Verdict::kFail) << "more than five sigmas of the tie";
}

TEST(DepthChecks, TheTieOfTheClocksHasASigma) {
  Sink sink;
  Surveyor surveyor(testing::SlantJob(), sink);
  surveyor.TieClock(0);
  EXPECT_THROW(surveyor.TieClock(-1), std::invalid_argument);
  EXPECT_THROW(surveyor.TieClock(NAN), std::invalid_argument);
}

}  // namespace
}  // namespace wellgyro

#include "wellgyro/depth/stop_match.h"

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <stdexcept>
#include <vector>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "wellgyro/math/random.h"
#include "wellgyro/math/statistics.h"

namespace wellgyro {
namespace {

constexpr ToolTime kTool{123'456'000'000};
constexpr UtcTime kUtc{1'700'000'000'000'000'000};

/// Stands of pipe: two to six minutes under way, two to five at rest; seen by the tool, and noted
/// by people who look at a clock.
struct Log {
  std::vector<ToolRest> tool;
  std::vector<UtcRest> rig;
};

Log Stands(int stands, double offset, double drift, double sigma, std::uint64_t seed) {
  Random random(seed);
  const auto even = [&](double low, double high) { return low + (high - low) * random.Uniform(); };
  Log log;
  double t = 0;
  for (int i = 0; i < stands; ++i) {
    t += even(120, 360);
    const double end = t + even(120, 300);
    const auto noted = [&](double at) {
      return kUtc + Duration::Seconds(at + sigma * random.Normal());
    };
    const auto seen = [&](double at) {
      return kTool + Duration::Seconds((at - offset) / (1 + drift) + 0.3 * random.Normal());
    };
    const bool forgotten = random.Uniform() < 0.15, shaken = random.Uniform() < 0.1;
    const double wrong = random.Uniform() < 0.1 ? even(-120, 120) : 0;
    // The tool makes up its mind a second late.
    if (!shaken) log.tool.push_back({seen(t + 1), seen(end - 1)});
    if (!forgotten) log.rig.push_back({noted(t + wrong), noted(end)});
    t = end;
  }
  return log;
}

TEST(StopMatch, OffsetAndDriftAreRightWithinTheirSigmas) {
  constexpr int kSeeds = 200;
  double squares = 0, offset2 = 0, late = 0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const double offset = -4000 + 37 * seed, drift = 5e-5 * std::sin(seed);
    const Log log = Stands(40, offset, drift, 2, static_cast<std::uint64_t>(seed));
    const Result<StopMatch> match = MatchStops(log.tool, log.rig);
    ASSERT_TRUE(match) << seed << ": " << match.fault().text;
    EXPECT_GE(match->matched, 20);
    const double at = (match->tool - kTool).seconds();
    const double truth = at * (1 + drift) + offset;
    const Eigen::Vector2d off((match->utc - kUtc).seconds() - truth, match->drift - drift);
    squares += off.dot(match->cov.ldlt().solve(off));
    offset2 += off[0] * off[0];
    EXPECT_LT(std::abs(off[0]), 2.5) << seed;
    EXPECT_NEAR(match->late, 1, 1) << seed;
    late += match->late / kSeeds;
  }
  std::printf("offset rms %.3f s\n", std::sqrt(offset2 / kSeeds));
  EXPECT_GT(squares, ChiSquareQuantile(1e-3, 2 * kSeeds));
  EXPECT_LT(squares, ChiSquareQuantile(1 - 1e-3, 2 * kSeeds));
  EXPECT_NEAR(late, 1, 0.1);
}

TEST(StopMatch, TwoStopsOfDifferentLengthAreEnough) {
  const std::vector<ToolRest> tool = {
      {kTool, kTool + Duration::Seconds(60)},
      {kTool + Duration::Seconds(400), kTool + Duration::Seconds(520)}};
  std::vector<UtcRest> rig;
  for (const ToolRest& rest : tool)
    rig.push_back({kUtc + (rest.begin - kTool), kUtc + (rest.end - kTool)});
  const Result<StopMatch> match = MatchStops(tool, rig);
  ASSERT_TRUE(match) << match.fault().text;
  EXPECT_NEAR((match->ToUtc(kTool) - kUtc).seconds(), 0, 1e-3);
  EXPECT_GT(match->Sigma(kTool), 0);
  EXPECT_LT(match->Sigma(kTool), 0.1) << "their edges agree exactly";
}

TEST(StopMatch, StopsThatAreAllAlikeAreRefused) {
  std::vector<ToolRest> tool;
  std::vector<UtcRest> rig;
  for (int i = 0; i < 12; ++i) {
    const Duration begin = Duration::Seconds(600 * i), end = Duration::Seconds(600 * i + 120);
    if (i < 11) tool.push_back({kTool + begin, kTool + end});
    rig.push_back({kUtc + begin, kUtc + end});
  }
  const Result<StopMatch> match = MatchStops(tool, rig);
  ASSERT_FALSE(match);
  EXPECT_EQ(match.fault().code, FaultCode::kConflict);
}

TEST(StopMatch, SaysWhyClocksCannotBeJoined) {
  const std::vector<ToolRest> one = {{kTool, kTool + Duration::Seconds(60)}};
  EXPECT_EQ(MatchStops(one, {}).fault().code, FaultCode::kLost);
  const Log log = Stands(6, 0, 0, 1, 3), other = Stands(6, 0, 0, 1, 99);
  const Result<StopMatch> none = MatchStops(log.tool, other.rig);
  ASSERT_FALSE(none);
  StopMatchSetup setup;
  setup.sigma_edge = 0;
  EXPECT_THROW(static_cast<void>(MatchStops(one, {}, setup)), std::invalid_argument);
}

}  // namespace
}  // namespace wellgyro

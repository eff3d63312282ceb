#include "wellgyro/noise/static_log.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "noise/noise_maker.h"

namespace wellgyro {
namespace {

using Kind = LogFinding::Kind;

NoiseCoefficients Tool() {
  NoiseCoefficients truth;
  truth.angle_random_walk = 0.1;
  truth.bias_instability = 0.05;
  truth.rate_random_walk = 0.002;
  return truth;
}

std::vector<double> Quiet(std::uint64_t seed) {
  return test::LogPair(200000, 0.01, Tool(), seed).first;
}

std::vector<LogFinding> Of(const std::vector<LogFinding>& findings, Kind kind) {
  std::vector<LogFinding> found;
  std::copy_if(findings.begin(), findings.end(), std::back_inserter(found),
               [&](const LogFinding& f) { return f.kind == kind; });
  return found;
}

TEST(StaticLog, SaysNothingOfAQuietOne) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const auto findings = InspectStaticLog(Quiet(seed), {});
    EXPECT_TRUE(Of(findings, Kind::kMoved).empty()) << seed;
    EXPECT_TRUE(Of(findings, Kind::kSaturated).empty()) << seed;
    EXPECT_TRUE(Of(findings, Kind::kStuck).empty()) << seed;
  }
}

TEST(StaticLog, SaysNothingOfCoarseCounts) {
  auto rate = Quiet(3);
  for (auto& y : rate) y = std::round(y / 1.5);  // mostly -1, 0, 1
  const auto findings = InspectStaticLog(rate, {});
  EXPECT_TRUE(findings.empty()) << static_cast<int>(findings[0].kind);
}

TEST(StaticLog, TellsWhereItMoved) {
  auto rate = Quiet(1);
  for (std::size_t i = 60000; i < 60300; ++i) rate[i] += 5;    // turned
  for (std::size_t i = 150000; i < 200000; ++i) rate[i] += 1;  // stood differently afterwards
  const auto findings = InspectStaticLog(rate, {});
  auto moved = Of(findings, Kind::kMoved);
  ASSERT_EQ(moved.size(), 1u);
  const auto stepped = Of(findings, Kind::kStep);
  moved.insert(moved.end(), stepped.begin(), stepped.end());
  ASSERT_EQ(moved.size(), 2u);
  EXPECT_LE(moved[0].where.begin, 60000);
  EXPECT_GE(moved[0].where.end, 60300);
  EXPECT_LT(moved[0].where.end - moved[0].where.begin, 1000);
  EXPECT_GT(moved[0].size, 3);
  EXPECT_LE(moved[1].where.begin, 150000);
  EXPECT_GE(moved[1].where.end, 150000);
  EXPECT_LT(moved[1].where.end - moved[1].where.begin, 1000);
}

// 0.3 of noise in a stretch's mean, a step as large as that half-way.
TEST(StaticLog, TellsAStepThatNoNeighboursShow) {
  NoiseCoefficients white;
  white.angle_random_walk = 0.3;
  for (const double size : {2.0, 0.3}) {
    auto rate = test::LogPair(200000, 0.01, white, 11).first;
    for (std::size_t i = 100000; i < rate.size(); ++i) rate[i] += size;
    const auto steps = Of(InspectStaticLog(rate, {}), Kind::kStep);
    ASSERT_EQ(steps.size(), 1u) << size;
    EXPECT_NEAR(static_cast<double>(steps[0].where.begin), 1e5, size > 1 ? 500 : 10000);
    EXPECT_NEAR(steps[0].size, size, 0.06);  // four sigmas of 0.0134
  }
}

TEST(StaticLog, TellsNoStepOfASoundLog) {
  int told = 0, logs = 0;
  for (std::uint64_t seed = 0; seed < 25; ++seed) {
    for (int kind = 0; kind < 4; ++kind) {
      NoiseCoefficients truth;
      truth.angle_random_walk = 0.3;
      if (kind == 1 || kind == 3) truth.rate_random_walk = 0.01;
      if (kind == 2 || kind == 3) truth.bias_instability = kind == 2 ? 1 : 0.1;
      const auto pair = test::LogPair(100000, 0.02, truth, seed);
      for (const auto* rate : {&pair.first, &pair.second}) {
        told += Of(InspectStaticLog(*rate, {}), Kind::kStep).empty() ? 0 : 1;
        ++logs;
      }
    }
  }
  std::printf("sound logs told of a step: %d of %d\n", told, logs);
  EXPECT_LE(told, logs / 100);
}

TEST(StaticLog, TellsWhereItShook) {
  auto rate = Quiet(2);
  for (std::size_t i = 90000; i < 91000; ++i) rate[i] *= 4;
  const auto moved = Of(InspectStaticLog(rate, {}), Kind::kMoved);
  ASSERT_EQ(moved.size(), 1u);
  EXPECT_LE(moved[0].where.begin, 90000);
  EXPECT_GE(moved[0].where.end, 91000);
}

TEST(StaticLog, TellsWhereItSaturated) {
  auto rate = Quiet(4);
  for (std::size_t i = 1000; i < 1200; ++i) rate[i] = 32.767;
  for (std::size_t i = 5000; i < 5004; ++i) rate[i] = 32.767;
  const auto saturated = Of(InspectStaticLog(rate, {}), Kind::kSaturated);
  ASSERT_EQ(saturated.size(), 2u);
  EXPECT_EQ(saturated[0].where.begin, 1000);
  EXPECT_EQ(saturated[0].where.end, 1200);
  EXPECT_EQ(saturated[0].samples, 200);
  EXPECT_EQ(saturated[1].where.begin, 5000);
  StaticLogOptions known;
  known.lowest = -2;
  rate[17] = -2;
  const auto ends = Of(InspectStaticLog(rate, {}, known), Kind::kSaturated);
  EXPECT_GT(ends.size(), 2u);
  EXPECT_TRUE(std::any_of(ends.begin(), ends.end(),
                          [](const LogFinding& f) { return f.where.begin <= 17; }));
}

TEST(StaticLog, TellsWhatStoodStillOrNeverMeasured) {
  auto rate = Quiet(5);
  std::fill(rate.begin() + 7000, rate.begin() + 7200, rate[7000]);
  const auto stuck = Of(InspectStaticLog(rate, {}), Kind::kStuck);
  ASSERT_EQ(stuck.size(), 1u);
  EXPECT_EQ(stuck[0].where.begin, 7000);
  EXPECT_EQ(stuck[0].where.end, 7200);
  const auto constant = InspectStaticLog(std::vector<double>(100, 3.), {});
  ASSERT_EQ(constant.size(), 1u);
  EXPECT_EQ(constant[0].kind, Kind::kConstant);
  EXPECT_EQ(constant[0].size, 3);
}

TEST(StaticLog, TellsADriftWithTemperatureFromOneWithout) {
  auto rate = Quiet(6);
  std::vector<float> temperature(rate.size());
  for (std::size_t i = 0; i < rate.size(); ++i) {
    const double t = 25 + 10 * (1 - std::exp(-static_cast<double>(i) / 40000));
    temperature[i] = static_cast<float>(t);
    rate[i] += 0.3 * (t - 25);
  }
  StaticLogOptions options;
  options.temperature = temperature;
  const auto findings = Of(InspectStaticLog(rate, {}, options), Kind::kTemperature);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_NEAR(*findings[0].per_degree, 0.3, 0.02);
  EXPECT_NEAR(findings[0].size, 3, 0.3);
  EXPECT_LT(findings[0].where.begin, 10000);  // fastest at the start
  auto ramp = Quiet(7);
  for (std::size_t i = 0; i < ramp.size(); ++i) ramp[i] += 1e-5 * static_cast<double>(i);
  const auto drift = Of(InspectStaticLog(ramp, {}), Kind::kDrift);
  ASSERT_EQ(drift.size(), 1u);
  EXPECT_NEAR(drift[0].size, 2, 0.3);
}

TEST(StaticLog, LeavesOutWhatIsMissing) {
  auto rate = Quiet(8);
  std::fill(rate.begin() + 3000, rate.begin() + 4000, 1e9);
  const std::vector<SampleGap> gaps{{3000, 4000}};
  EXPECT_TRUE(InspectStaticLog(rate, gaps).empty());
  EXPECT_TRUE(InspectStaticLog({}, {}).empty());
  EXPECT_TRUE(InspectStaticLog(std::vector<double>{1}, {}).empty());
}

}  // namespace
}  // namespace wellgyro

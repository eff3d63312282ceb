// What is taken out of a log before its noise is looked at.
#include "wellgyro/noise/clean_series.h"

#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "wellgyro/math/random.h"
#include "wellgyro/noise/static_log.h"

namespace wellgyro::test {
namespace {

using Kind = LogFinding::Kind;

SampleSeries White(int n, double sigma, Random& random) {
  SampleSeries series;
  series.period = 0.1;
  for (int i = 0; i < n; ++i) series.values.push_back(sigma * random.Normal());
  return series;
}

TEST(CleanSeries, TimesGiveThePeriodAndWhatIsMissing) {
  SampleSeries series;
  series.values = {0, 1, 2, 3, 4};
  series.temperature = {20, 21, 22, 23, 24};
  const std::vector<double> times = {0, 0.1, 0.2, 0.5, 0.6};
  ASSERT_EQ(PlaceByTime(series, times), std::nullopt);
  EXPECT_NEAR(series.period, 0.1, 1e-12);
  ASSERT_EQ(series.values.size(), 7u);
  EXPECT_EQ(series.values[5], 3);
  ASSERT_EQ(series.gaps.size(), 1u);
  EXPECT_EQ(series.gaps[0].begin, 3);
  EXPECT_EQ(series.gaps[0].end, 5);
  EXPECT_EQ(series.temperature[5], 23);
}

TEST(CleanSeries, TimesThatGoBackOrRunAwayAreRefused) {
  for (const std::vector<double>& times : {std::vector<double>{0, 1, 0.5, 2},
                                           {0, 1, 1, 2},
                                           {3, 2, 1, 0},
                                           {0, 1, 2, 3e6},
                                           {0, 1, 2, 1e12}}) {
    SampleSeries series;
    series.values = {0, 1, 2, 3};
    EXPECT_NE(PlaceByTime(series, times), std::nullopt);
  }
}

// Stamps with a jitter of a tenth of the period, of which single neighbours stand nearer than half
// a period and further than one and a half: no sample is lost, and one that is missing is.
TEST(CleanSeries, JitterOfATenthOfThePeriodLosesNothing) {
  Random random(7);
  std::vector<double> times;
  double nearest = 1;
  for (int i = 0; i < 36000; ++i) {
    if (i == 20000) continue;
    times.push_back(0.1 * i + 0.01 * random.Normal());
    if (times.size() > 1) nearest = std::min(nearest, times.back() - times[times.size() - 2]);
  }
  ASSERT_LT(nearest, 0.05);
  SampleSeries series;
  series.values.assign(times.size(), 1);
  const auto complaint = PlaceByTime(series, times);
  ASSERT_EQ(complaint, std::nullopt) << complaint->text;
  EXPECT_EQ(series.values.size(), 36000u);
  ASSERT_EQ(series.gaps.size(), 1u);
  EXPECT_EQ(series.gaps[0].begin, 20000);
  EXPECT_NEAR(series.period, 0.1, 0.02 / 36000);
}

TEST(CleanSeries, StretchesAreLeftOutOnce) {
  Random random(1);
  SampleSeries series = White(1000, 1, random);
  EXPECT_EQ(Exclude(series, 0, 10), 100);
  EXPECT_EQ(Exclude(series, 5, 20), 150);
  EXPECT_EQ(Exclude(series, 99, 1e9), 10);
  ASSERT_EQ(series.gaps.size(), 2u);
  EXPECT_EQ(series.gaps[0].end, 200);
  EXPECT_EQ(series.gaps[1].begin, 990);
  EXPECT_EQ(series.gaps[1].end, 1000);
}

TEST(CleanSeries, SpikesGoAndNoiseStays) {
  Random random(2);
  SampleSeries series = White(100'000, 1, random);
  EXPECT_EQ(ExcludeSpikes(series), 0);
  for (int i = 500; i < 100'000; i += 1000) series.values[static_cast<std::size_t>(i)] += 30;
  EXPECT_EQ(ExcludeSpikes(series), 100);
  ASSERT_EQ(series.gaps.size(), 100u);
  EXPECT_EQ(series.gaps[3].begin, 3500);
  EXPECT_EQ(series.gaps[3].end, 3501);
}

TEST(CleanSeries, WhatFollowsTheTemperatureIsTakenOff) {
  Random random(3);
  SampleSeries series = White(200'000, 1, random);
  double square = 0;
  for (std::size_t i = 0; i < series.values.size(); ++i) {
    const double T = 60 + 30 * std::sin(3e-5 * static_cast<double>(i));
    series.temperature.push_back(static_cast<float>(T + 0.05 * random.Normal()));
    series.values[i] += 0.7 * (T - 60) + 0.004 * (T - 60) * (T - 60);
  }
  const auto trend = DetrendTemperature(series);
  ASSERT_TRUE(trend.has_value());
  const double slope = 0.7 + 0.008 * (trend->mean - 60);
  EXPECT_NEAR(trend->per_degree, slope, 4 * trend->per_degree_sigma + 1e-3);
  EXPECT_NEAR(trend->per_degree2, 0.004, 2e-4);
  EXPECT_GT(trend->explained, 0.99);
  // Means of ten thousand: noise alone is left, 0.01 each.
  for (int block = 0; block < 20; ++block) {
    double mean = 0;
    for (int i = 0; i < 10'000; ++i) {
      mean += series.values[static_cast<std::size_t>(10'000 * block + i)] / 10'000;
    }
    square += std::pow(mean, 2) / 20;
  }
  double all = 0;
  for (const double value : series.values) all += value / static_cast<double>(series.values.size());
  EXPECT_LT(std::sqrt(square - all * all), 0.03);
  SampleSeries without = White(1000, 1, random);
  EXPECT_FALSE(DetrendTemperature(without).has_value());
}

bool Has(const std::vector<LogFinding>& findings, Kind kind) {
  for (const LogFinding& finding : findings) {
    if (finding.kind == kind) return true;
  }
  return false;
}

TEST(CleanSeries, AStepThatStaysIsNoMovement) {
  Random random(4);
  SampleSeries series = White(100'000, 1, random);
  for (std::size_t i = 40'000; i < series.values.size(); ++i) series.values[i] += 3;
  const auto findings = InspectStaticLog(series.values, {});
  ASSERT_TRUE(Has(findings, Kind::kStep));
  EXPECT_FALSE(Has(findings, Kind::kMoved));
  for (const LogFinding& finding : findings) {
    if (finding.kind != Kind::kStep) continue;
    EXPECT_NEAR(finding.size, 3, 0.2);
    EXPECT_LE(finding.where.begin, 40'000);
    EXPECT_GE(finding.where.end, 40'000);
  }
}

TEST(CleanSeries, AWarmUpIsToldWithItsTimeConstant) {
  Random random(5);
  SampleSeries series = White(200'000, 1, random);
  for (std::size_t i = 0; i < series.values.size(); ++i) {
    series.values[i] += 5 * std::exp(-static_cast<double>(i) / 20'000);
  }
  const auto findings = InspectStaticLog(series.values, {});
  ASSERT_TRUE(Has(findings, Kind::kWarmUp));
  EXPECT_FALSE(Has(findings, Kind::kDrift));
  for (const LogFinding& finding : findings) {
    if (finding.kind == Kind::kWarmUp) {
      EXPECT_NEAR(*finding.time_constant, 20'000, 4'000);
    }
  }
  SampleSeries drifting = White(200'000, 1, random);
  for (std::size_t i = 0; i < drifting.values.size(); ++i) {
    drifting.values[i] += 2e-5 * static_cast<double>(i);
  }
  const auto drift = InspectStaticLog(drifting.values, {});
  EXPECT_TRUE(Has(drift, Kind::kDrift));
  EXPECT_FALSE(Has(drift, Kind::kWarmUp));
}

}  // namespace
}  // namespace wellgyro::test

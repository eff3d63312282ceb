#include "wellgyro/noise/allan_variance.h"

#include <array>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "wellgyro/math/random.h"

namespace wellgyro {
namespace {

std::vector<double> White(std::int64_t samples, std::uint64_t seed, double bias = 0) {
  Random random(seed);
  std::vector<double> rate(static_cast<std::size_t>(samples));
  for (auto& y : rate) y = bias + random.Normal();
  return rate;
}

struct Slow {
  std::int64_t terms = 0;
  long double variance = 0;
};

// The definition in SP 1065, term by term, in long double; a term with a missing sample is left
// out.
Slow ByDefinition(std::span<const double> rate, std::int64_t m, Deviation deviation,
                  const std::vector<bool>& missing = {}) {
  const auto samples = static_cast<std::int64_t>(rate.size());
  std::vector<long double> x(rate.size() + 1, 0);
  std::vector<int> lost(rate.size() + 1, 0);
  for (std::size_t i = 0; i < rate.size(); ++i) {
    const bool out = !missing.empty() && missing[i];
    x[i + 1] = x[i] + (out ? 0.L : static_cast<long double>(rate[i]) - rate[0]);
    lost[i + 1] = lost[i] + out;
  }
  const auto at = [&](std::int64_t n) { return x[static_cast<std::size_t>(n)]; };
  const auto lost_at = [&](std::int64_t n) { return lost[static_cast<std::size_t>(n)]; };
  const bool modified = deviation == Deviation::kModified;
  const std::int64_t window = modified ? 3 * m - 1 : 2 * m;
  Slow slow;
  for (std::int64_t k = 0; k + window <= samples; k += deviation == Deviation::kAllan ? m : 1) {
    if (lost_at(k + window) != lost_at(k)) continue;
    long double d = 0;
    for (std::int64_t i = k; i < k + (modified ? m : 1); ++i) {
      d += at(i + 2 * m) - 2 * at(i + m) + at(i);
    }
    slow.variance += d * d;
    ++slow.terms;
  }
  const auto scale = static_cast<long double>(m) * (modified ? m : 1);
  if (slow.terms > 0) slow.variance /= 2 * scale * scale * slow.terms;
  return slow;
}

TEST(AllanVariance, IsItsDefinitionAtEveryLengthAndFactor) {
  for (const std::int64_t samples :
       {1, 2, 3, 7, 8, 64, 1000, 2048, 8191, 8192, 8193, 16384, 18001}) {
    const auto rate = White(samples, static_cast<std::uint64_t>(samples), 3);
    std::vector<std::int64_t> factors{1,   2,    3,    4,    5,    8,    13,  100,
                                      512, 1000, 4095, 4096, 4097, 8192, 9000};
    for (const auto deviation : {Deviation::kAllan, Deviation::kOverlapped, Deviation::kModified}) {
      AllanOptions options;
      options.deviation = deviation;
      const auto result = AllanVariance(rate, 0.5, factors, options);
      ASSERT_EQ(result.points.size(), factors.size());
      for (const auto& point : result.points) {
        const Slow slow = ByDefinition(rate, point.factor, deviation);
        EXPECT_EQ(point.terms, slow.terms) << samples << " " << point.factor;
        EXPECT_DOUBLE_EQ(point.tau, 0.5 * static_cast<double>(point.factor));
        if (slow.terms == 0) {
          EXPECT_EQ(point.variance, 0);
        } else {
          EXPECT_NEAR(point.variance / static_cast<double>(slow.variance), 1, 1e-12)
              << samples << " " << point.factor;
        }
      }
    }
  }
}

TEST(AllanVariance, OctavesTakenTogetherEqualOctavesTakenSingly) {
  const auto rate = White(50000, 11);
  const auto octaves = OctaveFactors(50000);
  const auto together = AllanVariance(rate, 1, octaves).points;
  for (std::size_t i = 0; i < octaves.size(); ++i) {
    const auto alone = AllanVariance(rate, 1, std::array{octaves[i]}).points.at(0);
    const Slow slow = ByDefinition(rate, octaves[i], Deviation::kOverlapped);
    EXPECT_EQ(together[i].terms, alone.terms);
    EXPECT_DOUBLE_EQ(together[i].variance, alone.variance);
    EXPECT_NEAR(together[i].variance / static_cast<double>(slow.variance), 1, 1e-13);
  }
}

// A lag that left the ring of phases is made again from the rates, aligned to blocks or not.
TEST(AllanVariance, ReachesBackFurtherThanItsRing) {
  constexpr std::int64_t kSamples = 2'700'000;
  const auto rate = White(kSamples, 12, 1e3);
  std::vector<long double> x(rate.size() + 1, 0);
  for (std::size_t i = 0; i < rate.size(); ++i) x[i + 1] = x[i] + (rate[i] - 1e3L);
  const std::vector<std::int64_t> factors{1, 2, 1024, 524288, 1048576, 700001, 1300000};
  for (const auto& point : AllanVariance(rate, 1, factors).points) {
    const auto m = static_cast<std::size_t>(point.factor);
    long double squares = 0;
    for (std::size_t n = 2 * m; n < x.size(); ++n) {
      const long double d = x[n] - 2 * x[n - m] + x[n - 2 * m];
      squares += d * d;
    }
    const auto terms = static_cast<long double>(x.size() - 2 * m);
    const auto exact =
        static_cast<double>(squares / (2.L * static_cast<long double>(m * m) * terms));
    EXPECT_EQ(point.terms, static_cast<std::int64_t>(x.size() - 2 * m));
    EXPECT_NEAR(point.variance / exact, 1, 1e-12) << m;
  }
}

TEST(AllanVariance, BiasAndFastDriftDoNotSpoilShortTimes) {
  auto rate = White(100000, 13, 1e6);
  for (std::size_t i = 0; i < rate.size(); ++i) rate[i] += 10. * static_cast<double>(i);
  for (const auto& point : AllanVariance(rate, 1, OctaveFactors(100000)).points) {
    const Slow slow = ByDefinition(rate, point.factor, Deviation::kOverlapped);
    EXPECT_NEAR(point.variance / static_cast<double>(slow.variance), 1, 1e-10) << point.factor;
  }
}

TEST(AllanVariance, NamesWhatIsNotFiniteAndLosesOnlyThat) {
  auto rate = White(5000, 14, 100);
  std::vector<bool> missing(rate.size(), false);
  for (const std::size_t i : {0u, 1234u, 1235u, 4999u}) {
    rate[i] = i == 1235 ? -std::numeric_limits<double>::infinity() : std::nan("");
    missing[i] = true;
  }
  auto zeroed = rate;
  for (std::size_t i = 0; i < rate.size(); ++i) {
    if (missing[i]) zeroed[i] = 0;
  }
  for (const auto deviation : {Deviation::kAllan, Deviation::kOverlapped, Deviation::kModified}) {
    AllanOptions options;
    options.deviation = deviation;
    options.max_missing = 0;
    const auto result = AllanVariance(rate, 1, OctaveFactors(5000), options);
    ASSERT_EQ(result.not_finite.size(), 3u);
    EXPECT_EQ(result.not_finite[0].begin, 0);
    EXPECT_EQ(result.not_finite[1].begin, 1234);
    EXPECT_EQ(result.not_finite[1].end, 1236);
    EXPECT_EQ(result.not_finite[2].end, 5000);
    EXPECT_EQ(result.missing, 4);
    for (const auto& point : result.points) {
      const Slow slow = ByDefinition(zeroed, point.factor, deviation, missing);
      EXPECT_EQ(point.terms, slow.terms) << point.factor;
      if (slow.terms > 0) {
        EXPECT_NEAR(point.variance / static_cast<double>(slow.variance), 1, 1e-12) << point.factor;
      }
    }
  }
}

TEST(AllanVariance, GapsTakeAwayTheDifferencesTheyTouch) {
  const auto rate = White(20000, 15, -7);
  const std::vector<SampleGap> gaps{
      {100, 101}, {110, 140}, {2040, 2060}, {9000, 12000}, {19990, 20050}};
  std::vector<bool> missing(rate.size(), false);
  for (const auto& gap : gaps) {
    for (auto i = gap.begin; i < std::min<std::int64_t>(gap.end, 20000); ++i) {
      missing[static_cast<std::size_t>(i)] = true;
    }
  }
  AllanOptions options;
  options.max_missing = 0;
  const auto result = AllanVariance(rate, 1, OctaveFactors(20000), options, gaps);
  EXPECT_EQ(result.missing, 1 + 30 + 20 + 3000 + 10);
  for (const auto& point : result.points) {
    const Slow slow = ByDefinition(rate, point.factor, Deviation::kOverlapped, missing);
    EXPECT_EQ(point.terms, slow.terms) << point.factor;
    if (slow.terms > 0) {
      EXPECT_NEAR(point.variance / static_cast<double>(slow.variance), 1, 1e-12) << point.factor;
    }
  }
}

// With 0.5 % lost here and there no long difference is whole; bridged, they keep their variance.
TEST(AllanVariance, BridgesSmallGapsInLongDifferences) {
  constexpr std::int64_t kSamples = 1 << 20;
  const auto rate = White(kSamples, 16);
  std::vector<SampleGap> gaps;
  for (std::int64_t at = 500; at < kSamples; at += 4000) gaps.push_back({at, at + 20});
  AllanOptions whole;
  whole.max_missing = 0;
  const std::vector<std::int64_t> factors{16, 4096, 16384};
  const auto strict = AllanVariance(rate, 1, factors, whole, gaps).points;
  const auto bridged = AllanVariance(rate, 1, factors, {}, gaps).points;
  EXPECT_EQ(strict[1].terms, 0);
  EXPECT_EQ(strict[0].terms, bridged[0].terms);
  EXPECT_EQ(bridged[2].terms, kSamples - 2 * 16384 + 1);
  const auto full = AllanVariance(rate, 1, factors).points;
  EXPECT_NEAR(bridged[2].variance / full[2].variance, 1.005, 0.03);
  EXPECT_NE(bridged[2].variance, full[2].variance);
}

TEST(AllanVariance, AnEmptyLogAndAllGoneAreNoAccident) {
  EXPECT_EQ(AllanVariance({}, 1, std::array<std::int64_t, 1>{1}).points.at(0).terms, 0);
  const std::vector<double> nothing(100, std::nan(""));
  const auto result = AllanVariance(nothing, 1, OctaveFactors(100));
  EXPECT_EQ(result.missing, 100);
  for (const auto& point : result.points) EXPECT_EQ(point.terms, 0);
  std::vector<double> huge(100, 1e300);
  for (std::size_t i = 0; i < huge.size(); i += 2) huge[i] = -1e300;
  EXPECT_EQ(AllanVariance(huge, 1, OctaveFactors(100)).missing, 100);
}

TEST(AllanVariance, RefusesWhatMakesNoSense) {
  const std::vector<double> rate(10, 1);
  EXPECT_THROW(AllanVariance(rate, 0, std::array<std::int64_t, 1>{1}), std::invalid_argument);
  EXPECT_THROW(AllanVariance(rate, 1, std::array<std::int64_t, 1>{0}), std::invalid_argument);
  const std::array gaps{SampleGap{5, 7}, SampleGap{6, 8}};
  EXPECT_THROW(AllanVariance(rate, 1, std::array<std::int64_t, 1>{1}, {}, gaps),
               std::invalid_argument);
  EXPECT_EQ(AllanVariance(rate, 1, std::array{std::int64_t{1} << 62}).points.at(0).terms, 0);
}

TEST(AveragingFactors, ReachToHalfTheLog) {
  EXPECT_TRUE(OctaveFactors(1).empty());
  EXPECT_EQ(OctaveFactors(1024).back(), 512);
  EXPECT_EQ(OctaveFactors(1023).back(), 256);
  const auto decades = DecadeFactors(1000);
  EXPECT_EQ(decades.size(), 9u + 9 + 5);
  EXPECT_EQ(decades.back(), 500);
  EXPECT_EQ(FactorsOf(std::array{10., 0.011, 0.009, 1e9}, 0.01, 5000),
            (std::vector<std::int64_t>{1, 1000}));
  EXPECT_THROW(FactorsOf(std::array{-1.}, 0.01, 5000), std::invalid_argument);
}

}  // namespace
}  // namespace wellgyro

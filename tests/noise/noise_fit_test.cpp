#include "wellgyro/noise/noise_fit.h"

#include <array>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "noise/noise_maker.h"

namespace wellgyro {
namespace {

AllanResult Octaves(std::span<const double> rate, double period) {
  return AllanVariance(rate, period, OctaveFactors(static_cast<std::int64_t>(rate.size())));
}

// Eight logs of 2^18 samples; the thousand of a million each are in allan_long_test.cpp.
TEST(FitNoise, SaysOfWhiteNoiseThatNothingElseIsSeen) {
  NoiseCoefficients truth;
  truth.angle_random_walk = 0.6;
  int seen = 0;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const auto logs = test::LogPair(1 << 18, 0.01, truth, seed);
    for (const auto* log : {&logs.first, &logs.second}) {
      const auto fit = FitNoise(Octaves(*log, 0.01));
      ASSERT_TRUE(fit);
      const auto& n = fit->term[NoiseTerm::kAngleRandomWalk];
      ASSERT_TRUE(n.observable);
      EXPECT_NEAR(n.value / 0.6, 1, 0.01);
      EXPECT_NEAR(n.sigma / 0.6, 0.0019, 0.001);  // about 1/sqrt(2 M) and what terms it mixes with
      for (const auto term : {NoiseTerm::kQuantization, NoiseTerm::kBiasInstability,
                              NoiseTerm::kRateRandomWalk, NoiseTerm::kRateRamp}) {
        const auto& other = fit->term[term];
        seen += other.observable;
        if (!other.observable) {
          EXPECT_EQ(other.value, 0);
          EXPECT_GT(other.upper95, 0);
          EXPECT_TRUE(std::isfinite(other.upper95));
        }
      }
      EXPECT_EQ(fit->term[NoiseTerm::kSinusoid].upper95, 0);
    }
  }
  // 32 questions at one false yes in twenty: more than 7 has a chance of 1.4e-4.
  EXPECT_LE(seen, 7);
}

TEST(FitNoise, FindsEveryTermThatIsStrong) {
  NoiseCoefficients truth;
  truth.quantization = 0.02;
  truth.angle_random_walk = 0.1;
  truth.bias_instability = 0.2;
  truth.rate_random_walk = 0.08;
  int inside = 0;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const auto logs = test::LogPair(1 << 18, 0.01, truth, 100 + seed);
    for (const auto* log : {&logs.first, &logs.second}) {
      const auto fit = FitNoise(Octaves(*log, 0.01));
      ASSERT_TRUE(fit);
      const auto check = [&](NoiseTerm term, double value, double relative) {
        const auto& found = fit->term[term];
        EXPECT_TRUE(found.observable) << static_cast<int>(term);
        EXPECT_NEAR(found.value / value, 1, relative) << static_cast<int>(term);
        EXPECT_LE(found.lower95, found.value);
        EXPECT_GE(found.upper95, found.value);
        inside += found.lower95 <= value && value <= found.upper95;
      };
      check(NoiseTerm::kQuantization, 0.02, 0.01);
      check(NoiseTerm::kAngleRandomWalk, 0.1, 0.05);
      check(NoiseTerm::kBiasInstability, 0.2, 0.4);
      check(NoiseTerm::kRateRandomWalk, 0.08, 0.5);
      const NoiseCoefficients c = CoefficientsOf(*fit);
      EXPECT_EQ(c.bias_instability, fit->term[NoiseTerm::kBiasInstability].value);
      EXPECT_FALSE(c.bias_instability_correlation_time);
    }
  }
  EXPECT_GE(inside, 25);  // of 32 at 0.95: fewer has a chance of 1.4e-4
}

TEST(FitNoise, ARampThatIsThereIsSeen) {
  NoiseCoefficients truth;
  truth.angle_random_walk = 0.1;
  truth.rate_ramp = 1e-3;
  const auto logs = test::LogPair(1 << 18, 0.01, truth, 7);
  const auto fit = FitNoise(Octaves(logs.first, 0.01));
  ASSERT_TRUE(fit);
  ASSERT_TRUE(fit->term[NoiseTerm::kRateRamp].observable);
  EXPECT_NEAR(fit->term[NoiseTerm::kRateRamp].value / 1e-3, 1, 0.02);
}

TEST(FitNoise, FitsBiasInstabilityAsGaussMarkov) {
  constexpr double kTime = 20;
  constexpr double kPeriod = 0.05;
  constexpr double kB = 0.2;
  Random random(4);
  std::vector<double> rate(1 << 19);
  constexpr double kSigma = 1.076 * kB;
  double state = kSigma * random.Normal();
  const double keep = std::exp(-kPeriod / kTime);
  for (auto& y : rate) {
    y = state + 0.1 / std::sqrt(kPeriod) * random.Normal();
    state = keep * state + kSigma * std::sqrt(1 - keep * keep) * random.Normal();
  }
  NoiseFitOptions options;
  options.gauss_markov = true;
  options.replicates = 60;
  const auto fit = FitNoise(Octaves(rate, kPeriod), options);
  ASSERT_TRUE(fit);
  const auto c = CoefficientsOf(*fit);
  ASSERT_TRUE(c.bias_instability_correlation_time);
  ASSERT_TRUE(fit->sigma_correlation_time);
  EXPECT_NEAR(*c.bias_instability_correlation_time, kTime, 4 * *fit->sigma_correlation_time);
  EXPECT_LT(*fit->sigma_correlation_time, 3);
  EXPECT_NEAR(c.bias_instability, kB, 4 * fit->term[NoiseTerm::kBiasInstability].sigma);
  EXPECT_LT(fit->term[NoiseTerm::kBiasInstability].sigma, 0.02);
  EXPECT_NEAR(c.angle_random_walk, 0.1, 0.001);
}

TEST(FitNoise, FitsASinusoidOfKnownFrequency) {
  constexpr double kPeriod = 0.01;
  constexpr double kFrequency = 0.37;
  Random random(8);
  std::vector<double> rate(200000);
  for (std::size_t i = 0; i < rate.size(); ++i) {
    rate[i] = 0.6 / std::sqrt(kPeriod) * random.Normal() +
              2 * std::sin(2 * std::numbers::pi * kFrequency * kPeriod * static_cast<double>(i));
  }
  NoiseFitOptions options;
  options.sinusoid_frequency = kFrequency;
  options.replicates = 60;
  const auto fit = FitNoise(Octaves(rate, kPeriod), options);
  ASSERT_TRUE(fit);
  ASSERT_TRUE(fit->term[NoiseTerm::kSinusoid].observable);
  EXPECT_NEAR(fit->term[NoiseTerm::kSinusoid].value, 2, 0.05);
  EXPECT_NEAR(fit->term[NoiseTerm::kAngleRandomWalk].value, 0.6, 0.01);
}

TEST(FitNoise, IsTheSameEachTimeAndInEveryUnit) {
  NoiseCoefficients truth;
  truth.angle_random_walk = 0.6;
  truth.bias_instability = 0.3;
  auto log = test::LogPair(1 << 15, 0.01, truth, 3).first;
  const auto a = FitNoise(Octaves(log, 0.01));
  const auto again = FitNoise(Octaves(log, 0.01));
  for (auto& y : log) y *= 0x1p-20;
  const auto scaled = FitNoise(Octaves(log, 0.01));
  ASSERT_TRUE(a && again && scaled);
  for (const auto term : kAllNoiseTerms) {
    EXPECT_EQ(a->term[term].value, again->term[term].value);
    EXPECT_EQ(a->term[term].sigma, again->term[term].sigma);
    EXPECT_EQ(a->term[term].observable, scaled->term[term].observable);
    EXPECT_NEAR(a->term[term].value * 0x1p-20, scaled->term[term].value,
                1e-9 * scaled->term[term].value);
    EXPECT_NEAR(a->term[term].upper95 * 0x1p-20, scaled->term[term].upper95,
                1e-6 * scaled->term[term].upper95);
  }
}

TEST(FitNoise, SaysWhenThereIsNothingToFit) {
  const auto constant = FitNoise(Octaves(std::vector<double>(1000, 7), 1));
  ASSERT_FALSE(constant);
  EXPECT_EQ(constant.fault().code, FaultCode::kRange);
  EXPECT_FALSE(FitNoise(Octaves(std::vector<double>{1, 2, 3}, 1)));
  EXPECT_FALSE(FitNoise(Octaves({}, 1)));
  const std::vector<double> rate{1, 2, 1, 3, 2, 4, 2, 1, 0, 1, 4, 2};
  EXPECT_THROW(static_cast<void>(FitNoise(AllanVariance(rate, 1, DecadeFactors(12)))),
               std::invalid_argument);
}

}  // namespace
}  // namespace wellgyro

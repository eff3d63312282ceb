#include "wellgyro/simulate/rate_noise.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/math/statistics.h"
#include "wellgyro/simulate/random_stream.h"
#include "wellgyro/simulate/tool_errors.h"

namespace wellgyro {
namespace {

constexpr int kTools = 4000;

// Of `n` independent values of zero mean and variance `expected`, at 1e-5 on either side.
void ExpectVariance(double sum_of_squares, int n, double expected, const char* what) {
  const double chi2 = sum_of_squares / expected;
  EXPECT_GT(chi2, ChiSquareQuantile(1e-5, n)) << what;
  EXPECT_LT(chi2, ChiSquareQuantile(1 - 1e-5, n)) << what;
}

// Half the squared difference of two neighbouring means over tau, one pair a tool, each mean made
// of `parts` samples: twice its expectation over tools is the Allan variance.
double SumOfSquares(const NoiseCoefficients& noise, bool flicker, double tau, int parts,
                    double settle = 0) {
  double sum = 0;
  for (int tool = 0; tool < kTools; ++tool) {
    RateNoise rate(noise, flicker, 4711, static_cast<std::uint64_t>(tool));
    if (settle > 0) rate.Mean(settle);
    double mean[2] = {0, 0};
    for (double& m : mean) {
      for (int i = 0; i < parts; ++i) m += rate.Mean(tau / parts) / parts;
    }
    sum += (mean[1] - mean[0]) * (mean[1] - mean[0]) / 2;
  }
  return sum;
}

TEST(RateNoise, WhiteHasTheAllanVarianceOfN) {
  const NoiseCoefficients noise{.angle_random_walk = 3e-6};
  for (const double tau : {0.01, 1.0, 300.0}) {
    for (const int parts : {1, 7}) {
      ExpectVariance(SumOfSquares(noise, false, tau, parts), kTools, 9e-12 / tau, "N");
    }
  }
}

TEST(RateNoise, WalkHasTheAllanVarianceOfK) {
  const NoiseCoefficients noise{.rate_random_walk = 2e-8};
  for (const double tau : {0.01, 10.0, 1000.0}) {
    for (const int parts : {1, 7}) {
      ExpectVariance(SumOfSquares(noise, false, tau, parts, 5), kTools, 4e-16 * tau / 3, "K");
    }
  }
}

TEST(RateNoise, RampHasTheAllanVarianceOfR) {
  const NoiseCoefficients noise{.rate_ramp = 1e-9};
  for (const double tau : {1.0, 500.0}) {
    // Every ramp is R or -R, so this is exact.
    EXPECT_NEAR(SumOfSquares(noise, false, tau, 3) / kTools, 1e-18 * tau * tau / 2,
                1e-12 * 1e-18 * tau * tau);
  }
}

TEST(RateNoise, GaussMarkovHasItsAllanVariance) {
  const double b = 1e-7, tc = 200, sigma = 1.075 * b;
  const NoiseCoefficients noise{.bias_instability = b, .bias_instability_correlation_time = tc};
  for (const double tau : {1.0, 50.0, 378.0, 3000.0}) {
    const double x = tau / tc;
    // Of the integral of the autocorrelation exp(-|t|/Tc); the bracket cancels for small x.
    const long double y = x;
    const long double bracket = 1 - (3 - 4 * std::exp(-y) + std::exp(-2 * y)) / (2 * y);
    const double expected = static_cast<double>(2 * sigma * sigma * bracket / y);
    for (const int parts : {1, 9}) {
      ExpectVariance(SumOfSquares(noise, false, tau, parts, 1), kTools, expected, "B, Tc");
    }
  }
  // Its greatest Allan deviation is the floor of flicker of the same B.
  const double x = 1.89;
  const double peak = std::sqrt(2 / x * (1 - (3 - 4 * std::exp(-x) + std::exp(-2 * x)) / (2 * x)));
  EXPECT_NEAR(1.075 * peak, std::sqrt(2 * std::log(2) / kPi), 1e-3);
}

TEST(RateNoise, FlickerIsAllanFlatAtTheFloorOfB) {
  const double b = 1e-7, floor = 2 * std::log(2) / kPi * b * b;
  const NoiseCoefficients noise{.bias_instability = b};
  for (const double tau : {4.0, 30.0, 500.0, 8000.0, 1e5}) {
    // The mean over the tools has a sigma of 2.2 per cent; a tenth process short is 4.
    EXPECT_NEAR(SumOfSquares(noise, true, tau, 1) / kTools / floor, 1, 0.09) << tau;
  }
}

TEST(RateNoise, ConstantBIsDrawnAndStays) {
  const NoiseCoefficients noise{.bias_instability = 5e-7};
  double sum = 0;
  for (int tool = 0; tool < kTools; ++tool) {
    RateNoise rate(noise, false, 1, static_cast<std::uint64_t>(tool));
    const double first = rate.Mean(0.01);
    EXPECT_EQ(rate.Mean(100), first);
    sum += first * first;
  }
  ExpectVariance(sum, kTools, 25e-14, "B");
}

TEST(RateNoise, OneMoreErrorLeavesTheDrawsOfTheOthers) {
  RateNoise white({.angle_random_walk = 1e-6}, false, 9, 2);
  RateNoise both({.angle_random_walk = 1e-6, .rate_random_walk = 1e-9}, false, 9, 2);
  RateNoise walk({.rate_random_walk = 1e-9}, false, 9, 2);
  for (int i = 0; i < 100; ++i) {
    const double sum = white.Mean(0.1) + walk.Mean(0.1);
    EXPECT_NEAR(both.Mean(0.1), sum, 1e-20);
  }
}

TEST(Quantizer, HasTheAllanVarianceOfQ) {
  // Error of a counter under a rate that moves over many steps between samples.
  const double step = 5e-6, q = step / std::sqrt(12.0), tau = 0.5;
  const int n = 20000;
  Quantizer quantizer(step);
  Random random(3);
  double sum = 0, last = 0;
  std::vector<double> error;
  for (int i = 0; i < n; ++i) {
    const double rate = 1e-3 * random.Normal();
    error.push_back(quantizer.Mean(rate, tau) - rate);
  }
  // Differences three samples apart share no rounding.
  int pairs = 0;
  for (std::size_t i = 1; i < error.size(); i += 3, ++pairs) {
    last = error[i] - error[i - 1];
    sum += last * last / 2;
  }
  // The kurtosis of a second difference of uniform errors is below normal: the band is wide enough.
  ExpectVariance(sum, pairs, 3 * q * q / (tau * tau), "Q");
}

TEST(Quantizer, LosesNothingInTheSum) {
  const double step = 1e-3;
  Quantizer quantizer(step);
  double sum = 0;
  for (int i = 0; i < 1000; ++i) {
    const double counted = quantizer.Mean(0.01234567, 0.01) * 0.01;
    EXPECT_NEAR(std::remainder(counted, step), 0, 1e-15);
    sum += counted;
    EXPECT_NEAR(sum, 0.01234567 * 0.01 * (i + 1), step / 2 + 1e-12);
  }
  EXPECT_EQ(Quantizer(0).Mean(0.1234, 0.7), 0.1234);
}

TEST(RandomStream, StreamsDifferAndRepeat) {
  EXPECT_EQ(RandomStream(5, 1).Bits(), RandomStream(5, 1).Bits());
  double product = 0;
  Random a = RandomStream(5, 1), b = RandomStream(5, 2);
  for (int i = 0; i < 100000; ++i) product += a.Normal() * b.Normal();
  EXPECT_LT(std::abs(product), 4 * std::sqrt(100000));
  EXPECT_NE(RandomStream(5, 1).Bits(), RandomStream(6, 1).Bits());
}

}  // namespace
}  // namespace wellgyro

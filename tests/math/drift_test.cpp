#include "wellgyro/math/drift.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"

namespace wellgyro {
namespace {

// Every process on, of like size over the times tried.
DriftCoefficients AllTerms() {
  return {.angle_random_walk = 0.3,
          .constant = 0.5,
          .bias_instability = 0.7,
          .correlation_time = 40.0,
          .rate_random_walk = 0.11,
          .rate_ramp = 0.013};
}

// The integral's covariance by quadrature of the rates' covariance functions, the definition:
//   Var = gain^2 sum over pairs of times of E[w(t) w(s)], which knows no state space.
double IntegralVarianceByQuadrature(const DriftCoefficients& c, double gain, double seconds) {
  const int n = 2000;
  const double h = seconds / n;
  const double markov = kMarkovSigmaPerInstability * c.bias_instability;
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const double t = (i + 0.5) * h, s = (j + 0.5) * h;
      sum += c.constant * c.constant + c.rate_ramp * c.rate_ramp * t * s +
             c.rate_random_walk * c.rate_random_walk * std::min(t, s) +
             markov * markov * std::exp(-std::abs(t - s) / *c.correlation_time);
    }
  }
  return gain * gain * (sum * h * h + c.angle_random_walk * c.angle_random_walk * seconds);
}

TEST(Drift, VarianceOfTheIntegralIsThatOfTheCovarianceFunctions) {
  for (const double seconds : {1.0, 30.0, 200.0}) {
    const DriftStep step = DriftOver(AllTerms(), -1.7, seconds);
    const Eigen::Matrix4d p =
        step.transition * DriftPrior(AllTerms()) * step.transition.transpose() + step.noise;
    const double expected = IntegralVarianceByQuadrature(AllTerms(), -1.7, seconds);
    // Mid-point quadrature of kinks along the diagonal: a relative error of some 1/n.
    EXPECT_NEAR(p(0, 0), expected, 1e-3 * expected) << seconds;
  }
}

TEST(Drift, ManySmallStepsAreOneLargeStep) {
  const double seconds = 100;
  for (const int n : {2, 7, 1000}) {
    Eigen::Matrix4d f = Eigen::Matrix4d::Identity(), q = Eigen::Matrix4d::Zero();
    for (int i = 0; i < n; ++i) {
      const DriftStep part = DriftOver(AllTerms(), 0.8, seconds / n);
      f = part.transition * f;
      q = part.transition * q * part.transition.transpose() + part.noise;
    }
    const DriftStep whole = DriftOver(AllTerms(), 0.8, seconds);
    EXPECT_LT((f - whole.transition).norm(), 1e-11 * whole.transition.norm()) << n;
    EXPECT_LT((q - whole.noise).norm(), 1e-11 * whole.noise.norm()) << n;
  }
}

// In long double straight from the formula, where the cancelling costs nothing that matters.
TEST(Drift, MarkovIntegralKeepsItsDigitsForShortSteps) {
  DriftCoefficients c;
  c.bias_instability = 1 / kMarkovSigmaPerInstability;
  c.correlation_time = 1;
  for (const double x : {1e-4, 1e-3, 1e-2, 0.1, 0.49, 0.51, 3.0, 40.0}) {
    const long double e = std::expm1(-static_cast<long double>(x));
    long double expected = 2 * static_cast<long double>(x) + 2 * e - e * e;
    if (x < 5e-3) {
      const long double y = x;
      expected = y * y * y *
                 (2.0L / 3 - y / 2 + 7 * y * y / 30 - y * y * y / 12 + 31 * y * y * y * y / 1260);
    }
    EXPECT_NEAR(DriftOver(c, 1, x).noise(0, 0), static_cast<double>(expected),
                2e-13 * static_cast<double>(expected))
        << x;
  }
}

TEST(Drift, MarkovSigmaMatchesTheFlickerFloor) {
  // Allan variance of a Gauss-Markov process of unit sigma and correlation time, IEEE 952 C.1.5.
  double highest = 0, where = 0;
  for (double x = 1; x < 3; x += 1e-4) {
    const double avar = 2 / x * (1 - (3 - 4 * std::exp(-x) + std::exp(-2 * x)) / (2 * x));
    if (avar > highest) {
      highest = avar;
      where = x;
    }
  }
  const double floor = std::sqrt(2 * std::log(2.0) / kPi);
  EXPECT_NEAR(kMarkovSigmaPerInstability * std::sqrt(highest), floor, 2e-4 * floor);
  EXPECT_NEAR(where, 1.89, 0.005);
}

TEST(Drift, TheMarkovProcessIsStationary) {
  const DriftStep step = DriftOver(AllTerms(), 1, 17);
  const Eigen::Matrix4d prior = DriftPrior(AllTerms());
  const double f = step.transition(kDriftMarkov, kDriftMarkov);
  EXPECT_NEAR(f * f * prior(kDriftMarkov, kDriftMarkov) + step.noise(kDriftMarkov, kDriftMarkov),
              prior(kDriftMarkov, kDriftMarkov), 1e-15);
  EXPECT_NEAR(prior(kDriftLevel, kDriftLevel), 0.25, 1e-15);
}

TEST(Drift, WithoutACorrelationTimeTheInstabilityIsAConstant) {
  DriftCoefficients c;
  c.constant = 3;
  c.bias_instability = 4;
  const DriftStep step = DriftOver(c, 2, 10);
  const Eigen::Matrix4d p = step.transition * DriftPrior(c) * step.transition.transpose();
  EXPECT_NEAR(p(0, 0), 25 * 400, 1e-9);
  EXPECT_EQ(step.noise.norm(), 0);
}

TEST(Drift, ImpossibleStepsAreTheCallersMistake) {
  EXPECT_THROW(DriftOver(AllTerms(), 1, -1), std::domain_error);
  DriftCoefficients c;
  c.correlation_time = 0;
  EXPECT_THROW(DriftOver(c, 1, 1), std::domain_error);
}

}  // namespace
}  // namespace wellgyro

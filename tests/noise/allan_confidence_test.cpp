#include "wellgyro/noise/allan_confidence.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/math/statistics.h"

#include "noise/noise_maker.h"

namespace wellgyro {
namespace {

// The exact answer for a short log: with S the covariance of the differences, the mean of their
// squares has mean tr S/n and variance 2 tr S^2/n^2.
struct ExactLog {
  Eigen::MatrixXd cov_rate;  // of successive mean rates, period 1

  static ExactLog White(Eigen::Index samples) {
    return {Eigen::MatrixXd::Identity(samples, samples)};
  }
  // Means of a Wiener process: E[W_i W_j] integrated over both periods.
  static ExactLog Walk(Eigen::Index samples) {
    ExactLog log{Eigen::MatrixXd(samples, samples)};
    for (Eigen::Index i = 0; i < samples; ++i) {
      for (Eigen::Index j = 0; j < samples; ++j) {
        const auto first = static_cast<double>(std::min(i, j));
        log.cov_rate(i, j) = first + (i == j ? 1 / 3. : 0.5);
      }
    }
    return log;
  }
  // First differences of a white angle.
  static ExactLog WhiteAngle(Eigen::Index samples) {
    ExactLog log{2 * Eigen::MatrixXd::Identity(samples, samples)};
    for (Eigen::Index i = 1; i < samples; ++i) log.cov_rate(i, i - 1) = log.cov_rate(i - 1, i) = -1;
    return log;
  }

  // Rows: the differences of neighbouring averages (times m, or m^2 when modified).
  Eigen::MatrixXd Differences(std::int64_t m, Deviation deviation) const {
    const std::int64_t samples = cov_rate.rows();
    const std::int64_t window = deviation == Deviation::kModified ? 3 * m - 1 : 2 * m;
    const std::int64_t stride = deviation == Deviation::kAllan ? m : 1;
    const std::int64_t terms = (samples - window) / stride + 1;
    Eigen::MatrixXd d = Eigen::MatrixXd::Zero(terms, samples);
    for (std::int64_t t = 0; t < terms; ++t) {
      for (std::int64_t s = 0; s < (deviation == Deviation::kModified ? m : 1); ++s) {
        for (std::int64_t i = 0; i < m; ++i) {
          d(t, t * stride + s + i) -= 1;
          d(t, t * stride + s + m + i) += 1;
        }
      }
    }
    return d;
  }

  double Dof(std::int64_t m, Deviation deviation) const {
    const Eigen::MatrixXd d = Differences(m, deviation);
    const Eigen::MatrixXd s = d * cov_rate * d.transpose();
    return s.trace() * s.trace() / s.squaredNorm();
  }
  std::int64_t Terms(std::int64_t m, Deviation deviation) const {
    return Differences(m, deviation).rows();
  }
};

NoiseModel Only(NoiseTerm term) {
  NoiseModel model;
  model.coefficient[term] = 1;
  return model;
}

void ExpectExactDof(NoiseTerm term, const ExactLog& log, std::int64_t m, Deviation deviation,
                    double tolerance) {
  const double dof = EquivalentDof(Only(term), 1, m, log.Terms(m, deviation), deviation);
  EXPECT_NEAR(dof / log.Dof(m, deviation), 1, tolerance)
      << static_cast<int>(term) << " m=" << m << " deviation " << static_cast<int>(deviation);
}

TEST(EquivalentDof, IsTheCovariancesOwn) {
  constexpr Eigen::Index kSamples = 256;
  for (const std::int64_t m : {1, 2, 5, 16, 64, 120, 127, 128}) {
    for (const auto deviation : {Deviation::kOverlapped, Deviation::kAllan}) {
      const double tolerance = m <= 16 || deviation == Deviation::kAllan ? 1e-9 : 0.025;
      ExpectExactDof(NoiseTerm::kAngleRandomWalk, ExactLog::White(kSamples), m, deviation,
                     tolerance);
      ExpectExactDof(NoiseTerm::kRateRandomWalk, ExactLog::Walk(kSamples), m, deviation, tolerance);
      ExpectExactDof(NoiseTerm::kQuantization, ExactLog::WhiteAngle(kSamples), m, deviation,
                     tolerance);
    }
  }
  for (const std::int64_t m : {1, 5, 16, 64, 80}) {
    ExpectExactDof(NoiseTerm::kAngleRandomWalk, ExactLog::White(kSamples), m, Deviation::kModified,
                   0.04);
    ExpectExactDof(NoiseTerm::kQuantization, ExactLog::WhiteAngle(kSamples), m,
                   Deviation::kModified, 0.04);
    ExpectExactDof(NoiseTerm::kRateRandomWalk, ExactLog::Walk(kSamples), m, Deviation::kModified,
                   0.04);
  }
  EXPECT_EQ(EquivalentDof(Only(NoiseTerm::kAngleRandomWalk), 1, 10, 0, Deviation::kOverlapped), 0);
}

// SP 1065, section 5.4.1: the closed form for white rate noise, 0.1 % good where M/m is large.
TEST(EquivalentDof, AgreesWithTheHandbookFarFromTheEnds) {
  const double m = 1024;
  const double n = (1 << 20) + 1;
  const double handbook = (3 * (n - 1) / (2 * m) - 2 * (n - 2) / n) * 4 * m * m / (4 * m * m + 5);
  EXPECT_NEAR(EquivalentDof(Only(NoiseTerm::kAngleRandomWalk), 0.01, 1024, (1 << 20) - 2 * 1024 + 1,
                            Deviation::kOverlapped) /
                  handbook,
              1, 0.01);
}

TEST(EquivalentDof, OfAMixtureLiesWhereItsPartsPutIt) {
  NoiseModel model;
  model.coefficient[NoiseTerm::kAngleRandomWalk] = 1;
  model.coefficient[NoiseTerm::kRateRandomWalk] = 0.05;
  constexpr Eigen::Index kSamples = 256;
  const ExactLog log{ExactLog::White(kSamples).cov_rate +
                     0.05 * 0.05 * ExactLog::Walk(kSamples).cov_rate};
  for (const std::int64_t m : {4, 32, 100}) {
    EXPECT_NEAR(
        EquivalentDof(model, 1, m, log.Terms(m, Deviation::kOverlapped), Deviation::kOverlapped) /
            log.Dof(m, Deviation::kOverlapped),
        1, 0.01);
  }
}

TEST(EquivalentDof, OfFlickerIsWhatManyLogsShow) {
  constexpr int kPairs = 300;
  constexpr std::size_t kSamples = 2048;
  const std::vector<std::int64_t> factors{32, 128, 512};
  Random random(99);
  std::vector<double> sum(3);
  std::vector<double> squares(3);
  for (int i = 0; i < kPairs; ++i) {
    const auto [a, b] = test::FlickerPair(kSamples, 1, random);
    for (const auto* log : {&a, &b}) {
      const auto points = AllanVariance(*log, 1, factors).points;
      for (std::size_t j = 0; j < 3; ++j) {
        sum[j] += points[j].variance;
        squares[j] += points[j].variance * points[j].variance;
      }
    }
  }
  constexpr double kLogs = 2 * kPairs;
  for (std::size_t j = 0; j < 3; ++j) {
    const double mean = sum[j] / kLogs;
    const double variance = (squares[j] / kLogs - mean * mean) * kLogs / (kLogs - 1);
    const double dof = EquivalentDof(Only(NoiseTerm::kBiasInstability), 1, factors[j],
                                     static_cast<std::int64_t>(kSamples) - 2 * factors[j] + 1,
                                     Deviation::kOverlapped);
    const double flat = ModelAllanVariance(Only(NoiseTerm::kBiasInstability), 1);
    EXPECT_NEAR(mean / flat, 1, 4 * std::sqrt(2 / dof / kLogs) + 0.01) << factors[j];
    // A variance from 600 draws of a skew quantity: its own scatter is about 8 to 15 %.
    EXPECT_NEAR(2 * mean * mean / variance / dof, 1, 0.35) << factors[j];
  }
}

TEST(OctaveCovariance, IsTheDifferencesOwn) {
  constexpr Eigen::Index kSamples = 300;
  NoiseModel model;
  model.coefficient[NoiseTerm::kQuantization] = 0.7;
  model.coefficient[NoiseTerm::kAngleRandomWalk] = 1;
  model.coefficient[NoiseTerm::kRateRandomWalk] = 0.1;
  const Eigen::MatrixXd cov_rate = 0.49 * ExactLog::WhiteAngle(kSamples).cov_rate +
                                   ExactLog::White(kSamples).cov_rate +
                                   0.01 * ExactLog::Walk(kSamples).cov_rate;
  const ExactLog log{cov_rate};
  const std::vector<std::int64_t> factors{1, 2, 4, 8, 16, 32, 64, 128};
  std::vector<std::int64_t> terms;
  for (const auto m : factors) terms.push_back(log.Terms(m, Deviation::kOverlapped));
  const Eigen::MatrixXd covariance = OctaveCovariance(model, 1, factors, terms);
  for (std::size_t i = 0; i < factors.size(); ++i) {
    for (std::size_t j = 0; j < factors.size(); ++j) {
      const auto d_i = log.Differences(factors[i], Deviation::kOverlapped);
      const auto d_j = log.Differences(factors[j], Deviation::kOverlapped);
      const Eigen::MatrixXd cross = d_i * cov_rate * d_j.transpose();
      const auto scale = [&](std::size_t k) {
        return 2. * static_cast<double>(factors[k] * factors[k] * terms[k]);
      };
      const double exact = 2 * cross.squaredNorm() / scale(i) / scale(j);
      const double sampled = covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
      EXPECT_NEAR(sampled / exact, 1, factors[std::min(i, j)] <= 8 ? 1e-6 : 0.03) << i << " " << j;
    }
  }
}

// What the interval promises: it holds the truth in 95 of 100 logs, also where few averages are.
TEST(ChiSquareInterval, HoldsTheTruthAsOftenAsItSays) {
  constexpr int kPairs = 500;
  const std::vector<std::int64_t> factors{4, 64, 200};
  std::vector<int> inside(3);
  NoiseCoefficients truth;
  truth.angle_random_walk = 1;
  for (int i = 0; i < kPairs; ++i) {
    const auto logs = test::LogPair(1000, 1, truth, static_cast<std::uint64_t>(i));
    for (const auto* log : {&logs.first, &logs.second}) {
      const auto points = AllanVariance(*log, 1, factors).points;
      for (std::size_t j = 0; j < 3; ++j) {
        const double dof = EquivalentDof(Only(NoiseTerm::kAngleRandomWalk), 1, factors[j],
                                         points[j].terms, Deviation::kOverlapped);
        const auto interval = ChiSquareInterval(points[j].variance, dof, 0.95);
        const double variance = 1 / static_cast<double>(factors[j]);
        inside[j] += interval.lower <= variance && variance <= interval.upper;
      }
    }
  }
  for (const int n : inside) EXPECT_NEAR(n, 950, 4 * std::sqrt(1000 * 0.95 * 0.05));
}

TEST(NoiseModel, GaussMarkovPeaksAtTheFloorItStandsFor) {
  NoiseShape shape;
  shape.correlation_time = 100;
  double peak = 0;
  double at = 0;
  for (double tau = 100; tau < 400; tau += 0.1) {
    const double v = UnitAllanVariance(NoiseTerm::kBiasInstability, shape, tau);
    if (v > peak) {
      peak = v;
      at = tau;
    }
  }
  EXPECT_NEAR(at, 189, 1);  // 1.89 correlation times
  EXPECT_NEAR(std::sqrt(peak), std::sqrt(2 * std::numbers::ln2 / std::numbers::pi), 1e-5)
      << "flicker's floor";
  // The floor over the peak 0.6173643 of unit sigma, where the derivative by tau is zero.
  constexpr double kSigma = 1.0759976;
  // Short times: a random walk of 2 sigma^2/T; long times: white noise of 2 sigma^2 T.
  EXPECT_NEAR(UnitAllanVariance(NoiseTerm::kBiasInstability, shape, 1e-3) /
                  (2 * kSigma * kSigma * 1e-3 / 100 / 3),
              1, 2e-5);
  EXPECT_NEAR(UnitAllanVariance(NoiseTerm::kBiasInstability, shape, 1e7) /
                  (2 * kSigma * kSigma * 100 / 1e7),
              1, 1e-4);
}

}  // namespace
}  // namespace wellgyro

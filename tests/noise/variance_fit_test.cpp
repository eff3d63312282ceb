#include <cmath>

#include <gtest/gtest.h>

#include "wellgyro/math/random.h"
#include "wellgyro/noise/variance_fit_internal.h"

namespace wellgyro {
namespace {

// The conditions that make a point the minimum: x >= 0, gradient >= 0, one of them 0.
TEST(NonnegativeLeastSquares, MeetsTheConditionsOfAMinimum) {
  Random random(5);
  for (int trial = 0; trial < 2000; ++trial) {
    TermMatrix a(6, 6);
    TermVector rhs(6);
    for (double& v : a.reshaped()) v = random.Normal();
    for (double& v : rhs) v = random.Normal();
    const TermMatrix gram = a.transpose() * a + 1e-3 * TermMatrix::Identity(6, 6);
    const TermVector x = NonnegativeLeastSquares(gram, rhs);
    const TermVector gradient = gram * x - rhs;
    for (Eigen::Index i = 0; i < 6; ++i) {
      EXPECT_GE(x(i), 0);
      if (x(i) > 0) {
        EXPECT_NEAR(gradient(i), 0, 1e-8 * (1 + x.norm()));
      } else {
        EXPECT_GE(gradient(i), -1e-8 * (1 + x.norm()));
      }
    }
  }
}

VarianceProblem OfPowers() {
  VarianceProblem problem;
  problem.columns.resize(20, 5);
  problem.edf.resize(20);
  for (Eigen::Index i = 0; i < 20; ++i) {
    const double tau = 0.01 * std::pow(2, static_cast<double>(i));
    problem.columns.row(i) << 3 / tau / tau, 1 / tau, 0.441271, tau / 3, tau * tau / 2;
    problem.edf(i) = 1e6 / std::pow(2, static_cast<double>(i));
  }
  problem.offset = Eigen::VectorXd::Zero(20);
  return problem;
}

TEST(FitVariances, FindsWhatATableWithoutScatterIsMadeOf) {
  const VarianceProblem problem = OfPowers();
  for (const double scale : {1e-24, 1., 1e12}) {
    TermVector truth(5);
    truth << 1e-6, 0.36, 0.0064, 3.6e-5, 1e-10;
    truth *= scale;
    const WeightFit fit = FitVariances(problem, problem.columns * truth, 31);
    for (Eigen::Index i = 0; i < 5; ++i) EXPECT_NEAR(fit.weight(i) / truth(i), 1, 1e-6) << i;
    EXPECT_LT(fit.deviance, 1e-12);
  }
}

TEST(FitVariances, GoesByTheModelNotByLowReadings) {
  // White noise with few degrees of freedom at each time: weights from the readings would read low.
  VarianceProblem problem = OfPowers();
  problem.edf.setConstant(4);
  Random random(17);
  double sum = 0;
  constexpr int kTables = 4000;
  for (int t = 0; t < kTables; ++t) {
    Eigen::VectorXd s(20);
    for (Eigen::Index i = 0; i < 20; ++i) {
      double chi2 = 0;
      for (int k = 0; k < 4; ++k) chi2 += std::pow(random.Normal(), 2);
      s(i) = problem.columns(i, 1) * chi2 / 4;
    }
    sum += FitVariances(problem, s, 2).weight(1);
  }
  // One standard error is sqrt(2/80/4000) = 0.0025.
  EXPECT_NEAR(sum / kTables, 1, 0.01);
}

TEST(FitVariances, HoldsAnOffset) {
  VarianceProblem problem = OfPowers();
  problem.offset = 0.04 * problem.columns.col(2);
  const Eigen::VectorXd s = problem.offset + 0.25 * problem.columns.col(1);
  const WeightFit fit = FitVariances(problem, s, 31 & ~4u);
  EXPECT_NEAR(fit.weight(1), 0.25, 1e-7);
  EXPECT_EQ(fit.weight(2), 0);
}

}  // namespace
}  // namespace wellgyro

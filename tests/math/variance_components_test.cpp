#include "wellgyro/math/variance_components.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "wellgyro/math/random.h"
#include "wellgyro/math/statistics.h"

namespace wellgyro {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VarianceStart Free(std::vector<double> value) {
  return {value, std::vector<bool>(value.size(), false)};
}

/// Rows by themselves, each with a variance of component 0.
VarianceCluster Rows(const VectorXd& y) {
  VarianceCluster cluster;
  cluster.y = y;
  for (Index i = 0; i < y.size(); ++i) {
    cluster.cells.push_back(i);
    cluster.sources.push_back({0, i, VectorXd::Ones(1)});
  }
  return cluster;
}

/// Cells of two rows with local sources of two components, long ones of two more, and a known one.
VarianceCluster Mixed(Random& random) {
  VarianceCluster cluster;
  const auto drawn = [&](Index n) {
    VectorXd v(n);
    for (Index i = 0; i < n; ++i) v(i) = random.Normal();
    return v;
  };
  cluster.y = drawn(12);
  for (Index cell = 0; cell < 12; cell += 2) {
    cluster.cells.push_back(cell);
    cluster.sources.push_back({0, cell, VectorXd::Ones(1)});
    cluster.sources.push_back({0, cell + 1, VectorXd::Ones(1)});
    cluster.sources.push_back({1, cell, drawn(2)});
  }
  cluster.sources.push_back({2, 0, drawn(12)});
  cluster.sources.push_back({3, 3, drawn(6)});
  cluster.sources.push_back({3, 5, drawn(7)});
  cluster.sources.push_back({std::nullopt, 1, drawn(5)});
  return cluster;
}

double DenseLogLikelihood(const VarianceCluster& c, const std::vector<double>& theta) {
  MatrixXd v = MatrixXd::Zero(c.y.size(), c.y.size());
  for (const VarianceSource& s : c.sources) {
    VectorXd effect = VectorXd::Zero(c.y.size());
    effect.segment(s.first, s.effect.size()) = s.effect;
    v += (s.component ? theta[*s.component] : 1) * effect * effect.transpose();
  }
  return -(std::log(v.determinant()) + c.y.dot(v.inverse() * c.y)) / 2;
}

// ln L = -(ln |V| + y' V^-1 y) / 2, V dense.
TEST(VarianceComponents, TheLogLikelihoodIsThatOfTheDenseMatrix) {
  Random random(1);
  const VarianceCluster clusters[] = {Mixed(random), Mixed(random)};
  const std::vector<double> theta = {0.7, 0.4, 0, 2.5};
  const VarianceFit fit = FitVariances(clusters, {theta, std::vector<bool>(4, true)});
  const double dense =
      DenseLogLikelihood(clusters[0], theta) + DenseLogLikelihood(clusters[1], theta);
  EXPECT_NEAR(fit.log_likelihood, dense, 1e-10 * std::abs(dense));
}

// At the maximum no neighbour is higher, by the dense matrices.
TEST(VarianceComponents, WhatIsFoundIsTheHighest) {
  Random random(2);
  std::vector<VarianceCluster> clusters;
  for (int i = 0; i < 20; ++i) clusters.push_back(Mixed(random));
  const VarianceFit fit = FitVariances(clusters, Free({1, 1, 1, 1}));
  ASSERT_TRUE(fit.converged);
  std::vector<double> best;
  for (const VarianceEstimate& e : fit.components) best.push_back(e.value);
  const auto at = [&](const std::vector<double>& theta) {
    double sum = 0;
    for (const VarianceCluster& c : clusters) sum += DenseLogLikelihood(c, theta);
    return sum;
  };
  const double highest = at(best);
  for (std::size_t j = 0; j < 4; ++j) {
    for (const double step : {-1e-3, 1e-3}) {
      std::vector<double> beside = best;
      beside[j] = std::max(0.0, beside[j] + step);
      EXPECT_LE(at(beside), highest + 1e-9) << j << " " << step;
    }
  }
}

// Second differences of a random walk, where there might be noise and the integral of a walk too:
// the three look so much alike that a step which cuts some of them at 0 and leaves the others as
// they were goes downhill. What is found is no lower than where only the walk is.
TEST(VarianceComponents, AtABoundTheOthersGoToTheirBest) {
  Random random(7);
  std::vector<VarianceCluster> clusters;
  constexpr Index kRows = 30;
  for (int i = 0; i < 20; ++i) {
    VarianceCluster cluster;
    cluster.cells = {0};
    cluster.y = VectorXd::Zero(kRows);
    const auto add = [&](std::size_t component, Index first, const VectorXd& effect, double draw) {
      const Index begin = std::max<Index>(first, 0);
      const Index end = std::min(first + effect.size(), kRows);
      if (end <= begin) return;
      const VectorXd part = effect.segment(begin - first, end - begin);
      cluster.y.segment(begin, end - begin) += draw * part;
      cluster.sources.push_back({component, begin, part});
    };
    for (Index k = -2; k < kRows; ++k) add(0, k, Eigen::Vector3d(-0.5, 1, -0.5), 0);
    for (Index k = -1; k < kRows; ++k) {
      add(1, k, Eigen::Vector2d(-0.5, 0.5), random.Normal());
      add(2, k, Eigen::Vector2d(0.25, 0.5) / std::sqrt(3), 0);
      add(2, k, Eigen::Vector2d(0.25, 0), 0);
    }
    clusters.push_back(cluster);
  }
  const VarianceFit fit = FitVariances(clusters, Free({0.3, 0.3, 1.0}));
  const VarianceFit at_bound = FitVariances(clusters, {{0, 0.3, 0}, {true, false, true}});
  EXPECT_GE(fit.log_likelihood, at_bound.log_likelihood - 1e-6);
  EXPECT_NEAR(at_bound.components[1].value, 1, 4 * std::sqrt(2.0 / (20 * kRows)));
}

// Balanced one-way layout of g groups of n: within and between mean squares MSW, MSB give REML's
// sigma_e^2 = MSW and sigma_a^2 = (MSB - MSW) / n (Searle, Casella and McCulloch 1992, 4.8).
TEST(VarianceComponents, OneWayLayoutIsItsMeanSquares) {
  constexpr int kGroups = 12, kRows = 5;
  Random random(3);
  MatrixXd x(kRows, kGroups);
  for (Index g = 0; g < kGroups; ++g) {
    const double a = 2 * random.Normal();
    for (Index i = 0; i < kRows; ++i) x(i, g) = 10 + a + random.Normal();
  }
  // Contrasts of the grand mean: Householder's reflection that takes ones to the first axis.
  const Index n = kGroups * kRows;
  VectorXd u = VectorXd::Ones(n);
  u(0) += std::sqrt(static_cast<double>(n));
  const MatrixXd reflect = MatrixXd::Identity(n, n) - 2 / u.squaredNorm() * u * u.transpose();
  const MatrixXd contrast = reflect.bottomRows(n - 1);
  VarianceCluster cluster = Rows(contrast * Eigen::Map<const VectorXd>(x.data(), n));
  for (Index g = 0; g < kGroups; ++g) {
    cluster.sources.push_back({1, 0, contrast.middleCols(g * kRows, kRows).rowwise().sum()});
  }
  const VarianceFit fit = FitVariances(std::span(&cluster, 1), Free({1, 1}));
  const Eigen::RowVectorXd mean = x.colwise().mean();
  const double within = (x.rowwise() - mean).squaredNorm() / (kGroups * (kRows - 1));
  const double between =
      kRows * (mean.array() - mean.mean()).matrix().squaredNorm() / (kGroups - 1);
  EXPECT_NEAR(fit.components[0].value, within, 1e-5 * within);
  EXPECT_NEAR(fit.components[1].value, (between - within) / kRows, 1e-4 * between);
}

// n rows of one variance v: v^ = y'y / n, and the deviance is n (ln(v / v^) + v^ / v - 1).
TEST(VarianceComponents, TheIntervalOfOneVarianceIsWhereItsDevianceIsTheQuantile) {
  Random random(4);
  VectorXd y(30);
  for (Index i = 0; i < 30; ++i) y(i) = 3 * random.Normal();
  const VarianceCluster cluster = Rows(y);
  const VarianceStart start = Free({1});
  const VarianceFit fit = FitVariances(std::span(&cluster, 1), start);
  const double v = y.squaredNorm() / 30;
  EXPECT_NEAR(fit.components[0].value, v, 1e-4 * v);
  const VarianceEstimate e = VarianceIntervals(std::span(&cluster, 1), start, fit).front();
  ASSERT_TRUE(e.upper);
  for (const double bound : {e.lower, *e.upper}) {
    EXPECT_NEAR(30 * (std::log(bound / v) + v / bound - 1), ChiSquareQuantile(0.95, 1), 0.02);
  }
  EXPECT_LT(e.lower, v);
  EXPECT_GT(*e.upper, v);
}

// Two components with the same effects: neither is bounded from below, their sum is known.
TEST(VarianceComponents, WhatCannotBeToldApartHasWideIntervals) {
  Random random(5);
  VectorXd y(200);
  for (Index i = 0; i < 200; ++i) y(i) = random.Normal();
  VarianceCluster cluster = Rows(y);
  for (Index i = 0; i < 200; ++i) cluster.sources.push_back({1, i, VectorXd::Ones(1)});
  const VarianceStart start = Free({0.5, 0.5});
  const VarianceFit fit = FitVariances(std::span(&cluster, 1), start);
  EXPECT_NEAR(fit.components[0].value + fit.components[1].value, y.squaredNorm() / 200, 1e-3);
  for (const auto& e : VarianceIntervals(std::span(&cluster, 1), start, fit)) {
    EXPECT_EQ(e.lower, 0);
    ASSERT_TRUE(e.upper);
    EXPECT_GT(*e.upper, 0.9 * y.squaredNorm() / 200);
  }
}

TEST(VarianceComponents, RefusesWhatMakesNoSense) {
  VarianceCluster cluster = Rows(VectorXd::Ones(3));
  const auto fit = [&] { return FitVariances(std::span(&cluster, 1), Free({1})); };
  cluster.sources.push_back({0, 2, VectorXd::Ones(2)});
  EXPECT_THROW(fit(), std::invalid_argument);
  cluster.sources.back() = {1, 0, VectorXd::Ones(2)};
  EXPECT_THROW(fit(), std::invalid_argument);
  cluster.sources.erase(cluster.sources.begin(), cluster.sources.begin() + 1);
  cluster.sources.back() = {0, 1, VectorXd::Ones(1)};
  EXPECT_THROW(fit(), std::invalid_argument);
  cluster = Rows(VectorXd::Ones(3));
  cluster.cells.front() = 1;
  EXPECT_THROW(fit(), std::invalid_argument);
}

}  // namespace
}  // namespace wellgyro

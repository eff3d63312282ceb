#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "wellgyro/fit/tool_left_out_internal.h"
#include "wellgyro/math/random.h"
#include "wellgyro/math/statistics.h"

namespace wellgyro::test {
namespace {

using Eigen::Matrix2d, Eigen::MatrixXd, Eigen::Vector2d, Eigen::VectorXd;

TermBundle Bundle(int n, bool needed) {
  TermBundle bundle;
  bundle.terms.resize(static_cast<std::size_t>(n));
  bundle.needed = needed;
  return bundle;
}

/// Moments of the density of the share of noise k, k^(n/2) exp(-k Q / 2) on (0, 1), by Simpson's
/// rule in u, k = u^2, where it is smooth for odd n too; and the probability that the bundle is
/// there, the integral of k^(n/2) exp((1 - k) Q / 2) to one.
struct Moments {
  double mean = 0, variance = 0, there = 0;
};
Moments ByQuadrature(int n, double Q) {
  constexpr int kSteps = 20000;
  long double sum = 0, first = 0, second = 0;
  for (int i = 0; i <= kSteps; ++i) {
    const long double u = static_cast<long double>(i) / kSteps, k = u * u;
    const long double simpson = i == 0 || i == kSteps ? 1 : i % 2 == 1 ? 4 : 2;
    const long double weight = simpson * std::pow(u, n + 1) * std::exp(-k * Q / 2);
    sum += weight;
    first += weight * k;
    second += weight * k * k;
  }
  const long double mean = first / sum;
  const long double bayes = 2 * sum / (3 * kSteps) * std::exp(Q / 2);  // dk = 2 u du
  return {static_cast<double>(mean), static_cast<double>(second / sum - mean * mean),
          static_cast<double>(bayes / (1 + bayes))};
}

/// Readings of two kept coefficients, two of a bundle that is left out, and one of the bench.
struct Case {
  MatrixXd kept, left;  ///< their columns
  VectorXd y;
  MatrixXd K, W;   ///< of the left-out ones: what they do to the kept, and what readings say
  Vector2d theta;  ///< as the adjustment of all finds them
  ToolAdjustment full{.linear = LinearProblem({}, 0)};

  Case(double size, double unit, std::uint64_t seed) {
    constexpr int kRows = 14;
    Random random(seed);
    const auto drawn = [&random](Eigen::Index rows, Eigen::Index columns) {
      MatrixXd D(rows, columns);
      for (double& d : D.reshaped()) d = random.Normal();
      return D;
    };
    kept = drawn(kRows, 3);
    // Half of what the left-out ones do the kept can do as well, and each other's too.
    left = drawn(kRows, 2) + kept.leftCols(2) * 0.7;
    left.col(1) += 0.5 * left.col(0);
    left *= unit;
    y = size / unit * left * Vector2d(0.4, -0.3) + kept * Eigen::Vector3d(2, -1, 0.5) +
        drawn(kRows, 1);
    K = kept.colPivHouseholderQr().solve(left);
    const MatrixXd alone = left - kept * K;
    W = alone.transpose() * alone;
    MatrixXd A(kRows, 5);
    A << kept.leftCols(2), left, kept.col(2);
    full.x = A.colPivHouseholderQr().solve(y);
    full.linear.A = A;
    theta = full.x.segment<2>(2);
  }
};

// Given the share k of noise, theta ~ N(0, (1 - k) / k W^-1) before the readings, and after them
// N((1 - k) theta_full, (1 - k) W^-1); of even odds it is zero.
TEST(ToolLeftOut, IsTheMixtureOfThereAndNotOverAllSharesOfNoise) {
  const std::vector<TermBundle> bundles = {Bundle(2, true), Bundle(2, false)};
  double least = 1, most = 0;
  for (const double size : {0.0, 1.5, 3.0, 9.0}) {
    for (const double unit : {1.0, 1e-4}) {
      const Case c(size, unit, 7);
      const Moments k = ByQuadrature(2, c.theta.dot(c.W * c.theta));
      const double p = k.there;
      const Vector2d mean = (1 - k.mean) * c.theta;
      const Matrix2d if_there =
          (1 - k.mean) * c.W.inverse() + k.variance * c.theta * c.theta.transpose();
      const Matrix2d cov = p * if_there + p * (1 - p) * mean * mean.transpose();

      const LeftOutErrors found = LeftOutErrorsOf(bundles, {0, 1}, {0}, c.full);
      // Of the kept, in their order: the tool's, the bench's; then the left-out ones.
      ASSERT_EQ(found.shift.size(), 5);
      const VectorXd shift_kept = -c.K * (p * mean);
      EXPECT_LT((found.shift.head<3>() - shift_kept).norm(), 1e-8 * shift_kept.norm());
      EXPECT_LT((found.shift.tail<2>() - p * mean).norm(), 1e-8 * mean.norm());
      const MatrixXd cov_kept = c.K * cov * c.K.transpose(), across = -c.K * cov;
      EXPECT_LT((found.cov.topLeftCorner<3, 3>() - cov_kept).norm(), 1e-8 * cov_kept.norm());
      EXPECT_LT((found.cov.topRightCorner<3, 2>() - across).norm(), 1e-8 * across.norm());
      const Matrix2d own = cov + (1 - p) * if_there;
      EXPECT_LT((found.cov.bottomRightCorner<2, 2>() - own).norm(), 1e-8 * own.norm());
      least = std::min(least, p);
      most = std::max(most, p);
    }
  }
  // The cases reach from hardly to surely there.
  EXPECT_LT(least, 0.45);
  EXPECT_GT(most, 0.9);
}

// Of bundles that are there as often as not, by whatever g: what is done to the kept parameters is
// off by as much as is stated.
TEST(ToolLeftOut, ErrorsOfTheKeptAreAsLargeAsStated) {
  const Case c(0, 1, 7);
  const std::vector<TermBundle> bundles = {Bundle(2, true), Bundle(2, false)};
  const Matrix2d root = Matrix2d(c.W.inverse()).llt().matrixL();
  Random random(5);
  const auto drawn = [&] {
    Vector2d z;
    for (double& each : z) each = random.Normal();
    return z;
  };
  constexpr int kDraws = 4000;
  double squares = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double k = random.Uniform();
    const Vector2d there = std::sqrt((1 - k) / k) * root * drawn();
    const Vector2d theta = i % 2 == 0 ? there : Vector2d(0, 0);
    ToolAdjustment full = c.full;
    full.x.segment<2>(2) = theta + root * drawn();
    const LeftOutErrors found = LeftOutErrorsOf(bundles, {0, 1}, {0}, full);
    const Vector2d error = found.shift.head<2>() + c.K.topRows<2>() * theta;
    squares += error.dot(found.cov.topLeftCorner<2, 2>().inverse() * error);
  }
  EXPECT_GT(squares, ChiSquareQuantile(1e-4, 2 * kDraws));
  EXPECT_LT(squares, ChiSquareQuantile(1 - 1e-4, 2 * kDraws));
}

// What is wrong with the kept ones is what an adjustment without the others makes of them.
TEST(ToolLeftOut, TheShiftTakesOffWhatTheLeftOutDoToTheKept) {
  const Case c(3, 1, 11);
  const VectorXd without = c.kept.colPivHouseholderQr().solve(c.y);
  const std::vector<Eigen::Index> of_kept = {0, 1, 4};
  const VectorXd with_all = c.full.x(of_kept);
  EXPECT_LT((without - c.K * c.theta - with_all).norm(), 1e-12 * with_all.norm());
}

TEST(ToolLeftOut, NothingLeftOutChangesNothing) {
  const std::vector<TermBundle> bundles = {Bundle(2, true), Bundle(2, false)};
  const LeftOutErrors found = LeftOutErrorsOf(bundles, {0, 1}, {0, 1}, Case(1, 1, 3).full);
  EXPECT_TRUE(found.terms.empty());
  EXPECT_EQ(found.shift, VectorXd::Zero(5));
  EXPECT_EQ(found.cov, MatrixXd::Zero(5, 5));
}

}  // namespace
}  // namespace wellgyro::test

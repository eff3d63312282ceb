#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/fit/tool_left_out_internal.h"
#include "wellgyro/math/random.h"

namespace wellgyro::test {
namespace {

using Eigen::Matrix2d, Eigen::MatrixXd, Eigen::Vector2d, Eigen::VectorXd;

TermBundle Bundle(int n, bool needed) {
  TermBundle bundle;
  bundle.terms.resize(static_cast<std::size_t>(n));
  bundle.needed = needed;
  return bundle;
}

/// Of a coefficient pair the moments about zero of weight(theta), by the trapezium rule, which for
/// what vanishes with all its derivatives at both ends converges faster than any power of the step.
struct Moments {
  double total = 0;
  Vector2d first = Vector2d::Zero();
  Matrix2d second = Matrix2d::Zero();
};
Moments ByQuadrature(const Vector2d& half_width, const std::function<double(const Vector2d&)>& of) {
  constexpr int kHalf = 60;
  Moments m;
  const Vector2d step = half_width / kHalf;
  for (int i = -kHalf; i <= kHalf; ++i) {
    for (int j = -kHalf; j <= kHalf; ++j) {
      const Vector2d theta(i * step[0], j * step[1]);
      const double weight = of(theta) * step.prod();
      m.total += weight;
      m.first += weight * theta;
      m.second += weight * theta * theta.transpose();
    }
  }
  return m;
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

// If the bundle is there, its coefficients are N(0, s^2), s the sigma each has of the readings; the
// adjustment of all is N(theta, W^-1) about them. If not, they are zero. The odds are even before.
TEST(ToolLeftOut, IsTheMixtureOfThereAndNot) {
  const std::vector<TermBundle> bundles = {Bundle(2, true), Bundle(2, false)};
  double least = 1, most = 0;
  for (const double size : {0.0, 1.5, 3.0, 6.0}) {
    for (const double unit : {1.0, 1e-4}) {
      const Case c(size, unit, 7);
      const Vector2d s = c.W.inverse().diagonal().cwiseSqrt();
      const auto likelihood = [&](const Vector2d& theta) {
        return std::exp(-(theta - c.theta).dot(c.W * (theta - c.theta)) / 2);
      };
      const Moments there = ByQuadrature(9 * s, [&](const Vector2d& theta) {
        return std::exp(-theta.cwiseQuotient(s).squaredNorm() / 2) / (kTwoPi * s.prod()) *
               likelihood(theta);
      });
      const double p = there.total / (there.total + likelihood(Vector2d::Zero()));
      const Vector2d mean = p * there.first / there.total;
      const Matrix2d about = p * there.second / there.total - mean * mean.transpose();
      const Matrix2d readings = there.second / there.total - mean / p * (mean / p).transpose();

      const LeftOutErrors found = LeftOutErrorsOf(bundles, {0, 1}, {0}, c.full);
      // Of the kept, in their order: the tool's, the bench's; then the left-out ones.
      ASSERT_EQ(found.shift.size(), 5);
      const VectorXd shift_kept = -c.K * mean;
      EXPECT_LT((found.shift.head<3>() - shift_kept).norm(), 1e-8 * shift_kept.norm());
      EXPECT_LT((found.shift.tail<2>() - mean).norm(), 1e-8 * mean.norm());
      const MatrixXd cov_kept = c.K * about * c.K.transpose(), across = -c.K * about;
      EXPECT_LT((found.cov.topLeftCorner<3, 3>() - cov_kept).norm(), 1e-8 * cov_kept.norm());
      EXPECT_LT((found.cov.topRightCorner<3, 2>() - across).norm(), 1e-8 * across.norm());
      const Matrix2d own = about + (1 - p) * readings;
      EXPECT_LT((found.cov.bottomRightCorner<2, 2>() - own).norm(), 1e-8 * own.norm());
      least = std::min(least, p);
      most = std::max(most, p);
    }
  }
  // The cases reach from hardly to surely there.
  EXPECT_LT(least, 0.4);
  EXPECT_GT(most, 0.9);
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

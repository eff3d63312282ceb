// What squares of residuals add up to under their losses.
#include "wellgyro/estimate/normal_block.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "wellgyro/math/random.h"

namespace wellgyro {
namespace {

/// E[min(s, 3 sqrt s)] for s the sum of squares of n normals of this sigma: Simpson's rule over
/// their root, whose density is 2 r^(n-1) e^(-r^2/2) / (2^(n/2) Gamma(n/2)) in sigmas.
long double HuberByQuadrature(int n, long double sigma) {
  constexpr int kSteps = 20000;
  constexpr long double kEnd = 12;
  const long double h = kEnd / kSteps;
  const long double norm = 2 / (std::pow(2.0L, n / 2.0L) * std::tgamma(n / 2.0L));
  long double sum = 0;
  for (int i = 0; i <= kSteps; ++i) {
    const long double r = h * i;
    const long double value = std::min(sigma * sigma * r * r, 3 * sigma * r) * norm *
                              std::pow(r, n - 1.0L) * std::exp(-r * r / 2);
    sum += value * (i == 0 || i == kSteps ? 1 : i % 2 == 1 ? 4 : 2);
  }
  return sum * h / 3;
}

// Unknowns that take up a part of the residuals leave them smaller, and fewer reach the loss.
TEST(NormalBlock, ExpectsOfSquaresWhatUnknownsAndHubersLossLeaveOfThem) {
  Layout layout;
  for (int n = 1; n <= 3; ++n) {
    for (const double absorbed : {0.0, 0.3, 0.9}) {
      NormalBlock block;
      block.Clear(layout);
      NormalBlock::Matrix cov = NormalBlock::Matrix::Zero(2 * layout.node, 2 * layout.node);
      cov(0, 0) = absorbed;  // of every row, through its one column
      block.Measure(&cov);
      Factor f;
      f.Begin(RowKind::kForce, n);
      f.r.setConstant(0.5);
      f.Column(0).setConstant(1);
      block.Add(f);
      const RowSum& sum = block.sums()[static_cast<std::size_t>(RowKind::kForce)];
      const auto sigma = std::sqrt(1 - static_cast<long double>(absorbed));
      EXPECT_NEAR(sum.freedom, static_cast<double>(HuberByQuadrature(n, sigma)), 1e-9) << n;
      EXPECT_LE(sum.freedom, n * (1 - absorbed));
      EXPECT_NEAR(sum.weighted, 0.25 * n, 1e-15);
    }
  }
}

// A force's lateral part measures the roll: its square counts neither as found nor as expected.
TEST(NormalBlock, LeavesTheLateralForceOutOfTheSquares) {
  Layout layout;
  NormalBlock::Matrix cov = NormalBlock::Matrix::Zero(2 * layout.node, 2 * layout.node);
  cov(0, 0) = 0.2;
  const Eigen::Vector3d lateral = Eigen::Vector3d(0.6, 0.8, 0);
  const auto sums = [&](const Eigen::Vector3d& r) {
    NormalBlock block;
    block.Clear(layout);
    block.Measure(&cov);
    Factor f;
    f.Begin(RowKind::kForce, 3);
    f.r = r;
    f.Column(0) = lateral;
    f.Shrink(lateral, 0.5);
    block.Add(f);
    return block.sums()[static_cast<std::size_t>(RowKind::kForce)];
  };
  const RowSum none = sums(0.7 * lateral), radial = sums({0.8, -0.6, 0}), axial = sums({0, 0, 1});
  EXPECT_NEAR(none.weighted, 0, 1e-15);
  EXPECT_NEAR(radial.weighted, 1, 1e-15);
  EXPECT_NEAR(axial.weighted, 1, 1e-15);
  EXPECT_EQ(none.rows, 2);
  // The column lies along what is left out, so that both other rows are whole.
  EXPECT_NEAR(none.freedom, 2, 0.05);
  EXPECT_LT(none.freedom, 2) << "less what Huber's loss leaves";
}

// By the definition, of rows that reach few columns and of those that are added along all of them.
TEST(NormalBlock, SumsUpJacobiansAndResiduals) {
  Layout layout;
  const int size = 2 * layout.node;
  Random random(7);
  for (int n = 1; n <= 3; ++n) {
    NormalBlock block;
    block.Clear(layout);
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(n, size);
    Factor f;
    f.Begin(RowKind::kSpeed, n);
    for (const int at : {9, 0, 4, 11, 3}) {
      const Eigen::VectorXd column =
          Eigen::VectorXd::NullaryExpr(n, [&] { return random.Normal(); });
      f.Column(at).head(n) = column;
      J.col(at) = column;
    }
    for (int i = 0; i < n; ++i) f.r[i] = random.Normal();
    block.Add(f);
    const Eigen::MatrixXd information = J.transpose() * J;
    for (int at = 0; at < size; ++at) {
      EXPECT_LT((block.Column(at) - information.col(at)).norm(), 1e-14) << n << " " << at;
    }
    EXPECT_LT((block.gradient() - J.transpose() * f.r.head(n)).norm(), 1e-14) << n;
  }
}

// A Huber's loss is left out where a fault is looked for, the roll's weight is part of its model.
TEST(NormalBlock, WithoutLossCountsAllButTheRollAsItIs) {
  Layout layout;
  NormalBlock block;
  block.WithoutLoss(true);
  for (const RowKind kind : {RowKind::kForce, RowKind::kRoll}) {
    block.Clear(layout);
    Factor f;
    f.Begin(kind, 1);
    f.r[0] = 30;
    f.Column(0)[0] = 1;
    block.Add(f);
    const double weight = kind == RowKind::kRoll ? 6. / 905 : 1;  // (5 + 1)/(5 + r^2)
    EXPECT_NEAR(block.information()(0, 0), weight, 1e-15);
  }
}

}  // namespace
}  // namespace wellgyro

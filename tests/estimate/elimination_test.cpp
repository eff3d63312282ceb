#include "wellgyro/estimate/elimination.h"

#include <cmath>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "wellgyro/math/random.h"

namespace wellgyro {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kKnots = 7;

/// Random positive blocks over [node | next | border], eliminated and, beside it, written out as
/// one dense system.
struct Chain {
  Layout layout;
  Elimination elimination{layout};
  MatrixXd H;
  VectorXd g;

  explicit Chain(std::uint64_t seed) {
    layout.node = 6;
    layout.border = 4;
    Random random(seed);
    const int n = layout.node, b = layout.border, size = (kKnots + 1) * n + b;
    H.setZero(size, size);
    g.setZero(size);
    const auto rows = [&random](Eigen::Index count, Eigen::Index columns) {
      return MatrixXd::NullaryExpr(count, columns, [&random] { return random.Normal(); }).eval();
    };
    const auto places = [&](int node, bool next) {
      std::vector<int> at;
      for (int i = 0; i < (next ? 2 : 1) * n; ++i) at.push_back(node * n + i);
      for (int i = 0; i < b; ++i) at.push_back((kKnots + 1) * n + i);
      return at;
    };
    const MatrixXd J0 = rows(n + b + 2, n + b);
    const VectorXd r0 = rows(n + b + 2, 1);
    H(places(0, false), places(0, false)) += J0.transpose() * J0;
    g(places(0, false)) += J0.transpose() * r0;
    elimination.Start(kKnots, EdgeMatrix(J0.transpose() * J0), EdgeVector(J0.transpose() * r0));
    NormalBlock block;
    for (int k = 0; k < kKnots; ++k) {
      const MatrixXd J = rows(n + 3, 2 * n + b);
      const VectorXd r = rows(n + 3, 1);
      block.Clear(layout);
      block.information() = J.transpose() * J;
      block.gradient() = J.transpose() * r;
      H(places(k, true), places(k, true)) += J.transpose() * J;
      g(places(k, true)) += J.transpose() * r;
      EXPECT_TRUE(elimination.Step(block));
    }
  }
};

TEST(Elimination, SolvesTheDenseSystem) {
  Chain chain(1);
  std::vector<NodeVector> nodes;
  BorderVector border;
  ASSERT_TRUE(chain.elimination.Solve(nodes, border));
  const VectorXd x = chain.H.ldlt().solve(-chain.g);
  const int n = chain.layout.node;
  for (int k = 0; k <= kKnots; ++k) {
    EXPECT_LT((nodes[static_cast<std::size_t>(k)] - x.segment(k * n, n)).norm(), 1e-10) << k;
  }
  EXPECT_LT((border - x.tail(chain.layout.border)).norm(), 1e-10);
  EXPECT_NEAR(chain.elimination.decrement(), -x.dot(chain.g), 1e-9);
  const double log_determinant =
      2 * chain.H.llt().matrixL().toDenseMatrix().diagonal().array().log().sum();
  EXPECT_NEAR(chain.elimination.log_determinant(), log_determinant, 1e-9);
}

TEST(Elimination, CovariancesAreThoseOfTheDenseInverse) {
  Chain chain(2);
  std::vector<NodeVector> nodes;
  BorderVector border;
  ASSERT_TRUE(chain.elimination.Solve(nodes, border));
  const MatrixXd P = chain.H.inverse();
  const int n = chain.layout.node, b = chain.layout.border;
  EdgeMatrix next = chain.elimination.LastCovariance();
  EXPECT_LT((next.topLeftCorner(n, n) - P.block(kKnots * n, kKnots * n, n, n)).norm(), 1e-10);
  const Eigen::Matrix3d phi = P.block(kKnots * n, kKnots * n, 3, 3);
  EXPECT_GT(phi.norm(), 1e-3);
  EXPECT_LT((chain.elimination.LastCovarianceOfPhi() - phi).norm(), 1e-10);
  for (int k = kKnots; k-- > 0;) {
    BehindMatrix with_next;
    const auto at = static_cast<std::size_t>(k);
    const EdgeMatrix here =
        chain.elimination.CovarianceBefore(at, chain.elimination.Gain(at), next, with_next);
    EXPECT_LT((here.topLeftCorner(n, n) - P.block(k * n, k * n, n, n)).norm(), 1e-10) << k;
    EXPECT_LT((here.topRightCorner(n, b) - P.block(k * n, (kKnots + 1) * n, n, b)).norm(), 1e-10);
    EXPECT_LT((with_next.leftCols(n) - P.block(k * n, (k + 1) * n, n, n)).norm(), 1e-10) << k;
    next = here;
  }
}

TEST(Elimination, SolvesOtherRightHandSidesFromNodeToNode) {
  Chain chain(3);
  std::vector<NodeVector> nodes;
  BorderVector border;
  ASSERT_TRUE(chain.elimination.Solve(nodes, border));
  const int n = chain.layout.node, b = chain.layout.border;
  Random random(4);
  const MatrixXd rhs =
      MatrixXd::NullaryExpr(chain.H.rows(), 2, [&random] { return random.Normal(); });
  const MatrixXd solution = chain.H.ldlt().solve(rhs);
  std::vector<MatrixXd> kept;
  MatrixXd x(2 * n + b, 2);
  x << rhs.topRows(2 * n), rhs.bottomRows(b);
  for (int k = 0; k < kKnots; ++k) {
    chain.elimination.Eliminate(static_cast<std::size_t>(k), x);
    kept.emplace_back(x.topRows(n));
    x.topRows(n) = x.middleRows(n, n).eval();
    if (k + 1 < kKnots) x.middleRows(n, n) = rhs.middleRows((k + 2) * n, n);
  }
  MatrixXd last(n + b, 2);
  last << x.topRows(n), x.bottomRows(b);
  last = (chain.elimination.LastCovariance() * last).eval();
  x << MatrixXd::Zero(n, 2), last;
  for (int k = kKnots; k-- > 0;) {
    x.topRows(n) = kept[static_cast<std::size_t>(k)];
    chain.elimination.Substitute(static_cast<std::size_t>(k), x);
    EXPECT_LT((x.topRows(n) - solution.middleRows(k * n, n)).norm(), 1e-10) << k;
    x.middleRows(n, n) = x.topRows(n).eval();
  }
  EXPECT_LT((x.bottomRows(b) - solution.bottomRows(b)).norm(), 1e-10);
}

TEST(Elimination, WhatIsUnobservedIsRefused) {
  Layout layout;
  Elimination elimination(layout);
  elimination.Start(1, EdgeMatrix::Zero(layout.node, layout.node), EdgeVector::Zero(layout.node));
  NormalBlock block;
  block.Clear(layout);
  EXPECT_FALSE(elimination.Step(block));
}

}  // namespace
}  // namespace wellgyro

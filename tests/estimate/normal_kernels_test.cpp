// What is worked out by registers, of whatever width, against plain loops in long double.
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "wellgyro/estimate/normal_block.h"
#include "wellgyro/estimate/normal_kernels_internal.h"
#include "wellgyro/math/random.h"

namespace wellgyro {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Exact = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

/// Widths and sizes at which fours are cut off anywhere.
std::vector<std::pair<Index, Index>> Sizes() {
  std::vector<std::pair<Index, Index>> sizes;
  for (Index node = 1; node <= kNodeMax; ++node) {
    for (const int border : {0, 1, 2, 3, 4, 6, 9, 15, 20, 31, kBorderMax}) {
      sizes.emplace_back(node, border);
    }
  }
  return sizes;
}

MatrixXd Positive(Index size, Random& random) {
  const MatrixXd J = MatrixXd::NullaryExpr(size + 5, size, [&] { return random.Normal(); });
  return J.transpose() * J;
}

/// Its lower triangle in columns that stand so far apart. What else there is counts for nothing,
/// and nothing must come of it.
std::vector<double> Apart(const MatrixXd& A, Index columns, Index stride) {
  std::vector<double> values(static_cast<std::size_t>(columns * stride),
                             std::numeric_limits<double>::quiet_NaN());
  for (Index j = 0; j < columns; ++j) {
    for (Index i = j; i < A.rows(); ++i) values[static_cast<std::size_t>(j * stride + i)] = A(i, j);
  }
  return values;
}

MatrixXd Lower(const std::vector<double>& values, Index rows, Index columns, Index stride) {
  MatrixXd A = MatrixXd::Zero(rows, columns);
  for (Index j = 0; j < columns; ++j) {
    for (Index i = j; i < rows; ++i) A(i, j) = values[static_cast<std::size_t>(j * stride + i)];
  }
  return A;
}

bool SameBits(const MatrixXd& a, const MatrixXd& b) {
  return a.size() == b.size() &&
         std::memcmp(a.data(), b.data(), static_cast<std::size_t>(a.size()) * sizeof(double)) == 0;
}

/// What is known of a node, the next one and the border, and what comes of its elimination.
struct OneNode {
  Index node, border;
  MatrixXd block, edge;
  Eigen::VectorXd gradient;

  OneNode(Index n, Index b, Random& random)
      : node(n),
        border(b),
        block(Positive(2 * n + b, random)),
        edge(Positive(n + b, random)),
        gradient(Eigen::VectorXd::NullaryExpr(2 * n + b, [&] { return random.Normal(); })) {}

  struct Result {
    MatrixXd panel, edge, gradient;
  };

  Result By(Registers registers) const {
    const Index m = node + border, stride = BlockStride(node, border), rows = node + m;
    const std::vector<double> A = Apart(block, rows, stride);
    std::vector<double> next = Apart(edge, m, ByFours(m));
    std::vector<double> x(static_cast<std::size_t>(node * stride),
                          std::numeric_limits<double>::quiet_NaN());
    std::vector<double> g(static_cast<std::size_t>(stride), 0.0);
    std::copy(gradient.begin(), gradient.end(), g.begin());
    const NodePanel panel{x.data(), stride, node, border};
    const EdgeColumns columns{next.data(), ByFours(m)};
    Begin(registers, A.data(), columns, panel);
    EXPECT_TRUE(Factorise(registers, panel));
    Forward(registers, panel, g.data());
    Succeed(registers, panel, A.data(), columns);
    g.resize(static_cast<std::size_t>(rows));
    return {Lower(x, rows, node, stride), Lower(next, m, m, ByFours(m)),
            Eigen::Map<MatrixXd>(g.data(), rows, 1)};
  }

  /// Column by column.
  Result InFull() const {
    const Index b = border, rows = 2 * node + b;
    Exact H = block.cast<long double>();
    H.topLeftCorner(node, node) += edge.topLeftCorner(node, node).cast<long double>();
    H.bottomLeftCorner(b, node) += edge.bottomLeftCorner(b, node).cast<long double>();
    H.bottomRightCorner(b, b) += edge.bottomRightCorner(b, b).cast<long double>();
    Exact g = gradient.cast<long double>();
    for (Index j = 0; j < node; ++j) {
      H.col(j).tail(rows - j) /= std::sqrt(H(j, j));
      g(j, 0) /= H(j, j);
      for (Index k = j + 1; k < rows; ++k) {
        g(k, 0) -= g(j, 0) * H(k, j);
        for (Index i = k; i < rows; ++i) H(i, k) -= H(k, j) * H(i, j);
      }
    }
    const Exact lower = H.triangularView<Eigen::Lower>();
    return {lower.leftCols(node).cast<double>(),
            lower.bottomRightCorner(node + b, node + b).cast<double>(), g.cast<double>()};
  }
};

TEST(NormalKernels, EliminateANodeToTheSameBitsByEveryWidth) {
  Random random(1);
  for (const auto& [node, border] : Sizes()) {
    const OneNode chain(node, border, random);
    const OneNode::Result plain = chain.By(Registers::kPlain), full = chain.InFull();
    const double size = full.panel.norm();
    EXPECT_LT((plain.panel - full.panel).norm(), 1e-12 * size) << node << " " << border;
    EXPECT_LT((plain.edge - full.edge).norm(), 1e-12 * size * size) << node << " " << border;
    EXPECT_LT((plain.gradient - full.gradient).norm(), 1e-11 * full.gradient.norm() * size);
    if (WidestRegisters() == Registers::kPlain) continue;
    const OneNode::Result wide = chain.By(Registers::kAvx2);
    EXPECT_TRUE(SameBits(plain.panel, wide.panel)) << node << " " << border;
    EXPECT_TRUE(SameBits(plain.edge, wide.edge)) << node << " " << border;
    EXPECT_TRUE(SameBits(plain.gradient, wide.gradient)) << node << " " << border;
  }
}

TEST(NormalKernels, RefuseAColumnThatIsNotPositive) {
  Random random(2);
  for (Index node = 1; node <= kNodeMax; ++node) {
    for (Index bad = 0; bad < node; ++bad) {
      OneNode chain(node, 3, random);
      chain.block.col(bad).setZero();
      chain.block.row(bad).setZero();
      const Index stride = BlockStride(node, 3);
      for (const Registers registers : {Registers::kPlain, WidestRegisters()}) {
        std::vector<double> x = Apart(chain.block, node, stride);
        EXPECT_FALSE(Factorise(registers, {x.data(), stride, node, 3})) << node << " " << bad;
      }
    }
  }
}

TEST(NormalKernels, AddTheSquareOfThreeRowsToTheSameBitsByEveryWidth) {
  Random random(3);
  for (const auto& [node, border] : Sizes()) {
    const Index size = 2 * node + border, stride = BlockStride(node, border);
    const MatrixXd block = Positive(size, random);
    MatrixXd J = MatrixXd::Zero(3, size), spread = MatrixXd::Zero(stride, 3);
    std::vector<int> at;
    for (Index j = size; j-- > 0;) {  // in any order
      if (random.Normal() < -0.5) continue;
      const auto k = static_cast<Index>(at.size());
      for (Index i = 0; i < 3; ++i) spread(j, i) = J(i, k) = random.Normal();
      at.push_back(static_cast<int>(j));
    }
    const ThreeRows rows{J.data(), at.data(), static_cast<int>(at.size())};
    const auto by = [&](Registers registers) {
      std::vector<double> sum = Apart(block, size, stride);
      AddSquare(registers, rows, spread.data(), 0.7, stride, sum.data());
      return Lower(sum, size, size, stride);
    };
    const MatrixXd plain = by(Registers::kPlain);
    const Exact over = spread.topRows(size).cast<long double>();
    const Exact full = block.cast<long double>() + 0.7L * (over * over.transpose());
    const MatrixXd lower = full.cast<double>().triangularView<Eigen::Lower>();
    EXPECT_LT((plain - lower).cwiseAbs().maxCoeff(), 1e-10) << node << " " << border;
    EXPECT_TRUE(SameBits(plain, by(WidestRegisters()))) << node << " " << border;
    const auto times = [&](Registers registers) {
      MatrixXd product(ByFours(size), 3);
      TimesThreeRows(registers, block.data(), size, rows, product.data());
      return MatrixXd(product.topRows(size));
    };
    const MatrixXd product = times(Registers::kPlain);
    const MatrixXd exact = (block.cast<long double>() * over).cast<double>();
    EXPECT_LT((product - exact).cwiseAbs().maxCoeff(), 1e-10) << node << " " << border;
    EXPECT_TRUE(SameBits(product, times(WidestRegisters()))) << node << " " << border;
  }
}

TEST(NormalKernels, MultiplyToTheSameBitsByEveryWidth) {
  Random random(4);
  const auto normals = [&](Index rows, Index columns) {
    return MatrixXd(MatrixXd::NullaryExpr(rows, columns, [&] { return random.Normal(); }));
  };
  for (const auto& [node, border] : Sizes()) {
    const Index m = node + border;
    const MatrixXd A = normals(node, m), B = normals(m, m);
    const auto by = [&](Registers registers) {
      MatrixXd product(A.rows(), m);
      Multiply(registers, {A.rows(), m, m}, A.data(), B.data(), product.data());
      return product;
    };
    const MatrixXd plain = by(Registers::kPlain);
    const Exact exact = A.cast<long double>() * B.cast<long double>().transpose();
    EXPECT_LT((plain - exact.cast<double>()).cwiseAbs().maxCoeff(), 1e-12) << node << " " << m;
    EXPECT_TRUE(SameBits(plain, by(WidestRegisters()))) << node << " " << m;
  }
}

}  // namespace
}  // namespace wellgyro

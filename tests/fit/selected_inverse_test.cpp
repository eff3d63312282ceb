#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "wellgyro/fit/selected_inverse_internal.h"
#include "wellgyro/math/random.h"

namespace wellgyro {
namespace {

// Blocks along a chain, two far links across it, and a border that touches everything, with columns
// of very different size.
Eigen::MatrixXd ChainWithBorder(int blocks, int block, int border) {
  Random random(7);
  const int n = blocks * block + border;
  std::vector<Eigen::VectorXd> rows;
  const auto add = [&](int first, int second) {
    for (int r = 0; r < block + 1; ++r) {
      Eigen::VectorXd row = Eigen::VectorXd::Zero(n);
      for (int i = 0; i < block; ++i) {
        row[first * block + i] = random.Normal();
        row[second * block + i] = random.Normal();
      }
      for (int i = 0; i < border; ++i) row[blocks * block + i] = random.Normal();
      rows.push_back(row);
    }
  };
  for (int k = 0; k + 1 < blocks; ++k) add(k, k + 1);
  add(1, blocks - 2);
  add(3, blocks - 4);
  for (int i = 0; i < n; ++i) rows.push_back(0.1 * Eigen::VectorXd::Unit(n, i));
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n);
  for (const Eigen::VectorXd& row : rows) matrix += row * row.transpose();
  Eigen::VectorXd scale(n);
  for (int i = 0; i < n; ++i) scale[i] = i % 3 == 0 ? 1e7 : 1e-2;
  return scale.asDiagonal() * matrix * scale.asDiagonal();
}

TEST(SelectedInverse, AgreesWithTheDenseInverseWhereverTheMatrixHasAnElement) {
  const int blocks = 40, block = 3, border = 4;
  const Eigen::MatrixXd dense = ChainWithBorder(blocks, block, border);
  const SelectedInverse selected(Eigen::SparseMatrix<double>(dense.sparseView()));
  ASSERT_TRUE(selected.ok());
  const Eigen::MatrixXd inverse =
      dense.ldlt().solve(Eigen::MatrixXd::Identity(dense.rows(), dense.cols()));
  int compared = 0;
  for (int i = 0; i < dense.rows(); ++i) {
    for (int j = 0; j < dense.cols(); ++j) {
      if (dense(i, j) == 0) continue;
      const double size = std::sqrt(inverse(i, i) * inverse(j, j));
      EXPECT_NEAR(selected.At(i, j) / size, inverse(i, j) / size, 1e-9) << i << ", " << j;
      ++compared;
    }
  }
  EXPECT_GT(compared, 1000);
}

TEST(SelectedInverse, RefusesWhatHasNoInverse) {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(3, 3);
  matrix(2, 2) = 0;
  EXPECT_FALSE(SelectedInverse(Eigen::SparseMatrix<double>(matrix.sparseView())).ok());
  matrix << 1, 2, 0, 2, 1, 0, 0, 0, 1;
  EXPECT_FALSE(SelectedInverse(Eigen::SparseMatrix<double>(matrix.sparseView())).ok());
}

}  // namespace
}  // namespace wellgyro

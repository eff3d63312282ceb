#include "wellgyro/math/linear_algebra.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "wellgyro/math/random.h"

namespace wellgyro {
namespace {

using Eigen::MatrixXd;

MatrixXd Drawn(Random& random, Eigen::Index rows, Eigen::Index columns) {
  return MatrixXd::NullaryExpr(rows, columns, [&] { return random.Normal(); });
}

double Largest(const MatrixXd& m) { return m.cwiseAbs().maxCoeff(); }

// Each against the equation that defines it.
TEST(LinearAlgebra, SymmetricSystemsAreSolvedDefiniteOrNot) {
  Random random(1);
  for (const Eigen::Index n : {1, 2, 7, 40}) {
    const MatrixXd half = Drawn(random, n, n), B = Drawn(random, n, 3);
    MatrixXd indefinite = half + half.transpose();
    indefinite.diagonal().array() += 0.5;
    for (const MatrixXd& A :
         {MatrixXd(half * half.transpose() + MatrixXd::Identity(n, n)), indefinite}) {
      EXPECT_LT(Largest(A * SolveSymmetric(A, B) - B), 1e-9);
      EXPECT_LT(Largest(A * InverseOfSymmetric(A) - MatrixXd::Identity(n, n)), 1e-9);
      const SymmetricEigen eigen = EigenOfSymmetric(A);
      EXPECT_LT(Largest(A * eigen.vectors - eigen.vectors * eigen.values.asDiagonal()), 1e-10);
      for (Eigen::Index i = 1; i < n; ++i) EXPECT_LE(eigen.values[i - 1], eigen.values[i]);
    }
  }
}

TEST(LinearAlgebra, CholeskyIsTheRootOfWhatIsPositive) {
  Random random(2);
  const MatrixXd half = Drawn(random, 9, 9), B = Drawn(random, 9, 2);
  MatrixXd A = half * half.transpose() + MatrixXd::Identity(9, 9);
  const Cholesky root(A);
  ASSERT_TRUE(root.positive());
  EXPECT_LT(Largest(root.L() * root.L().transpose() - A), 1e-12);
  EXPECT_EQ(root.L()(2, 5), 0);
  EXPECT_LT(Largest(A * root.Solve(B) - B), 1e-10);
  EXPECT_LT(Largest(root.L() * root.Whitened(B) - B), 1e-12);
  EXPECT_NEAR(root.LogDeterminant(), EigenOfSymmetric(A).values.array().log().sum(), 1e-11);
  A(4, 4) = -1;
  EXPECT_FALSE(Cholesky(A).positive());
  A(4, 4) = std::nan("");
  EXPECT_FALSE(Cholesky(A).positive());
  EXPECT_FALSE(Cholesky(MatrixXd::Zero(2, 2)).positive());
}

TEST(LinearAlgebra, LeastSquaresLeaveWhatIsAtRightAnglesToTheColumns) {
  Random random(3);
  const MatrixXd A = Drawn(random, 12, 4), b = Drawn(random, 12, 1);
  const MatrixXd x = SolveLeastSquares(A, b);
  EXPECT_LT(Largest(A.transpose() * (b - A * x)), 1e-12);
  EXPECT_LT(Largest(SolveLeastNorm(A, b) - x), 1e-13);
  // Fewer rows than columns: no other solution is as short.
  const MatrixXd wide = A.transpose(), y = Drawn(random, 4, 1), least = SolveLeastNorm(wide, y);
  EXPECT_LT(Largest(wide * least - y), 1e-12);
  EXPECT_LT(Largest(least - A * SolveSymmetric(A.transpose() * A, A.transpose() * least)), 1e-12);
}

TEST(LinearAlgebra, SingularValuesPutAMatrixTogether) {
  Random random(4);
  const MatrixXd A = Drawn(random, 8, 3);
  const SingularValues svd = SingularValuesOf(A);
  EXPECT_LT(Largest(svd.U * svd.values.asDiagonal() * svd.V.transpose() - A), 1e-13);
  EXPECT_GE(svd.values[0], svd.values[2]);
  EXPECT_GT(svd.values[2], 0);
}

TEST(LinearAlgebra, FourRowsAreUndoneAndHaveADirectionOfTheirOwn) {
  Random random(5);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Matrix<double, 4, 3> A = Drawn(random, 4, 3);
    const double condition = SingularValuesOf(A).values[0] / SingularValuesOf(A).values[2];
    EXPECT_LT(Largest(LeftInverse(A) * A - Eigen::Matrix3d::Identity()),
              1e-15 * 10 * condition * condition);
    EXPECT_NEAR(UnitBeside(A).norm(), 1, 1e-15);
    EXPECT_LT(Largest(A.transpose() * UnitBeside(A)), 1e-14 * condition);
  }
}

}  // namespace
}  // namespace wellgyro

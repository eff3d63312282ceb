#include "wellgyro/math/linear_algebra.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>

namespace wellgyro {

using Eigen::MatrixXd;

MatrixXd SolveSymmetric(const MatrixRef& A, const MatrixRef& B) {
  return Eigen::LDLT<MatrixXd>(A).solve(B);
}

MatrixXd InverseOfSymmetric(const MatrixRef& A) {
  return SolveSymmetric(A, MatrixXd::Identity(A.rows(), A.cols()));
}

Cholesky::Cholesky(const MatrixRef& A) {
  const Eigen::LLT<MatrixXd> root(A);
  L_ = root.matrixL();
  // Eigen looks for pivots that are not above 0, which what is no number is not.
  positive_ = root.info() == Eigen::Success && (L_.diagonal().array() > 0).all();
}

MatrixXd Cholesky::Whitened(const MatrixRef& B) const {
  return L_.triangularView<Eigen::Lower>().solve(B);
}

MatrixXd Cholesky::Solve(const MatrixRef& B) const {
  MatrixXd x = Whitened(B);
  L_.transpose().triangularView<Eigen::Upper>().solveInPlace(x);
  return x;
}

double Cholesky::LogDeterminant() const { return 2 * L_.diagonal().array().log().sum(); }

SymmetricEigen EigenOfSymmetric(const MatrixRef& A) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(A);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

SingularValues SingularValuesOf(const MatrixRef& A) {
  const Eigen::JacobiSVD<MatrixXd> svd(A, Eigen::ComputeThinU | Eigen::ComputeThinV);
  return {svd.matrixU(), svd.matrixV(), svd.singularValues()};
}

MatrixXd SolveLeastSquares(const MatrixRef& A, const MatrixRef& B) {
  return Eigen::ColPivHouseholderQR<MatrixXd>(A).solve(B);
}

MatrixXd SolveLeastNorm(const MatrixRef& A, const MatrixRef& B, double threshold) {
  Eigen::CompleteOrthogonalDecomposition<MatrixXd> decomposition;
  if (threshold >= 0) decomposition.setThreshold(threshold);
  return decomposition.compute(A).solve(B);
}

Eigen::Matrix<double, 3, 4> LeftInverse(const Eigen::Matrix<double, 4, 3>& A) {
  const Eigen::Matrix3d normal = A.transpose() * A;
  return normal.inverse() * A.transpose();
}

Eigen::Vector4d UnitBeside(const Eigen::Matrix<double, 4, 3>& A) {
  Eigen::Vector4d beside;
  for (int left = 0; left < 4; ++left) {
    Eigen::Matrix3d others;
    for (int row = 0; row < 3; ++row) others.row(row) = A.row(row < left ? row : row + 1);
    beside[left] = (left % 2 == 0 ? 1 : -1) * others.determinant();
  }
  return beside.normalized();
}

}  // namespace wellgyro

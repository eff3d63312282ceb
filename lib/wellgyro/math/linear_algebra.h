#pragma once

#include <Eigen/Core>

#include "wellgyro/base/export.h"

/// Decompositions of dense matrices, compiled once for every room: written out where they are used,
/// they are half of what a numeric room takes to compile. They allocate; on hot paths Eigen's own
/// of fixed size stand.
namespace wellgyro {

using MatrixRef = Eigen::Ref<const Eigen::MatrixXd>;

/// A^-1 B of a symmetric A, definite or not, by LDL^T with pivoting: off by some cond(A) 2^-53 of
/// itself. A pivot of 0 counts for nothing: where A may be singular, ask before.
WELLGYRO_EXPORT Eigen::MatrixXd SolveSymmetric(const MatrixRef& A, const MatrixRef& B);
WELLGYRO_EXPORT Eigen::MatrixXd InverseOfSymmetric(const MatrixRef& A);

/// A = L L^T of a symmetric matrix whose lower triangle is read.
class WELLGYRO_EXPORT Cholesky {
 public:
  Cholesky() = default;
  explicit Cholesky(const MatrixRef& A);

  /// Whether A is positive definite, to rounding, and all numbers; what follows holds only then.
  bool positive() const { return positive_; }
  const Eigen::MatrixXd& L() const { return L_; }      ///< with zeros above the diagonal
  Eigen::MatrixXd Solve(const MatrixRef& B) const;     ///< A^-1 B
  Eigen::MatrixXd Whitened(const MatrixRef& B) const;  ///< L^-1 B
  double LogDeterminant() const;                       ///< ln det A

 private:
  Eigen::MatrixXd L_;
  bool positive_ = false;
};

/// A = vectors diag(values) vectors^T of a symmetric matrix; values rise.
struct SymmetricEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
WELLGYRO_EXPORT SymmetricEigen EigenOfSymmetric(const MatrixRef& A);

/// A = U diag(values) V^T, thin; values fall.
struct SingularValues {
  Eigen::MatrixXd U, V;
  Eigen::VectorXd values;
};
WELLGYRO_EXPORT SingularValues SingularValuesOf(const MatrixRef& A);

/// The x of least |A x - B|, by QR with pivoting of columns, for A of full rank.
WELLGYRO_EXPORT Eigen::MatrixXd SolveLeastSquares(const MatrixRef& A, const MatrixRef& B);
/// That of least |x| among them, where columns that add less than `threshold` of the largest to the
/// others add nothing; negative: Eigen's own.
WELLGYRO_EXPORT Eigen::MatrixXd SolveLeastNorm(const MatrixRef& A, const MatrixRef& B,
                                               double threshold = -1);

/// Of three independent columns of four rows, without allocation: (A^T A)^-1 A^T, off by
/// cond(A)^2 2^-53 of itself; and the unit vector at right angles to all three, by their minors.
WELLGYRO_EXPORT Eigen::Matrix<double, 3, 4> LeftInverse(const Eigen::Matrix<double, 4, 3>& A);
WELLGYRO_EXPORT Eigen::Vector4d UnitBeside(const Eigen::Matrix<double, 4, 3>& A);

}  // namespace wellgyro

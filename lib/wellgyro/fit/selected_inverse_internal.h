#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "wellgyro/base/export.h"

namespace wellgyro {

/// Those elements of the inverse of a symmetric positive definite sparse matrix where its Cholesky
/// factor has one, in time and memory of the factorisation. Takahashi, Fagan, Chen, "Formation of a
/// sparse bus impedance matrix", PICA (1973); Erisman and Tinney, CACM 18 (1975).
class WELLGYRO_EXPORT SelectedInverse {
 public:
  /// `matrix`: both triangles. Not positive definite, or singular to rounding: ok() is false.
  explicit SelectedInverse(const Eigen::SparseMatrix<double>& matrix);

  bool ok() const { return ok_; }
  /// Element (i, j). Zero outside the pattern.
  double At(int i, int j) const;

 private:
  int Find(int row, int column) const;

  bool ok_ = false;
  Eigen::VectorXd scale_;
  std::vector<int> place_;                // of an index among the pivots
  std::vector<int> begin_, row_;          // columns of the factor below its diagonal
  std::vector<double> below_, diagonal_;  // of the inverse
};

}  // namespace wellgyro

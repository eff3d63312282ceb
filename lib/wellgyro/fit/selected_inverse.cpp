#include <algorithm>
#include <cmath>

#include <Eigen/SparseCholesky>

#include "wellgyro/fit/selected_inverse_internal.h"

namespace wellgyro {

SelectedInverse::SelectedInverse(const Eigen::SparseMatrix<double>& matrix) {
  if (matrix.rows() == 0) return;
  // Unknowns differ by ten orders of magnitude.
  scale_ = matrix.diagonal();
  if (!(scale_.minCoeff() > 0)) return;
  scale_ = scale_.cwiseSqrt().cwiseInverse();
  const Eigen::SparseMatrix<double> scaled = scale_.asDiagonal() * matrix * scale_.asDiagonal();
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::AMDOrdering<int>>
      factor(scaled);
  if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > 0)) return;
  ok_ = true;

  const auto& lower = factor.matrixL().nestedExpression();
  const int n = static_cast<int>(matrix.cols());
  const auto& permutation = factor.permutationP().indices();
  place_.assign(permutation.data(), permutation.data() + n);
  begin_.assign(lower.outerIndexPtr(), lower.outerIndexPtr() + n + 1);
  row_.assign(lower.innerIndexPtr(), lower.innerIndexPtr() + begin_.back());
  below_.assign(row_.size(), 0.0);
  diagonal_.assign(static_cast<std::size_t>(n), 0.0);

  const double* l = lower.valuePtr();
  std::vector<int> where(static_cast<std::size_t>(n), -1);
  const auto at = [](int i) { return static_cast<std::size_t>(i); };
  for (int j = n; j-- > 0;) {
    const int begin = begin_[at(j)], end = begin_[at(j) + 1];
    for (int e = begin; e < end; ++e) where[at(row_[at(e)])] = e;
    for (int e = begin; e < end; ++e) {
      const int k = row_[at(e)];
      below_[at(e)] -= l[e] * diagonal_[at(k)];
      for (int f = begin_[at(k)]; f < begin_[at(k) + 1]; ++f) {
        const int i = where[at(row_[at(f)])];
        if (i < 0) continue;
        below_[at(i)] -= l[e] * below_[at(f)];
        below_[at(e)] -= l[i] * below_[at(f)];
      }
    }
    double sum = 1 / factor.vectorD()[j];
    for (int e = begin; e < end; ++e) {
      sum -= l[e] * below_[at(e)];
      where[at(row_[at(e)])] = -1;
    }
    diagonal_[at(j)] = sum;
  }
}

int SelectedInverse::Find(int row, int column) const {
  const auto begin = row_.begin() + begin_[static_cast<std::size_t>(column)];
  const auto end = row_.begin() + begin_[static_cast<std::size_t>(column) + 1];
  const auto found = std::lower_bound(begin, end, row);
  return found != end && *found == row ? static_cast<int>(found - row_.begin()) : -1;
}

double SelectedInverse::At(int i, int j) const {
  const int a = place_[static_cast<std::size_t>(i)], b = place_[static_cast<std::size_t>(j)];
  const double scale = scale_[i] * scale_[j];
  if (a == b) return scale * diagonal_[static_cast<std::size_t>(a)];
  const int found = Find(std::max(a, b), std::min(a, b));
  return found >= 0 ? scale * below_[static_cast<std::size_t>(found)] : 0;
}

}  // namespace wellgyro

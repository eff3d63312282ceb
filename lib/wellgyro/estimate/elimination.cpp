#include "wellgyro/estimate/elimination.h"

#include <cmath>

#include <Eigen/Cholesky>

namespace wellgyro {
namespace {

// Products of some ten by twenty numbers: plain loops over columns are three times as fast as what
// is made for large ones.

/// Solves L X = X in place, L lower triangular.
template <class Lower, class Columns>
void SolveLower(const Lower& L, Columns& X) {
  const Eigen::Index n = L.rows();
  for (Eigen::Index j = 0; j < X.cols(); ++j) {
    double* x = X.data() + j * n;
    for (Eigen::Index k = 0; k < n; ++k) {
      const double* l = L.data() + k * n;
      const double at = x[k] /= l[k];
      for (Eigen::Index i = k + 1; i < n; ++i) x[i] -= at * l[i];
    }
  }
}

/// A -= B'B, in its lower triangle.
void Downdate(const BehindMatrix& B, EdgeMatrix& A) {
  const Eigen::Index n = B.rows(), m = B.cols();
  for (Eigen::Index j = 0; j < m; ++j) {
    const double* b = B.data() + j * n;
    double* a = A.data() + j * m;
    for (Eigen::Index i = j; i < m; ++i) {
      const double* c = B.data() + i * n;
      double sum = 0;
      for (Eigen::Index k = 0; k < n; ++k) sum += b[k] * c[k];
      a[i] -= sum;
    }
  }
}

}  // namespace

void Elimination::Start(std::size_t nodes, const EdgeMatrix& information,
                        const EdgeVector& gradient) {
  conditionals_.clear();
  conditionals_.reserve(nodes);
  information_ = information;
  gradient_ = gradient;
  log_determinant_ = decrement_ = 0;
  solved_ = false;
}

bool Elimination::Step(NormalBlock& block) {
  const int n = layout_->node, b = layout_->border, m = n + b;
  NormalBlock::Matrix& A = block.information();
  NormalBlock::Vector& g = block.gradient();
  // [node | next | border] += [node | border] of what came before.
  A.topLeftCorner(n, n) += information_.topLeftCorner(n, n);
  A.bottomLeftCorner(b, n) += information_.bottomLeftCorner(b, n);
  A.bottomRightCorner(b, b) += information_.bottomRightCorner(b, b);
  g.head(n) += gradient_.head(n);
  g.tail(b) += gradient_.tail(b);

  const Eigen::LLT<NodeMatrix> llt(NodeMatrix(A.topLeftCorner(n, n)));
  if (llt.info() != Eigen::Success) return false;
  Conditional& c = conditionals_.emplace_back();
  c.L = llt.matrixL();
  c.behind = A.bottomLeftCorner(m, n).transpose();
  SolveLower(c.L, c.behind);
  c.gradient = g.head(n);
  SolveLower(c.L, c.gradient);
  information_ = A.bottomRightCorner(m, m);
  Downdate(c.behind, information_);
  gradient_ = g.tail(m) - c.behind.transpose() * c.gradient;
  log_determinant_ += 2 * c.L.diagonal().array().log().sum();
  decrement_ += c.gradient.squaredNorm();
  return std::isfinite(log_determinant_);
}

bool Elimination::Solve(std::vector<NodeVector>& nodes, BorderVector& border) {
  const int n = layout_->node, b = layout_->border;
  const Eigen::LLT<EdgeMatrix> llt(information_);
  if (llt.info() != Eigen::Success) return false;
  last_ = llt.matrixL();
  EdgeVector x = llt.solve(-gradient_);
  log_determinant_ += 2 * last_.diagonal().array().log().sum();
  decrement_ -= x.dot(gradient_);
  if (!x.allFinite()) return false;
  solved_ = true;
  border = x.tail(b);
  nodes.resize(conditionals_.size() + 1);
  nodes.back() = x.head(n);
  for (std::size_t k = conditionals_.size(); k-- > 0;) {
    const Conditional& c = conditionals_[k];
    NodeVector y = -c.gradient - c.behind * x;
    c.L.triangularView<Eigen::Lower>().transpose().solveInPlace(y);
    nodes[k] = y;
    x.head(n) = y;
  }
  return true;
}

EdgeMatrix Elimination::LastCovariance() const {
  const auto m = last_.rows();
  EdgeMatrix inverse = EdgeMatrix::Identity(m, m);
  last_.triangularView<Eigen::Lower>().solveInPlace(inverse);
  return inverse.transpose() * inverse;
}

BehindMatrix Elimination::Gain(std::size_t k) const {
  BehindMatrix gain = -conditionals_[k].behind;
  conditionals_[k].L.triangularView<Eigen::Lower>().transpose().solveInPlace(gain);
  return gain;
}

NodeMatrix Elimination::Remainder(std::size_t k) const {
  NodeMatrix inverse = NodeMatrix::Identity(layout_->node, layout_->node);
  conditionals_[k].L.triangularView<Eigen::Lower>().solveInPlace(inverse);
  return inverse.transpose() * inverse;
}

EdgeMatrix Elimination::CovarianceBefore(std::size_t k, const BehindMatrix& gain,
                                         const EdgeMatrix& next, BehindMatrix& with_next) const {
  const int n = layout_->node, b = layout_->border;
  with_next = gain * next;
  EdgeMatrix before(n + b, n + b);
  before.topLeftCorner(n, n) = Remainder(k) + with_next * gain.transpose();
  before.topRightCorner(n, b) = with_next.rightCols(b);
  before.bottomLeftCorner(b, n) = with_next.rightCols(b).transpose();
  before.bottomRightCorner(b, b) = next.bottomRightCorner(b, b);
  return before;
}

}  // namespace wellgyro

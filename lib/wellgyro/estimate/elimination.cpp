#include "wellgyro/estimate/elimination.h"

#include <cmath>

#include <Eigen/Cholesky>

namespace wellgyro {

void Elimination::Start(std::size_t nodes, const EdgeMatrix& information,
                        const EdgeVector& gradient) {
  conditionals_.clear();
  conditionals_.reserve(nodes);
  information_ = information;
  gradient_ = gradient;
  log_determinant_ = decrement_ = 0;
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
  c.L.triangularView<Eigen::Lower>().solveInPlace(c.behind);
  c.gradient = g.head(n);
  c.L.triangularView<Eigen::Lower>().solveInPlace(c.gradient);
  information_ = A.bottomRightCorner(m, m);
  information_.selfadjointView<Eigen::Lower>().rankUpdate(c.behind.transpose(), -1);
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

#include "wellgyro/estimate/elimination.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>

#include "wellgyro/estimate/normal_kernels_internal.h"

namespace wellgyro {
namespace {

using Eigen::Index;

/// C = A B'.
template <class Left, class Right, class Out>
void Multiply(const Left& A, const Right& B, Out& out) {
  out.resize(A.rows(), B.rows());
  Multiply(WidestRegisters(), {A.rows(), B.rows(), A.cols()}, A.data(), B.data(), out.data());
}

}  // namespace

void Elimination::Start(std::size_t nodes, const EdgeMatrix& information,
                        const EdgeVector& gradient) {
  const Index n = layout_->node, b = layout_->border, m = n + b;
  rows_ = n + m;
  stride_ = BlockStride(n, b);
  edge_stride_ = ByFours(m);
  conditionals_.resize(nodes * ConditionalSize());
  eliminated_ = 0;
  std::fill_n(information_.begin(), edge_stride_ * m, 0.0);
  Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>>(
      information_.data(), m, m, Eigen::OuterStride<>(edge_stride_)) = information;
  gradient_ = gradient;
  log_determinant_ = decrement_ = 0;
  solved_ = false;
}

bool Elimination::Step(const NormalBlock& block) {
  const Index n = layout_->node, b = layout_->border, m = n + b;
  const Registers registers = WidestRegisters();
  const NodePanel panel{conditionals_.data() + eliminated_ * ConditionalSize(), stride_, n, b};
  const EdgeColumns edge{information_.data(), edge_stride_};
  const double* A = block.information().data();
  Begin(registers, A, edge, panel);
  if (!Factorise(registers, panel)) return false;
  alignas(32) std::array<double, kBlockStrideMost> numbers;
  std::fill(numbers.begin() + rows_, numbers.begin() + stride_, 0.0);
  Eigen::Map<Eigen::VectorXd> g(numbers.data(), rows_);
  g = block.gradient();
  g.head(n) += gradient_.head(n);
  g.tail(b) += gradient_.tail(b);
  Forward(registers, panel, numbers.data());
  double scale = 1;
  for (Index j = 0; j < n; ++j) scale *= panel.column(j)[j];
  Succeed(registers, panel, A, edge);
  gradient_ = g.tail(m);
  log_determinant_ += 2 * std::log(scale);
  decrement_ += g.head(n).squaredNorm();
  Keep(numbers.data());
  return std::isfinite(log_determinant_);
}

/// Stores the node's gradient, forward-substituted, behind its columns of the factor.
void Elimination::Keep(const double* gradient) {
  double* panel = conditionals_.data() + eliminated_ * ConditionalSize();
  std::copy_n(gradient, layout_->node, panel + layout_->node * stride_);
  ++eliminated_;
}

bool Elimination::Solve(std::vector<NodeVector>& nodes, BorderVector& border) {
  const int n = layout_->node, b = layout_->border;
  const Eigen::LLT<EdgeMatrix> llt(edge_information());
  if (llt.info() != Eigen::Success) return false;
  last_ = llt.matrixL();
  const EdgeVector last = llt.solve(-gradient_);
  log_determinant_ += 2 * last_.diagonal().array().log().sum();
  decrement_ -= last.dot(gradient_);
  if (!last.allFinite()) return false;
  solved_ = true;
  border = last.tail(b);
  nodes.resize(eliminated_ + 1);
  nodes.back() = last.head(n);
  NormalBlock::Vector x(rows_);
  x.tail(b) = border;
  for (std::size_t k = eliminated_; k-- > 0;) {
    const Columns panel = PanelOf(k);
    x.segment(n, n) = nodes[k + 1];
    x.head(n) = -Eigen::Map<const Eigen::VectorXd>(panel.data() + n * stride_, n);
    Substitute(k, x);
    nodes[k] = x.head(n);
  }
  return true;
}

void Elimination::Eliminate(std::size_t k, Eigen::Ref<Eigen::MatrixXd> x) const {
  const Columns panel = PanelOf(k);
  for (Index q = 0; q < x.cols(); ++q) {
    for (Index j = 0; j < panel.cols(); ++j) {
      const Index behind = rows_ - j - 1;
      const double at = x(j, q) /= panel(j, j);
      x.col(q).tail(behind) -= at * panel.col(j).tail(behind);
    }
  }
}

void Elimination::Substitute(std::size_t k, Eigen::Ref<Eigen::MatrixXd> x) const {
  const Columns panel = PanelOf(k);
  for (Index q = 0; q < x.cols(); ++q) {
    for (Index j = panel.cols(); j-- > 0;) {
      const Index behind = rows_ - j - 1;
      x(j, q) = (x(j, q) - panel.col(j).tail(behind).dot(x.col(q).tail(behind))) / panel(j, j);
    }
  }
}

EdgeMatrix Elimination::LastCovariance() const {
  const auto m = last_.rows();
  EdgeMatrix inverse = EdgeMatrix::Identity(m, m);
  last_.triangularView<Eigen::Lower>().solveInPlace(inverse);
  return inverse.transpose() * inverse;
}

Eigen::Matrix3d Elimination::LastCovarianceOfPhi() const {
  const auto m = last_.rows();
  Eigen::Matrix<double, Eigen::Dynamic, 3, 0, kNodeMax + kBorderMax, 3> x(m, 3);
  x.setIdentity();
  last_.triangularView<Eigen::Lower>().solveInPlace(x);
  return x.transpose() * x;
}

BehindMatrix Elimination::Gain(std::size_t k) const {
  const Index n = layout_->node, m = rows_ - n;
  const Columns panel = PanelOf(k);
  // By columns of its transpose, which are long.
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kNodeMax + kBorderMax, kNodeMax> gain =
      -panel.bottomRows(m);
  for (Index j = n; j-- > 0;) {
    for (Index i = j + 1; i < n; ++i) gain.col(j) -= panel(i, j) * gain.col(i);
    gain.col(j) /= panel(j, j);
  }
  return gain.transpose();
}

NodeMatrix Elimination::Remainder(std::size_t k) const {
  const Index n = layout_->node;
  NodeMatrix inverse = NodeMatrix::Identity(n, n);
  PanelOf(k).topRows(n).triangularView<Eigen::Lower>().solveInPlace(inverse);
  return inverse.transpose() * inverse;
}

EdgeMatrix Elimination::CovarianceThrough(const BehindMatrix& gain, const NodeMatrix& remainder,
                                          const EdgeMatrix& next, BehindMatrix& with_next) {
  const Index n = gain.rows(), b = gain.cols() - n;
  Multiply(gain, next, with_next);
  NodeMatrix by_next;
  Multiply(with_next, gain, by_next);
  EdgeMatrix before(n + b, n + b);
  before.topLeftCorner(n, n) = remainder + by_next;
  before.topRightCorner(n, b) = with_next.rightCols(b);
  before.bottomLeftCorner(b, n) = with_next.rightCols(b).transpose();
  before.bottomRightCorner(b, b) = next.bottomRightCorner(b, b);
  return before;
}

BlockMatrix JointCovariance(const EdgeMatrix& begin, const BehindMatrix& begin_with_end,
                            const EdgeMatrix& end) {
  const Index n = begin_with_end.rows(), m = begin_with_end.cols();
  BlockMatrix joint(n + m, n + m);
  joint.topLeftCorner(n, n) = begin.topLeftCorner(n, n);
  joint.topRightCorner(n, m) = begin_with_end;
  joint.bottomLeftCorner(m, n) = begin_with_end.transpose();
  joint.bottomRightCorner(m, m) = end;
  return joint;
}

}  // namespace wellgyro

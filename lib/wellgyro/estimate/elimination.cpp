#include "wellgyro/estimate/elimination.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>

namespace wellgyro {
namespace {

using Eigen::Index;
using Eigen::Matrix4d;
using Eigen::Vector4d;

// Products of some ten by twenty numbers: squares of four by four whose sums stay in registers are
// four times as fast as what is made for large matrices. Every sum runs in one order, so that it
// has one result on every processor.

constexpr Index kRowsMost = 2 * kNodeMax + kBorderMax + 3;

/// A B' of R and C rows of matrices whose columns stand this far apart.
template <int R, int C>
[[gnu::always_inline]] inline Eigen::Matrix<double, R, C> Product(const double* A, Index a_stride,
                                                                  const double* B, Index b_stride,
                                                                  Index columns) {
  Eigen::Matrix<double, R, C> sum = Eigen::Matrix<double, R, C>::Zero();
  for (Index k = 0; k < columns; ++k, A += a_stride, B += b_stride) {
    const Eigen::Map<const Eigen::Matrix<double, R, 1>> a(A);
    const Eigen::Map<const Eigen::Matrix<double, C, 1>> b(B);
    sum += a * b.transpose();
  }
  return sum;
}

/// C = A B'.
template <class Left, class Right, class Out>
void Multiply(const Left& A, const Right& B, Out& out) {
  const Index rows = A.rows(), columns = B.rows(), inner = A.cols();
  const auto put = [&]<int R, int C>(Index i, Index j) {
    out.template block<R, C>(i, j) =
        Product<R, C>(A.data() + i, rows, B.data() + j, columns, inner);
  };
  const auto column = [&]<int C>(Index j) {
    Index i = 0;
    for (; i + 4 <= rows; i += 4) put.template operator()<4, C>(i, j);
    for (; i < rows; ++i) put.template operator()<1, C>(i, j);
  };
  out.resize(rows, columns);
  Index j = 0;
  for (; j + 4 <= columns; j += 4) column.template operator()<4>(j);
  for (; j < columns; ++j) column.template operator()<1>(j);
}

/// Columns of a lower triangle that are read by fours: past the end of each stand up to six numbers
/// that count for nothing.
struct Panel {
  Index stride;
  std::array<double, kRowsMost * kNodeMax> values;

  Panel(Index rows, Index columns) : stride((rows + 3) / 4 * 4 + 3) {
    for (Index j = 0; j < columns; ++j) {
      std::fill_n(column(j), j, 0.0);
      std::fill(column(j) + rows, column(j) + stride, 0.0);
    }
  }
  double* column(Index j) { return values.data() + j * stride; }
  /// Rows i to i + 3 times the transpose of rows j to j + 3, over the first columns.
  Matrix4d Square(Index i, Index j, Index columns) const {
    return Product<4, 4>(values.data() + i, stride, values.data() + j, stride, columns);
  }
};

/// Replaces `n` columns of a matrix by those of its Cholesky factor, in its lower triangle. False
/// where it is not positive.
bool Factorise(Panel& panel, Index n, Index rows) {
  for (Index begin = 0; begin < n; begin += 4) {
    const Index end = std::min(begin + 4, n);
    for (Index i = begin; i < rows && begin > 0; i += 4) {
      const Matrix4d known = panel.Square(i, begin, begin);
      for (Index j = begin; j < end; ++j) {
        Eigen::Map<Vector4d>(panel.column(j) + i) -= known.col(j - begin);
      }
    }
    for (Index j = begin; j < end; ++j) {
      double* x = panel.column(j);
      if (!(x[j] > 0)) return false;
      x[j] = std::sqrt(x[j]);
      const double by = 1 / x[j];
      for (Index i = j + 1; i < rows; ++i) x[i] *= by;
      for (Index k = j + 1; k < end; ++k) {
        double* y = panel.column(k);
        for (Index i = k; i < rows; ++i) y[i] -= x[k] * x[i];
      }
    }
  }
  return true;
}

/// A -= B B' in the lower triangle of A, B being the rows of the panel from `first` on.
void Downdate(const Panel& panel, Index first, Index columns, EdgeMatrix& A) {
  const Index m = A.rows();
  for (Index j = 0; j < m; j += 4) {
    for (Index i = j; i < m; i += 4) {
      const Matrix4d known = panel.Square(first + i, first + j, columns);
      for (Index c = 0; c < std::min<Index>(4, m - j); ++c) {
        for (Index r = i == j ? c : 0; r < std::min<Index>(4, m - i); ++r) {
          A(i + r, j + c) -= known(r, c);
        }
      }
    }
  }
}

}  // namespace

void Elimination::Start(std::size_t nodes, const EdgeMatrix& information,
                        const EdgeVector& gradient) {
  rows_ = 2 * layout_->node + layout_->border;
  conditionals_.resize(nodes * ConditionalSize());
  eliminated_ = 0;
  information_ = information;
  gradient_ = gradient;
  log_determinant_ = decrement_ = 0;
  solved_ = false;
}

bool Elimination::Step(const NormalBlock& block) {
  const int n = layout_->node, b = layout_->border, m = n + b;
  const NormalBlock::Matrix& A = block.information();
  Panel panel(rows_, n);
  for (Index j = 0; j < n; ++j) {
    Eigen::Map<Eigen::VectorXd> x(panel.column(j), rows_);
    x.tail(rows_ - j) = A.col(j).tail(rows_ - j);
    x.segment(j, n - j) += information_.col(j).segment(j, n - j);
    x.tail(b) += information_.col(j).tail(b);
  }
  if (!Factorise(panel, n, rows_)) return false;
  NormalBlock::Vector g = block.gradient();
  g.head(n) += gradient_.head(n);
  g.tail(b) += gradient_.tail(b);
  double scale = 1;
  for (Index j = 0; j < n; ++j) {
    const double* x = panel.column(j);
    scale *= x[j];
    g[j] /= x[j];
    for (Index i = j + 1; i < rows_; ++i) g[i] -= g[j] * x[i];
  }
  Keep(panel.column(0), panel.stride, g);
  information_.leftCols(n) = A.block(n, n, m, n);
  for (Index j = n; j < m; ++j) information_.col(j).tail(m - j) += A.col(n + j).tail(m - j);
  Downdate(panel, n, n, information_);
  gradient_ = g.tail(m);
  log_determinant_ += 2 * std::log(scale);
  decrement_ += g.head(n).squaredNorm();
  return std::isfinite(log_determinant_);
}

void Elimination::Keep(const double* panel, Eigen::Index stride, const NormalBlock::Vector& g) {
  double* to = conditionals_.data() + eliminated_ * ConditionalSize();
  for (int j = 0; j < layout_->node; ++j, to += rows_) {
    std::copy_n(panel + j * stride, rows_, to);
  }
  std::copy_n(g.data(), layout_->node, to);
  ++eliminated_;
}

bool Elimination::Solve(std::vector<NodeVector>& nodes, BorderVector& border) {
  const int n = layout_->node, b = layout_->border;
  const Eigen::LLT<EdgeMatrix> llt(information_);
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
    x.head(n) = -Eigen::Map<const Eigen::VectorXd>(panel.data() + panel.size(), n);
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

}  // namespace wellgyro

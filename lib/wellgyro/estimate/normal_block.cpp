#include "wellgyro/estimate/normal_block.h"

#include <algorithm>
#include <cmath>

#include "wellgyro/base/angle.h"
#include "wellgyro/estimate/normal_kernels_internal.h"

namespace wellgyro {
namespace {

// Huber (1964) for the norm of n rows: at 3 normal residuals are used to 99.91 % of their
// information where n is 2, to 99.82 % where it is 3 (at 1.345 and n = 1 to 95 %), and one knot
// weighs no more than 3 sigmas. At 1.5 and at 6 the ends of three clean runs move by 0.03 sigma.
constexpr double kHuber = 3;
// Student's t: a tool that starts and stops to roll has rates with tails as those of 5 degrees. At
// 2.5 and at 10 the ends of three clean runs move by 0.07 sigma.
constexpr double kDegrees = 5;

struct Loss {
  double weight = 1;
  double cost = 0;
};

/// E[min(x'x, k |x|)] / n of n standard normal x, by the upper tails Q of chi with n + 1 and n + 2
/// degrees: E[x'x; |x| < k] = n (1 - Q_n+2), E[|x|; |x| > k] = (E |x|) Q_n+1.
double HuberExpected(int n, double k) {
  const double normal = std::exp(-0.5 * k * k), tail = std::erfc(k / std::sqrt(2.0));
  const double q2 = normal, q3 = tail + std::sqrt(2 / kPi) * k * normal,
               q4 = (1 + 0.5 * k * k) * normal,
               q5 = q3 + std::sqrt(2 / kPi) * k * k * k / 3 * normal;
  switch (n) {
    case 1:
      return 1 - q3 + k * std::sqrt(2 / kPi) * q2;
    case 2:
      return 1 - q4 + k * std::sqrt(kPi / 2) * q3 / 2;
    default:
      return 1 - q5 + k * std::sqrt(8 / kPi) * q4 / 3;
  }
}

bool HasHuber(RowKind kind) {
  return kind == RowKind::kTurn || kind == RowKind::kStill || kind == RowKind::kForce ||
         kind == RowKind::kDepth;
}

/// Huber's loss; Student's t for changes of the roll rate. Huber's weight never exceeds 1: a gyro
/// factor has next to no redundancy, so that nothing would contradict a weight above 1 and the
/// covariance would come out too small.
Loss LossOf(const Factor& f) {
  const double square = f.r.head(f.rows).squaredNorm();
  if (f.kind == RowKind::kRoll) {
    const double n = f.rows;
    return {f.held > 0 ? f.held : RollWeight(square, f.rows),
            (kDegrees + n) * std::log1p(square / kDegrees)};
  }
  const double norm = std::sqrt(square);
  if (!HasHuber(f.kind) || norm <= kHuber) return {1, square};
  return {kHuber / norm, kHuber * (2 * norm - kHuber)};
}

/// Sum of squares by which the noise is judged: of the rows that measure, less the lateral part of
/// a force. That one measures the roll alone, whose walk is wider than most tools roll, and keeps
/// less than the model says, on clean runs .83 to .88 of it.
double SquareOf(const Factor& f) {
  const double lateral = f.shrink != 0 ? f.u.dot(f.r) : 0;
  return f.r.head(f.measured).squaredNorm() - lateral * lateral;
}

/// Expectation of the weighted sum of squares, where the unknowns absorb `absorbed` of n rows:
/// residuals keep the variance 1 - absorbed/n, so that Huber's loss begins at
/// kHuber / sqrt(1 - absorbed/n) of their own sigmas.
double FreedomOf(const Factor& f, const Eigen::Matrix3d& absorbed) {
  const double all = std::max(0.0, f.measured - absorbed.diagonal().head(f.measured).sum());
  const double lateral = f.shrink != 0 ? std::max(0.0, 1 - f.u.dot(absorbed * f.u)) : 0;
  const double left = std::max(0.0, all - lateral);
  if (!HasHuber(f.kind) || left == 0) return left;
  return left * HuberExpected(f.measured, kHuber / std::sqrt(all / f.measured));
}

}  // namespace

Factor& Factor::operator=(const Factor& other) {
  kind = other.kind;
  rows = other.rows;
  measured = other.measured;
  held = other.held;
  per_unit = other.per_unit;
  u = other.u;
  shrink = other.shrink;
  columns = other.columns;
  std::copy_n(other.column.begin(), columns, column.begin());
  J.leftCols(columns) = other.J.leftCols(columns);
  r = other.r;
  return *this;
}

Eigen::Matrix3d CovarianceOf(const Factor& f, const BlockMatrix& cov) {
  alignas(32) std::array<double, 3 * kBlockStrideMost> by_row;
  TimesThreeRows(WidestRegisters(), cov.data(), cov.rows(),
                 {f.J.data(), f.column.data(), f.columns}, by_row.data());
  const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 3>, 0, Eigen::OuterStride<>> with(
      by_row.data(), cov.rows(), 3, Eigen::OuterStride<>(ByFours(cov.rows())));
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (int j = 0; j < f.columns; ++j) {
    sum += f.J.col(j) * with.row(f.column[static_cast<std::size_t>(j)]);
  }
  // What a factor of fewer rows has of others is not filled in.
  sum.bottomRows(3 - f.rows).setZero();
  sum.rightCols(3 - f.rows).setZero();
  return sum;
}

NormalBlock::Vector NormalBlock::Column(int at) const {
  const auto all = information();
  Vector column = all.col(at);
  column.head(at) = all.row(at).head(at).transpose();
  return column;
}

double RollWeight(double square, int n) { return (kDegrees + n) / (kDegrees + square); }

void NormalBlock::Clear(const Layout& layout) {
  const Eigen::Index rows = 2 * layout.node + layout.border;
  const bool begun = node_ == layout.node && size() == rows;
  node_ = layout.node;
  stride_ = BlockStride(layout.node, layout.border);
  gradient_.setZero(rows);
  // Above the diagonal stands what counts for nothing, see AddSquare(), but it is to be a number.
  for (Eigen::Index j = 0; j < rows; ++j) {
    double* column = information_.data() + j * stride_;
    std::fill(column + (begun ? j : 0), column + stride_, 0.0);
  }
}

void NormalBlock::Add(const Factor& f) {
  if (collected_ != nullptr) {
    collected_->push_back(f);
    return;
  }
  Loss loss = LossOf(f);
  if (without_loss_ && f.kind != RowKind::kRoll) loss.weight = 1;
  RowSum& sum = sums_[static_cast<std::size_t>(f.kind)];
  const double square = SquareOf(f);
  sum.squares += square;
  sum.weighted += loss.weight * square;
  sum.cost += loss.cost;
  sum.rows += f.shrink != 0 ? f.measured - 1 : f.measured;
  if (covariance_ != nullptr) {
    sum.freedom += FreedomOf(f, CovarianceOf(f, *covariance_));
    return;
  }
  if (f.rows == 3) {
    AddDense(f, loss.weight);
  } else {
    AddSparse(f, loss.weight);
  }
}

/// Rows that reach few columns.
void NormalBlock::AddSparse(const Factor& f, double weight) {
  auto sum = information();
  for (int j = 0; j < f.columns; ++j) {
    const int cj = f.column[static_cast<std::size_t>(j)];
    const Eigen::Vector3d wj = weight * f.J.col(j);
    for (int i = 0; i < f.rows; ++i) gradient_[cj] += wj[i] * f.r[i];
    for (int k = 0; k <= j; ++k) {
      const int ck = f.column[static_cast<std::size_t>(k)];
      double h = 0;
      for (int i = 0; i < f.rows; ++i) h += wj[i] * f.J(i, k);
      sum(std::max(cj, ck), std::min(cj, ck)) += h;
    }
  }
}

/// Rows that reach most columns: spread out over all of them, so that sums run along columns.
void NormalBlock::AddDense(const Factor& f, double weight) {
  alignas(32) std::array<double, 3 * kBlockStrideMost> rows;
  std::fill_n(rows.begin(), 3 * stride_, 0.0);
  for (int j = 0; j < f.columns; ++j) {
    double* to = rows.data() + f.column[static_cast<std::size_t>(j)];
    for (int i = 0; i < 3; ++i) to[i * stride_] = f.J(i, j);
  }
  for (int j = 0; j < f.columns; ++j) {
    const Eigen::Vector3d w = weight * f.J.col(j);
    gradient_[f.column[static_cast<std::size_t>(j)]] += w.dot(f.r);
  }
  AddSquare(WidestRegisters(), {f.J.data(), f.column.data(), f.columns}, rows.data(), weight,
            stride_, information_.data());
}

}  // namespace wellgyro

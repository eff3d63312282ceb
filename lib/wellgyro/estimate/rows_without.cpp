#include "wellgyro/estimate/rows_without.h"

#include <cmath>

#include "wellgyro/estimate/onset_scan.h"

namespace wellgyro {
namespace {

using Eigen::Vector3d;
using Kind = CauseSpec::Kind;

// Prior sigma that the size of a cause is given, over the larger of what was found and its
// spec: flat enough to cost 1/2 (1/100)^2 = 5e-5 of ln B.
constexpr double kFlat = 100;

bool IsConstant(Kind kind) { return kind == Kind::kConstant || kind == Kind::kGiven; }

/// Whether a cause of one row lies in such a factor.
bool IsOf(Kind kind, const Factor& f) {
  switch (kind) {
    case Kind::kGyroSpike:
      return f.kind == RowKind::kTurn || f.kind == RowKind::kStill;
    case Kind::kAccelSpike:
      return f.kind == RowKind::kForce;
    case Kind::kRestMotion:
      return f.kind == RowKind::kRest && f.rows == 3;
    case Kind::kTie:
      return f.kind == RowKind::kAzimuth;
    default:
      return false;
  }
}

bool IsNoisier(Kind kind, const Factor& f) {
  const bool gyro = f.kind == RowKind::kTurn || f.kind == RowKind::kStill;
  return (kind == Kind::kGyroNoise && gyro) ||
         (kind == Kind::kAccelNoise && f.kind == RowKind::kForce);
}

/// Projects c out of a factor: r <- r - c c'r / c'c, and J as r.
void Without(const Vector3d& c, Factor& f) {
  const Vector3d u = c.normalized();
  f.r -= u * u.dot(f.r);
  for (int j = 0; j < f.columns; ++j) f.J.col(j) -= u * u.dot(f.J.col(j));
}

void Scale(double by, Factor& f) {
  f.r *= by;
  f.J.leftCols(f.columns) *= by;
  f.per_unit *= by;
}

}  // namespace

bool CanBeTakenOut(const CauseSpec& spec) { return spec.kind != Kind::kOther; }

RowsWithout::RowsWithout(RunRows& rows, const FoundCause& cause)
    : rows_(rows), cause_(cause), layout_(rows.layout()) {
  const Kind kind = cause.spec.kind;
  if (!IsConstant(kind) && kind != Kind::kOnset) return;
  unknown_ = BorderColumn(layout_, cause.spec.unknown);
  prior_ =
      1 / (kFlat * kFlat * std::max(cause.size * cause.size, cause.spec.size * cause.spec.size));
  if (IsConstant(kind)) {
    by_unknown_ = layout_.information.col(unknown_);
    layout_.information -= by_unknown_ * by_unknown_.transpose() / (by_unknown_[unknown_] + prior_);
    return;
  }
  const int n = layout_.border++;
  layout_.sigma.conservativeResize(n + 1);
  layout_.sigma[n] = 1 / std::sqrt(prior_);
  layout_.information.conservativeResize(n + 1, n + 1);
  layout_.information.row(n).setZero();
  layout_.information.col(n).setZero();
  layout_.information(n, n) = prior_;
}

void RowsWithout::FirstRows(EdgeMatrix& information, EdgeVector& gradient) const {
  rows_.FirstRows(information, gradient);
  if (unknown_ == kAbsent) return;
  if (cause_.spec.kind == Kind::kOnset) {
    const Eigen::Index n = information.rows();
    information.conservativeResize(n + 1, n + 1);
    information.row(n).setZero();
    information.col(n).setZero();
    information(n, n) = prior_;
    gradient.conservativeResize(n + 1);
    gradient[n] = 0;
    return;
  }
  const BorderVector take = by_unknown_ / (by_unknown_[unknown_] + prior_);
  information.bottomRightCorner(layout_.border, layout_.border) -= take * by_unknown_.transpose();
  // a'x is what the gradient A x of the prior has for the unknown.
  const double along = gradient[layout_.node + unknown_];
  gradient.tail(layout_.border) -= along * take;
}

void RowsWithout::RowsOf(std::size_t k, std::vector<Factor>& rows) {
  const std::size_t first = rows.size();
  rows_.RowsOf(k, rows);
  for (std::size_t i = first; i < rows.size(); ++i) TakeOut(k, rows[i]);
}

void RowsWithout::TakeOut(std::size_t k, Factor& f) const {
  const Kind kind = cause_.spec.kind;
  if (kind == Kind::kOnset && k >= cause_.node) {
    const Vector3d c = ColumnOf(f, rows_.layout(), unknown_);
    if (c.isZero(0)) return;
    f.Column(2 * layout_.node + layout_.border - 1) = c;
  } else if (IsNoisier(kind, f)) {
    Scale(1 / cause_.size, f);
  } else if (k == cause_.node && IsOf(kind, f) && f.per_unit > 0) {
    Without(f.UnitOf(cause_.row), f);
  }
}

}  // namespace wellgyro

#pragma once

#include <cstddef>
#include <vector>

#include "wellgyro/estimate/cause.h"
#include "wellgyro/estimate/linear_run.h"

namespace wellgyro {

/// A cause as it was found: at this knot or node, in this row of a factor, of this size.
struct FoundCause {
  CauseSpec spec;
  std::size_t node = 0;
  int row = 0;  ///< of those that compare one thing: a spike, a motion at rest, a tie
  double size = 0;
};

/// A cause that can be taken out of a run's rows: all but CauseSpec::Kind::kOther.
bool CanBeTakenOut(const CauseSpec& spec);

/// The rows of a run whose cause c is one more unknown, known by nothing but the run: those of
/// y - c theta at the best theta, for which P becomes P - P c c'P / c'P c. More noise has no c:
/// rows of its kind are whitened by its size.
///
/// A constant's prior information A becomes (A^-1 + V e e')^-1 = A - a a' / (a_u + 1/V), a = A e
/// (Sherman and Morrison), an onset gets a column of the border, and rows in which one thing is
/// compared are left without their part along c.
class RowsWithout : public RunRows {
 public:
  /// `rows` must outlive this object.
  RowsWithout(RunRows& rows, const FoundCause& cause);

  const Layout& layout() const override { return layout_; }
  std::size_t size() const override { return rows_.size(); }
  void FirstRows(EdgeMatrix& information, EdgeVector& gradient) const override;
  void RowsOf(std::size_t k, std::vector<Factor>& rows) override;

 private:
  void TakeOut(std::size_t k, Factor& f) const;

  RunRows& rows_;
  FoundCause cause_;
  Layout layout_;
  int unknown_ = kAbsent;    ///< of the border, the cause's
  double prior_ = 0;         ///< 1/V, of what is left of it
  BorderVector by_unknown_;  ///< a, of the constant
};

}  // namespace wellgyro

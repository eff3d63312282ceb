#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/estimate/elimination.h"
#include "wellgyro/estimate/layout.h"
#include "wellgyro/estimate/normal_block.h"

namespace wellgyro {

/// The rows of a run, made linear about its solution, knot by knot.
class RunRows {
 public:
  virtual ~RunRows() = default;
  virtual const Layout& layout() const = 0;
  virtual std::size_t size() const = 0;  ///< knots
  /// Information of [node 0; border] before any knot (lower triangle), with its gradient.
  virtual void FirstRows(EdgeMatrix& information, EdgeVector& gradient) const = 0;
  /// Appends what knot `k` says of [node k | node k + 1 | border]. Always the same.
  virtual void RowsOf(std::size_t k, std::vector<Factor>& rows) = 0;
  /// Their J'J and J'r, summed up by `block` as it does; RowsOf() is what it does by default.
  virtual void BlockOf(std::size_t k, NormalBlock& block);
};

/// Linear least squares of a run's rows at its solution, without robust loss (only changes of the
/// roll rate keep their weights, which are part of its model). A fault test needs residuals of full
/// weight: Huber's would have discounted the very rows that carry the fault.
///
/// Rows r + J x are whitened, N = J'J; after Solve() the rows are P r, P = 1 - J N^-1 J'.
class LinearRun {
 public:
  /// Right-hand sides or solutions, one a column: of every node, and of the border.
  struct Columns {
    std::vector<Eigen::MatrixXd> nodes;
    Eigen::MatrixXd border;
  };

  /// `rows` must outlive this object.
  explicit LinearRun(RunRows& rows);
  LinearRun(const LinearRun&) = delete;
  LinearRun& operator=(const LinearRun&) = delete;

  /// False where something is unobserved or not finite: nothing else may then be called.
  bool Solve();

  RunRows& rows() const { return rows_; }
  const Layout& layout() const { return rows_.layout(); }
  std::size_t knots() const { return rows_.size(); }
  const Elimination& elimination() const { return elimination_; }
  /// What knot `k` says, with P r in place of r.
  void RowsOf(std::size_t k, std::vector<Factor>& rows) const;
  /// Their J'J, and J'r of the r before.
  void BlockOf(std::size_t k, NormalBlock& block) const;
  /// N^-1 J'r with its sign turned, of [node k | node k + 1 | border]: P r = r + J step.
  NormalBlock::Vector StepOf(std::size_t k) const;
  /// c'P r of the border's prior, of a unit of its unknown `i`.
  double PriorScore(int i) const;
  /// N^-1 times `columns`, in place.
  void SolveFor(Columns& columns) const;

 private:
  RunRows& rows_;
  Elimination elimination_;
  std::vector<NodeVector> step_;
  BorderVector border_step_;
  EdgeVector first_gradient_;
};

}  // namespace wellgyro

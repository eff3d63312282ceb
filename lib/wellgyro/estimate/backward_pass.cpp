#include "wellgyro/estimate/backward_pass.h"

#include <cmath>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/estimate/elimination.h"
#include "wellgyro/estimate/layout.h"
#include "wellgyro/estimate/run_state.h"
#include "wellgyro/math/linear_algebra.h"

namespace wellgyro {
namespace {

/// Covariance of the sources' constant errors, from the border's; zero for those it does not have.
ErrorMatrix OfSources(const Layout& layout, const BorderMatrix& border) {
  ErrorMatrix cov = ErrorMatrix::Zero();
  for (int i = 0; i < kErrorSources; ++i) {
    for (int j = 0; j < kErrorSources; ++j) {
      const int row = layout.source[static_cast<std::size_t>(i)];
      const int column = layout.source[static_cast<std::size_t>(j)];
      if (row != kAbsent && column != kAbsent) cov(i, j) = border(row, column);
    }
  }
  return cov;
}

/// From the last node to the first.
class Sweep {
 public:
  Sweep(RunSolver& solver, std::span<const std::size_t> marked, RunEstimate& result)
      : solver_(solver),
        columns_(LinkedColumns(solver.layout())),
        marked_(marked),
        left_(marked.size()),
        result_(result) {}

  void Run() {
    const Elimination& e = solver_.elimination();
    const Layout& layout = solver_.layout();
    EdgeMatrix next = e.LastCovariance();
    const std::size_t n = solver_.knots().size();
    result_.cov_phi_T.resize(n + 1);
    result_.marked.resize(marked_.size());
    TakeErrors(next);
    At(n, next);
    solver_.BeginMeasure();
    for (std::size_t k = n; k-- > 0;) {
      const BehindMatrix gain = e.Gain(k);
      BehindMatrix with_next;
      const EdgeMatrix here = e.CovarianceBefore(k, gain, next, with_next);
      solver_.Measure(k, here, next, with_next);
      if (link_.size() > 0) link_.topRows(layout.node) = (gain * link_).eval();
      At(k, here);
      next = here;
    }
    const RunState* before = solver_.before();
    if (before != nullptr && before->link.size() > 0 && link_.size() > 0) {
      result_.marked.front().cov_with_previous = before->link * link_;
    }
    result_.report.sums = solver_.sums();
  }

 private:
  void At(std::size_t node, const EdgeMatrix& cov) {
    result_.cov_phi_T[node] = cov.topLeftCorner<3, 3>();
    while (left_ > 0 && marked_[left_ - 1] == node) {
      --left_;
      LinkedErrors& mark = result_.marked[left_];
      mark.node = node;
      mark.cov = cov(columns_, columns_);
      if (link_.size() > 0) {
        result_.marked[left_ + 1].cov_with_previous = link_(columns_, Eigen::all);
      }
      link_ = cov(Eigen::all, columns_);
    }
  }

  void TakeErrors(const EdgeMatrix& cov) {
    const Layout& layout = solver_.layout();
    for (int i = 0; i < kErrorSources; ++i) {
      const int at = layout.source[static_cast<std::size_t>(i)];
      if (at == kAbsent) continue;
      result_.errors[i] = solver_.border()[at];
      result_.sigma_errors[i] = std::sqrt(cov(layout.node + at, layout.node + at));
    }
    const BorderMatrix posterior = cov.bottomRightCorner(layout.border, layout.border);
    result_.cov_errors = OfSources(layout, posterior);
    result_.cov_prior = OfSources(layout, InverseOfSymmetric(layout.information));
  }

  RunSolver& solver_;
  std::vector<int> columns_;
  std::span<const std::size_t> marked_;
  std::size_t left_;
  RunEstimate& result_;
  Eigen::MatrixXd link_;  ///< E[(node; border) x'] of the marked node behind
};

}  // namespace

void PassBack(RunSolver& solver, std::span<const std::size_t> marked, RunEstimate& result) {
  Sweep(solver, marked, result).Run();
}

}  // namespace wellgyro

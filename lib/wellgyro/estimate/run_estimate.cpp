#include "wellgyro/estimate/run_estimate.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "wellgyro/math/rotation.h"

namespace wellgyro {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kIterations = 15;
// 2 ln of odds of 90: by less one azimuth does not beat another.
constexpr double kDecides = 9;

/// Inclination and toolface by the first knot that gravity levels, azimuth zero.
Matrix3d LevelAttitude(std::span<const RunKnot> knots) {
  for (const RunKnot& knot : knots) {
    if (!knot.increment.level) continue;
    const Vector3d& f = knot.increment.force_M;
    return AttitudeMatrix(0, std::atan2(std::hypot(f.x(), f.y()), -f.z()),
                          std::atan2(-f.y(), f.x())) *
           RotationZ(-knot.increment.roll_before);
  }
  return Matrix3d::Identity();
}

/// The turn about the vertical that takes `from` nearest to `to`.
double HeadingBetween(const Matrix3d& from, const Matrix3d& to) {
  const Matrix3d turn = to * from.transpose();
  return std::atan2(turn(1, 0) - turn(0, 1), turn(0, 0) + turn(1, 1));
}

/// Begins so that the node of the start has its heading. The Earth's rate depends on it, so twice.
void BeginAt(const StartAttitude& start, RunSolver& solver) {
  Matrix3d first = LevelAttitude(solver.knots());
  for (int i = 0; i < 3; ++i) {
    solver.Begin(first);
    const double heading = HeadingBetween(solver.nodes()[start.node].R_LT, start.R_LT);
    first = RotationZ(heading) * first;
  }
  solver.Begin(first);
}

/// Columns of [node; border] whose errors stay linked from node to node.
std::vector<int> LinkedColumns(const Layout& layout) {
  std::vector<int> columns{0, 1, 2};
  for (const int drift : {layout.walk, layout.markov}) {
    if (drift == kAbsent) continue;
    columns.push_back(drift);
    columns.push_back(drift + 1);
  }
  for (int i = 0; i < layout.border; ++i) columns.push_back(layout.node + i);
  return columns;
}

/// Backwards through the nodes: covariances of all, links of the marked, and what the unknowns
/// absorb of every kind of residual.
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
    result_.cov_phi.resize(n + 1);
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
    result_.report.sums = solver_.sums();
  }

 private:
  void At(std::size_t node, const EdgeMatrix& cov) {
    result_.cov_phi[node] = cov.topLeftCorner<3, 3>();
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
  }

  RunSolver& solver_;
  std::vector<int> columns_;
  std::span<const std::size_t> marked_;
  std::size_t left_;
  RunEstimate& result_;
  Eigen::MatrixXd link_;  ///< E[(node; border) x'] of the marked node behind
};

}  // namespace

RunEstimate EstimateRun(const EstimateSetup& setup, std::span<const RunKnot> knots,
                        std::span<const StartAttitude> starts,
                        std::span<const std::size_t> marked) {
  RunEstimate result;
  if (knots.empty()) return result;
  std::unique_ptr<RunSolver> best;
  double rival = HUGE_VAL;
  for (const StartAttitude& start : starts) {
    auto solver = std::make_unique<RunSolver>(setup, knots);
    BeginAt(start, *solver);
    const SolveReport report = solver->Solve(kIterations);
    if (!report.converged) continue;
    if (!best || report.evidence < result.report.evidence) {
      if (best) rival = result.report.evidence;
      result.report = report;
      best = std::move(solver);
    } else {
      rival = std::min(rival, report.evidence);
    }
  }
  if (!best) return result;
  result.solved = true;
  result.ambiguous = rival - result.report.evidence < kDecides;
  Sweep(*best, marked, result).Run();
  result.nodes = best->nodes();
  return result;
}

}  // namespace wellgyro

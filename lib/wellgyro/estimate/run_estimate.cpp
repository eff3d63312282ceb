#include "wellgyro/estimate/run_estimate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <memory>
#include <optional>
#include <utility>

#include "wellgyro/estimate/swing.h"
#include "wellgyro/math/rotation.h"

namespace wellgyro {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kIterations = 15;
// 2 ln of odds of 90: by less one azimuth does not beat another.
constexpr double kDecides = 9;
// A sum of squares this many sigmas above its freedom is not chance: one run in 30 000.
constexpr double kTooLarge = 4;
// Each takes the noise to what the residuals about the last solution say; the third moves it by
// less than a per cent.
constexpr int kNoiseRounds = 3;

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

/// Adds to the roll of the knots between two nodes that do not show it, together `angle`.
void Spread(double angle, std::span<const RunKnot> knots, std::size_t begin, std::size_t end,
            std::vector<double>& extra) {
  const auto weight = [&](std::size_t k) {
    const bool hidden = !knots[k].increment.roll_seen && !knots[k].still;
    return hidden ? knots[k].increment.seconds : 0.0;
  };
  double sum = 0;
  for (std::size_t k = begin; k < end; ++k) sum += weight(k);
  if (!(sum > 0)) return;
  for (std::size_t k = begin; k < end; ++k) extra[k] += angle * weight(k) / sum;
}

void BeginAt(const Start& start, RunSolver& solver) {
  Matrix3d first = LevelAttitude(solver.knots());
  std::vector<double> extra(solver.knots().size(), 0);
  const auto heading = [&](const Anchor& anchor) {
    solver.Begin(first, extra);
    return HeadingBetween(solver.nodes()[anchor.node].R_LT, anchor.R_LT);
  };
  // The Earth's rate depends on the heading: until it stays to a milliradian.
  for (int i = 0; i < 3; ++i) first = RotationZ(heading(start.front())) * first;
  const std::size_t* from = &start.front().node;
  for (const Anchor& anchor : std::span(start).subspan(1)) {
    for (int i = 0; i < 2; ++i) Spread(heading(anchor), solver.knots(), *from, anchor.node, extra);
    from = &anchor.node;
  }
  solver.Begin(first, extra);
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

/// By what factor the noise is larger than stated, of residuals of these kinds; 1: by none.
double Excess(const std::array<RowSum, kRowKinds>& sums, std::initializer_list<RowKind> kinds) {
  double weighted = 0, freedom = 0;
  for (const RowKind kind : kinds) {
    const RowSum& sum = sums[static_cast<std::size_t>(kind)];
    weighted += sum.weighted;
    freedom += sum.freedom;
  }
  if (!(freedom > 1) || weighted < freedom + kTooLarge * std::sqrt(2 * freedom)) return 1;
  return std::sqrt(weighted / freedom);
}

/// Solves again with the noise that the residuals show, until they agree with it.
void FitNoise(RunSolver& solver, std::span<const std::size_t> marked, RunEstimate& result) {
  const std::array<RowSum, kRowKinds> stated = result.report.sums;
  for (int i = 0; i < kNoiseRounds && result.solved; ++i) {
    const double gyro = Excess(result.report.sums, {RowKind::kTurn, RowKind::kStill});
    const double accel = Excess(result.report.sums, {RowKind::kForce});
    if (gyro == 1 && accel == 1) break;
    result.gyro_noise *= gyro;
    result.accel_noise *= accel;
    result.solved = solver.SolveWithNoise(gyro, accel);
    if (result.solved) Sweep(solver, marked, result).Run();
  }
  result.report.sums = stated;
}

}  // namespace

RunEstimate EstimateRun(const EstimateSetup& setup, std::span<const RunKnot> knots,
                        std::span<const Start> starts, std::span<const std::size_t> marked) {
  RunEstimate result;
  if (knots.empty()) return result;
  std::vector<EstimateSetup> setups{setup};
  if (const std::optional<double> swing = SwingOf(knots)) {
    setups.push_back(setup);
    setups.back().swing = swing;
  }
  std::unique_ptr<RunSolver> best;
  std::size_t best_start = 0;
  std::vector<double> evidence(starts.size(), HUGE_VAL);
  for (std::size_t i = 0; i < starts.size(); ++i) {
    for (const EstimateSetup& tried : setups) {
      auto solver = std::make_unique<RunSolver>(tried, knots);
      BeginAt(starts[i], *solver);
      const SolveReport report = solver->Solve(kIterations);
      if (!report.converged) continue;
      evidence[i] = std::min(evidence[i], report.evidence);
      if (best && !(report.evidence < result.report.evidence)) continue;
      result.report = report;
      best = std::move(solver);
      best_start = i;
    }
  }
  if (!best) return result;
  result.solved = true;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    result.ambiguous |= i != best_start && evidence[i] - result.report.evidence < kDecides;
  }
  Sweep(*best, marked, result).Run();
  FitNoise(*best, marked, result);
  result.nodes = best->nodes();
  return result;
}

}  // namespace wellgyro

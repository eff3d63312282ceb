#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>

#include <ceres/ceres.h>

#include "wellgyro/fit/bench_checks_internal.h"
#include "wellgyro/fit/nonlinear_internal.h"
#include "wellgyro/math/median.h"

namespace wellgyro {
namespace {

ceres::Solver::Options SolverOptions() {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 500;
  options.function_tolerance = 1e-15;
  options.gradient_tolerance = 1e-18;
  options.parameter_tolerance = 1e-13;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  options.minimizer_progress_to_stdout = false;
  return options;
}

bool Holds(const std::vector<int>& lines, int line) {
  return line > 0 && std::find(lines.begin(), lines.end(), line) != lines.end();
}

}  // namespace

struct NonlinearProblem::Minimum {
  Eigen::VectorXd x;
  double cost = 0;
  bool converged = false;
};

NonlinearProblem::Minimum NonlinearProblem::Minimise(const Eigen::VectorXd& start, double cauchy,
                                                     const std::vector<int>& without) const {
  Minimum minimum{start, 0, false};
  ceres::Problem problem;
  problem.AddParameterBlock(minimum.x.data(), static_cast<int>(minimum.x.size()));
  for (const Block& block : blocks_) {
    const int line = block.rows.front().line;
    if (Holds(without, line)) continue;
    ceres::LossFunction* const loss =
        cauchy > 0 && line > 0 ? new ceres::CauchyLoss(cauchy) : nullptr;
    problem.AddResidualBlock(block.cost().release(), loss, minimum.x.data());
  }
  for (const BoundOf& bound : bounds_) {
    problem.SetParameterLowerBound(minimum.x.data(), bound.parameter, bound.low);
    problem.SetParameterUpperBound(minimum.x.data(), bound.parameter, bound.high);
  }
  ceres::Solver::Summary summary;
  ceres::Solve(SolverOptions(), &problem, &summary);
  minimum.cost = summary.final_cost;
  minimum.converged = summary.termination_type == ceres::CONVERGENCE && minimum.x.allFinite();
  return minimum;
}

LinearProblem NonlinearProblem::Linearise(const Eigen::VectorXd& x,
                                          const std::vector<int>& without) const {
  int n = 0;
  for (const Block& block : blocks_) {
    if (!Holds(without, block.rows.front().line)) n += static_cast<int>(block.rows.size());
  }
  LinearProblem linear(parameters_, n);
  linear.sigma_given = sigma_given;
  linear.robust = false;
  Eigen::Index row = 0;
  for (const Block& block : blocks_) {
    if (Holds(without, block.rows.front().line)) continue;
    const auto size = static_cast<Eigen::Index>(block.rows.size());
    Eigen::VectorXd r(size);
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> J(size, x.size());
    const double* const at = x.data();
    double* jacobian = J.data();
    block.cost()->Evaluate(&at, r.data(), &jacobian);
    linear.A.middleRows(row, size) = J;
    linear.y.segment(row, size) = J * x - r;
    for (const FitRow& label : block.rows) linear.rows[static_cast<std::size_t>(row++)] = label;
  }
  return linear;
}

Eigen::VectorXd NonlinearProblem::Residuals(const Eigen::VectorXd& x) const {
  std::vector<double> all;
  for (const Block& block : blocks_) {
    std::vector<double> r(block.rows.size());
    const double* const at = x.data();
    block.cost()->Evaluate(&at, r.data(), nullptr);
    all.insert(all.end(), r.begin(), r.end());
  }
  return Eigen::Map<const Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
}

double NonlinearProblem::Scale(const Eigen::VectorXd& x) const {
  if (sigma_given) return 1;
  const Eigen::VectorXd r = Residuals(x);
  std::vector<double> sizes;
  Eigen::Index at = 0;
  for (const Block& block : blocks_) {
    for (const FitRow& row : block.rows) {
      if (row.line > 0) sizes.push_back(std::abs(r[at]));
      ++at;
    }
  }
  const double n = static_cast<double>(sizes.size());
  const double freedom = std::max(1.0, n - static_cast<double>(x.size()));
  const double sigma = RobustSigma(std::move(sizes));
  return std::max(sigma * std::sqrt(n / freedom), least_scale);
}

std::vector<int> NonlinearProblem::Outliers(const Eigen::VectorXd& x, double scale) const {
  const Eigen::VectorXd r = Residuals(x);
  std::set<int> lines;
  Eigen::Index at = 0;
  for (const Block& block : blocks_) {
    for (const FitRow& row : block.rows) {
      if (row.line > 0 && std::abs(r[at]) > kOutlierSigmas * scale) lines.insert(row.line);
      ++at;
    }
  }
  return {lines.begin(), lines.end()};
}

Result<NonlinearProblem::Solution> NonlinearProblem::Solve() const {
  const Fault unsettled{
      .code = FaultCode::kRange,
      .text =
          "the iteration does not settle, the readings do not fit the model: look for wrong "
          "signs, exchanged columns, mixed units or a wrong reference"};
  if (!start_.allFinite() || !Residuals(start_).allFinite()) return unsettled;
  Minimum minimum = Minimise(start_, 0, {});
  std::vector<int> outliers;
  std::set<int> lines;
  std::size_t n_rows = 0;
  for (const Block& block : blocks_) {
    if (block.rows.front().line > 0) lines.insert(block.rows.front().line);
    n_rows += block.rows.size();
  }
  if (robust && n_rows >= 2 * parameters_.size()) {
    Eigen::VectorXd x = minimum.converged ? minimum.x : start_;
    double scale = Scale(x);
    for (int turn = 0; turn < 12; ++turn) {
      const Minimum held = Minimise(x, 2 * scale, {});
      if (!held.x.allFinite()) break;
      x = held.x;
      const double next = Scale(x);
      const bool still = std::abs(next - scale) < 1e-3 * scale;
      scale = next;
      if (still && turn > 0) break;
    }
    outliers = Outliers(x, scale);
    if (4 * outliers.size() > lines.size()) outliers.clear();
    // Of those, the ones that do not belong to what the others say either.
    for (int turn = 0; turn < 10 && !outliers.empty(); ++turn) {
      minimum = Minimise(x, 0, outliers);
      if (!minimum.x.allFinite()) break;
      const std::vector<int> beyond = Outliers(minimum.x, Scale(minimum.x));
      std::vector<int> both;
      std::set_intersection(outliers.begin(), outliers.end(), beyond.begin(), beyond.end(),
                            std::back_inserter(both));
      if (both == outliers) break;
      outliers = std::move(both);
      if (outliers.empty()) minimum = Minimise(x, 0, outliers);
    }
  }
  if (!minimum.converged) return unsettled;
  return Solution{minimum.x, Linearise(minimum.x, outliers), minimum.cost, outliers};
}

Result<FitReport> WholeReport(const BenchTable& data,
                              const Result<NonlinearProblem::Solution>& solution,
                              std::string_view advice) {
  if (!solution) return BenchFault(data, solution.fault().text);
  LinearSolution linear = Solve(solution->linear);
  linear.outlier_lines = solution->outlier_lines;
  return WholeReport(data, solution->linear, linear, advice);
}

}  // namespace wellgyro

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/core.h>

#include "wellgyro/fit/hemisphere_internal.h"
#include "wellgyro/math/linear_algebra.h"

namespace wellgyro {
namespace {

double LogOddsByForces(const Eigen::VectorXd& now, const Eigen::VectorXd& then) {
  if (now.size() == 0) return 0;
  return static_cast<double>(now.size()) * std::log(now.norm() / then.norm());
}

// Least squares of these rows, which determine all: x becomes the solution. Gives its chi-square.
double SolveRows(const LinearProblem& problem, const std::vector<Eigen::Index>& rows,
                 const Eigen::VectorXd& sigma, Eigen::VectorXd& x) {
  const Eigen::VectorXd weight = sigma(rows).cwiseInverse();
  const Eigen::MatrixXd A = weight.asDiagonal() * problem.A(rows, Eigen::all);
  const Eigen::VectorXd y = weight.cwiseProduct(Eigen::VectorXd(problem.y(rows)));
  const Eigen::VectorXd unit = A.colwise().norm().transpose().cwiseMax(1e-300).cwiseInverse();
  const Eigen::MatrixXd scaled = A * unit.asDiagonal();
  x = unit.cwiseProduct(Eigen::VectorXd(
      SolveSymmetric(scaled.transpose() * scaled, Eigen::MatrixXd(scaled.transpose() * y))));
  return (y - A * x).squaredNorm();
}

}  // namespace

std::optional<std::string> OtherHemisphere(
    const LinearProblem& problem, const LinearSolution& solution,
    const std::function<LinearProblem(const Eigen::VectorXd& x)>& other,
    const std::vector<Eigen::Index>& forces) {
  if (solution.dof < 1 || solution.cov.size() == 0) return std::nullopt;
  const std::set<int> out(solution.outlier_lines.begin(), solution.outlier_lines.end());
  std::vector<Eigen::Index> rows;
  for (std::size_t i = 0; i < problem.rows.size(); ++i) {
    if (out.count(problem.rows[i].line) == 0) rows.push_back(static_cast<Eigen::Index>(i));
  }
  Eigen::VectorXd x = solution.x;
  double chi_square = 0;
  // Bilinear in sensitivities and the bench's angles.
  for (int turn = 0; turn < 3; ++turn) chi_square = SolveRows(other(x), rows, problem.sigma, x);
  const double best = std::min(solution.chi_square, chi_square) / solution.dof;
  const double variance = problem.sigma_given ? std::max(1.0, best) : best;
  if (!(variance > 0)) return std::nullopt;
  const Eigen::VectorXd now = solution.x(forces), then = x(forces);
  const double log_odds =
      (solution.chi_square - chi_square) / (2 * variance) + LogOddsByForces(now, then);
  // Odds of the other sign, both as likely before: of those who are asked at the limit one in 21
  // was right. Beyond a million no number is said.
  constexpr double kOdds = 20, kBeyondDoubt = 1e6;
  if (!(log_odds > std::log(kOdds))) return std::nullopt;
  return fmt::format(
      "the readings suit a latitude of the other sign better, by odds of {}: force terms would be "
      "{:.3g} where they are {:.3g} deg/h/g (largest), chi-square {:.4g} where it is {:.4g}: is "
      "the latitude's sign right? South is negative",
      log_odds > std::log(kBeyondDoubt) ? "more than a million"
                                        : fmt::format("{:.0f}", std::exp(log_odds)),
      then.size() > 0 ? then.cwiseAbs().maxCoeff() : 0,
      now.size() > 0 ? now.cwiseAbs().maxCoeff() : 0, chi_square, solution.chi_square);
}

}  // namespace wellgyro

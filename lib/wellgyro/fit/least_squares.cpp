#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>
#include <utility>

#include <Eigen/Dense>
#include <fmt/core.h>

#include "wellgyro/fit/least_squares_internal.h"
#include "wellgyro/math/linear_algebra.h"
#include "wellgyro/math/median.h"
#include "wellgyro/math/statistics.h"

namespace wellgyro {
namespace {

// sqrt(eps) = 1.5e-8: the square of a smaller singular value is below the rounding of the
// largest's.
constexpr double kRankTolerance = 1e-8;

struct Whitened {
  Eigen::MatrixXd A;
  Eigen::VectorXd y;
};

Whitened Whiten(const LinearProblem& problem) {
  const Eigen::VectorXd weight = problem.sigma.cwiseInverse();
  return {weight.asDiagonal() * problem.A, weight.cwiseProduct(problem.y)};
}

struct Decomposition {
  Eigen::VectorXd scale;  ///< lengths of the columns
  SingularValues svd;
  int rank = 0;
};

Decomposition Decompose(const Eigen::MatrixXd& A) {
  Decomposition d;
  d.scale = A.colwise().norm().transpose();
  for (double& s : d.scale) s = s > 0 ? s : 1;
  Eigen::MatrixXd scaled = A * d.scale.cwiseInverse().asDiagonal();
  // Fewer rows than parameters: rows of zeros keep every right singular vector.
  if (scaled.rows() < scaled.cols()) {
    const Eigen::Index rows = scaled.rows();
    scaled.conservativeResize(scaled.cols(), Eigen::NoChange);
    scaled.bottomRows(scaled.rows() - rows).setZero();
  }
  d.svd = SingularValuesOf(scaled);
  const Eigen::VectorXd& values = d.svd.values;
  for (const double value : values) d.rank += value > kRankTolerance * values[0] ? 1 : 0;
  return d;
}

Eigen::VectorXd Apply(const Decomposition& d, const Eigen::VectorXd& y) {
  Eigen::VectorXd padded = Eigen::VectorXd::Zero(d.svd.U.rows());
  padded.head(y.size()) = y;
  const Eigen::VectorXd along = (d.svd.U.transpose() * padded).head(d.rank);
  const Eigen::VectorXd scaled =
      d.svd.V.leftCols(d.rank) * along.cwiseQuotient(d.svd.values.head(d.rank));
  return scaled.cwiseQuotient(d.scale);
}

// "0.71 b[0] - 0.70 G[0,0]": a direction in which nothing changes.
std::string Words(const Eigen::VectorXd& direction, const std::vector<std::string>& names) {
  const double largest = direction.cwiseAbs().maxCoeff();
  std::string words;
  for (Eigen::Index i = 0; i < direction.size(); ++i) {
    const double part = direction[i] / largest;
    if (std::abs(part) < 0.05) continue;
    words += words.empty() ? (part < 0 ? "-" : "") : (part < 0 ? " - " : " + ");
    words += fmt::format("{:.2f} {}", std::abs(part), names[static_cast<std::size_t>(i)]);
  }
  return words;
}

LinearSolution SolvePlain(const LinearProblem& problem) {
  const Whitened w = Whiten(problem);
  const Decomposition d = Decompose(w.A);
  LinearSolution solution;
  solution.x = Apply(d, w.y);
  // Once more on what is left: small residuals to the last digits.
  solution.x += Apply(d, w.y - w.A * solution.x);
  solution.residual = w.y - w.A * solution.x;
  solution.rank = d.rank;
  const Eigen::VectorXd& values = d.svd.values;
  solution.condition = d.rank > 0 ? values[0] / values[d.rank - 1] : 1;
  const auto U = d.svd.U.leftCols(d.rank).topRows(w.y.size());
  solution.leverage = U.rowwise().squaredNorm();
  solution.chi_square = solution.residual.squaredNorm();
  solution.dof = static_cast<int>(w.y.size()) - d.rank;
  solution.rows = problem.rows;
  for (int i = d.rank; i < problem.size(); ++i) {
    solution.unseen.push_back(Words(d.svd.V.col(i), problem.parameters));
  }
  const Eigen::MatrixXd root = d.scale.cwiseInverse().asDiagonal() * d.svd.V.leftCols(d.rank) *
                               values.head(d.rank).cwiseInverse().asDiagonal();
  if (problem.sigma_given) {
    solution.cov = root * root.transpose();
  } else if (solution.dof > 0) {
    solution.cov = root * root.transpose() * (solution.chi_square / solution.dof);
  }
  return solution;
}

// Roots of the weights of Cauchy's loss, all rows of a line together; `scale` by row, one a line.
Eigen::VectorXd CauchyWeights(const LinearProblem& problem, const Eigen::VectorXd& residual,
                              const Eigen::VectorXd& scale) {
  Eigen::VectorXd weight = Eigen::VectorXd::Ones(residual.size());
  for (std::size_t begin = 0; begin < problem.rows.size();) {
    std::size_t end = begin;
    double square = 0;
    while (end < problem.rows.size() && problem.rows[end].line == problem.rows[begin].line) {
      square += std::pow(residual[static_cast<Eigen::Index>(end++)], 2);
    }
    const double of = scale[static_cast<Eigen::Index>(begin)];
    const double mean = square / static_cast<double>(end - begin) / (4 * of * of);
    if (problem.rows[begin].line != 0) {
      for (std::size_t i = begin; i < end; ++i) {
        weight[static_cast<Eigen::Index>(i)] = 1 / std::sqrt(1 + mean);
      }
    }
    begin = end;
  }
  return weight;
}

double RobustScale(const LinearProblem& problem, const Eigen::VectorXd& residual, int rank) {
  if (problem.sigma_given) return 1;
  std::vector<double> sizes;
  for (Eigen::Index i = 0; i < residual.size(); ++i) {
    if (problem.rows[static_cast<std::size_t>(i)].line != 0) sizes.push_back(std::abs(residual[i]));
  }
  const double n = static_cast<double>(sizes.size());
  return RobustSigma(sizes) * std::sqrt(n / std::max(1.0, n - rank));
}

LinearProblem Without(const LinearProblem& problem, const std::set<int>& lines) {
  LinearProblem rest(problem.parameters, 0);
  std::vector<Eigen::Index> kept;
  for (std::size_t i = 0; i < problem.rows.size(); ++i) {
    if (lines.count(problem.rows[i].line) > 0) continue;
    kept.push_back(static_cast<Eigen::Index>(i));
    rest.rows.push_back(problem.rows[i]);
  }
  rest.A = problem.A(kept, Eigen::all);
  rest.y = problem.y(kept);
  rest.sigma = problem.sigma(kept);
  rest.sigma_given = problem.sigma_given;
  return rest;
}

// Lines with a residual beyond the limit.
std::set<int> Beyond(const LinearProblem& problem, const Eigen::VectorXd& residual, double scale) {
  std::set<int> lines;
  for (Eigen::Index i = 0; i < residual.size(); ++i) {
    const int line = problem.rows[static_cast<std::size_t>(i)].line;
    if (line != 0 && std::abs(residual[i]) > kOutlierSigmas * scale) lines.insert(line);
  }
  return lines;
}

// What no bench calls an outlier: rounding of readings in their ninth digit, of which the largest
// departure may be kOutlierSigmas scales.
double LeastScale(const Whitened& w) {
  constexpr double kRounding = 1e-9;
  return kRounding * w.y.cwiseAbs().maxCoeff() / kOutlierSigmas;
}

// Lines that do not belong, by a fit that they cannot draw to them.
std::set<int> Outliers(const LinearProblem& problem) {
  LinearProblem weighted = problem;
  LinearSolution solution = SolvePlain(problem);
  const Whitened w = Whiten(problem);
  double scale = 0;
  for (int turn = 0; turn < 30; ++turn) {
    const Eigen::VectorXd residual = w.y - w.A * solution.x;
    scale = std::max(RobustScale(problem, residual, solution.rank), LeastScale(w));
    const Eigen::VectorXd same = Eigen::VectorXd::Constant(residual.size(), scale);
    weighted.sigma = problem.sigma.cwiseQuotient(CauchyWeights(problem, residual, same));
    const Eigen::VectorXd before = solution.x;
    solution = SolvePlain(weighted);
    if ((solution.x - before).norm() <= 1e-9 * before.norm()) break;
  }
  return Beyond(problem, w.y - w.A * solution.x, scale);
}

// By row: what the rows of its table scatter by, in units of their sigmas, each freed of what the
// fit took of it. Of readings of a table, lines above zero, it is one where sigmas are given.
Eigen::VectorXd ScalesOfTables(const LinearProblem& problem, const LinearSolution& solution,
                               double least) {
  std::vector<double> sizes[2];
  const auto second = [&](Eigen::Index i) {
    return problem.rows[static_cast<std::size_t>(i)].line < 0 ? 1 : 0;
  };
  for (Eigen::Index i = 0; i < solution.residual.size(); ++i) {
    const double left = std::max(1e-9, 1 - solution.leverage[i]);
    sizes[second(i)].push_back(std::abs(solution.residual[i]) / std::sqrt(left));
  }
  double scale[2];
  for (int k = 0; k < 2; ++k) scale[k] = std::max(RobustSigma(sizes[k]), least);
  if (problem.sigma_given) scale[0] = 1;
  Eigen::VectorXd scales(solution.residual.size());
  for (Eigen::Index i = 0; i < scales.size(); ++i) scales[i] = scale[second(i)];
  return scales;
}

// Of lines that were left out, those that do not belong to what the others say either.
std::set<int> Confirmed(const LinearProblem& problem, std::set<int> lines) {
  const Whitened w = Whiten(problem);
  for (int turn = 0; turn < 10 && !lines.empty(); ++turn) {
    const LinearSolution rest = SolvePlain(Without(problem, lines));
    const double scatter =
        rest.dof > 0 && !problem.sigma_given ? std::sqrt(rest.chi_square / rest.dof) : 1;
    std::set<int> next = Beyond(problem, w.y - w.A * rest.x, std::max(scatter, LeastScale(w)));
    std::set<int> both;
    std::set_intersection(lines.begin(), lines.end(), next.begin(), next.end(),
                          std::inserter(both, both.end()));
    if (both == lines) break;
    lines = std::move(both);
  }
  return lines;
}

// Where half of the readings serve to fix the parameters, none can be told to be wrong.
bool Tells(const LinearProblem& problem) {
  return problem.y.size() >= Eigen::Index{2} * problem.size();
}

std::size_t CountLines(const LinearProblem& problem) {
  std::set<int> lines;
  for (const FitRow& row : problem.rows) {
    if (row.line != 0) lines.insert(row.line);
  }
  return lines.size();
}

}  // namespace

LinearProblem::LinearProblem(std::vector<std::string> names, int n_rows)
    : parameters(std::move(names)),
      A(Eigen::MatrixXd::Zero(n_rows, static_cast<Eigen::Index>(parameters.size()))),
      y(Eigen::VectorXd::Zero(n_rows)),
      sigma(Eigen::VectorXd::Ones(n_rows)),
      rows(static_cast<std::size_t>(n_rows)) {}

LinearSolution SolveByMedians(const LinearProblem& problem) {
  LinearSolution solution = SolvePlain(problem);
  if (!Tells(problem)) return solution;
  LinearProblem weighted = problem;
  const Whitened w = Whiten(problem);
  for (int turn = 0; turn < 30; ++turn) {
    const Eigen::VectorXd scales = ScalesOfTables(problem, solution, LeastScale(w));
    weighted.sigma = problem.sigma.cwiseQuotient(CauchyWeights(problem, solution.residual, scales));
    const Eigen::VectorXd before = solution.x;
    solution = SolvePlain(weighted);
    solution.residual = w.y - w.A * solution.x;
    if ((solution.x - before).norm() <= 1e-6 * before.norm()) break;
  }
  return solution;
}

LinearSolution Solve(const LinearProblem& problem) {
  LinearSolution plain = SolvePlain(problem);
  if (!problem.robust || !Tells(problem) || !plain.unseen.empty()) return plain;
  const std::set<int> lines = Confirmed(problem, Outliers(problem));
  if (lines.empty() || 4 * lines.size() > CountLines(problem)) return plain;
  LinearSolution rest = SolvePlain(Without(problem, lines));
  if (!rest.unseen.empty()) return plain;
  rest.outlier_lines.assign(lines.begin(), lines.end());
  return rest;
}

}  // namespace wellgyro

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/fit/bench_checks_internal.h"
#include "wellgyro/fit/least_squares_internal.h"
#include "wellgyro/fit/residual_trends_internal.h"
#include "wellgyro/math/statistics.h"

namespace wellgyro {
namespace {

void AddResiduals(FitReport& report, const LinearSolution& solution) {
  const double scale = report.sigma_given || !(report.scatter > 0) ? 1 : report.scatter;
  for (std::size_t i = 0; i < solution.rows.size(); ++i) {
    const FitRow& row = solution.rows[i];
    if (row.line == 0) continue;
    const auto at = static_cast<Eigen::Index>(i);
    FitResidual residual;
    residual.line = std::abs(row.line);
    residual.channel = row.line < 0 ? "table " + row.channel : row.channel;
    residual.value = solution.residual[at] * row.unit;
    residual.leverage = solution.leverage[at];
    const double rest = 1 - residual.leverage;
    if (rest > 1e-9 && solution.dof > 0) {
      residual.studentised = solution.residual[at] / (scale * std::sqrt(rest));
    }
    report.half_square_sum += residual.value * residual.value / 2;
    report.residuals.push_back(std::move(residual));
  }
  report.readings = static_cast<int>(report.residuals.size());
  if (solution.dof < 1) return;
  const double each = kFalseAlarm / 2 / std::max(1, report.readings);
  report.studentised_limit =
      report.sigma_given ? -NormalQuantile(each) : StudentLimit(each, solution.dof);
}

void AddCorrelations(FitReport& report) {
  for (Eigen::Index i = 0; i < report.cov.rows(); ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      const double r = report.cov(i, j) / std::sqrt(report.cov(i, i) * report.cov(j, j));
      // One and the same estimate under two names is no news.
      if (!(std::abs(r) > 0.95) || std::abs(r) > 1 - 1e-9) continue;
      report.correlations.push_back(fmt::format("{} and {}: {:+.3f}",
                                                report.parameters[static_cast<std::size_t>(j)],
                                                report.parameters[static_cast<std::size_t>(i)], r));
    }
  }
}

void Add(FitReport& report, std::string name, FitQuantity::Shape shape, int first, int rows,
         int columns) {
  FitQuantity quantity{std::move(name), shape, Eigen::MatrixXd(rows, columns), {}};
  const bool known = report.cov.size() > 0;
  if (known) quantity.sigma.resize(rows, columns);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const int at = first + i * columns + j;
      quantity.value(i, j) = report.values[at] + 0.0;  // not -0
      if (known) quantity.sigma(i, j) = std::sqrt(std::max(0.0, report.cov(at, at)));
    }
  }
  report.result.push_back(std::move(quantity));
}

}  // namespace

FitReport ReportOf(const LinearProblem& problem, const LinearSolution& solution) {
  FitReport report;
  report.parameters = problem.parameters;
  report.values = solution.x;
  report.cov = solution.cov;
  report.dof = solution.dof;
  report.sigma_given = problem.sigma_given;
  report.chi_square = solution.chi_square;
  report.condition = solution.condition;
  for (const int line : solution.outlier_lines) {
    if (line > 0) report.outlier_lines.push_back(line);
    if (line < 0) {
      report.remarks.push_back(fmt::format("line {} of the second table is left out", -line));
    }
  }
  if (solution.dof > 0) {
    report.chi_low = ChiSquareQuantile(0.025, solution.dof);
    report.chi_high = ChiSquareQuantile(0.975, solution.dof);
    report.scatter = std::sqrt(solution.chi_square / solution.dof);
  }
  AddResiduals(report, solution);
  AddCorrelations(report);
  if (report.cov.size() == 0) {
    report.remarks.push_back(
        "there are as many parameters as readings: no uncertainty can be stated; repeat the "
        "positions, or give the readings' sigma");
  }
  if (report.sigma_given && report.dof > 0 && report.chi_square > report.chi_high) {
    report.remarks.push_back(fmt::format(
        "the residuals are {:.2f} times what the given sigma lets expect: the uncertainties are "
        "too small by that, or the model lacks something",
        report.scatter));
  }
  return report;
}

std::string LineName(int line) { return fmt::format("line {}", line); }

Result<FitReport> WholeReport(const BenchTable& data, const LinearProblem& problem,
                              const LinearSolution& solution, std::string_view advice,
                              const LineNames& name) {
  if (solution.unseen.empty()) {
    FitReport report = ReportOf(problem, solution);
    TestTrends(data, problem, solution, name, report);
    return report;
  }
  std::string text = "the readings do not determine";
  for (std::size_t i = 0; i < solution.unseen.size() && i < 3; ++i) {
    text += fmt::format("{} {}", i > 0 ? ", nor" : "", solution.unseen[i]);
  }
  if (solution.unseen.size() > 3) text += fmt::format(", nor {} more", solution.unseen.size() - 3);
  return BenchFault(data, fmt::format("{}: {}", text, advice));
}

void Reparametrise(FitReport& report, std::vector<std::string> names,
                   const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& of) {
  const Eigen::VectorXd value = of(report.values);
  if (report.cov.size() > 0) {
    Eigen::MatrixXd D(value.size(), report.values.size());
    for (Eigen::Index i = 0; i < report.values.size(); ++i) {
      const double sigma = std::sqrt(std::max(0.0, report.cov(i, i)));
      const double step = std::max({1e-6 * std::abs(report.values[i]), 1e-3 * sigma, 1e-12});
      Eigen::VectorXd above = report.values, below = report.values;
      above[i] += step;
      below[i] -= step;
      D.col(i) = (of(above) - of(below)) / (above[i] - below[i]);
    }
    report.cov = D * report.cov * D.transpose();
  }
  report.values = value;
  report.parameters = std::move(names);
  report.correlations.clear();
  AddCorrelations(report);
}

void AddNumber(FitReport& report, std::string name, int first) {
  Add(report, std::move(name), FitQuantity::Shape::kNumber, first, 1, 1);
}

void AddVector(FitReport& report, std::string name, int first, int size) {
  Add(report, std::move(name), FitQuantity::Shape::kVector, first, size, 1);
}

void AddMatrix(FitReport& report, std::string name, int first, int rows, int columns) {
  Add(report, std::move(name), FitQuantity::Shape::kMatrix, first, rows, columns);
}

void AddFixed(FitReport& report, std::string name, FitQuantity::Shape shape,
              Eigen::MatrixXd value) {
  report.result.push_back({std::move(name), shape, std::move(value), {}});
}

std::vector<std::string> VectorNames(std::string_view name, int size) {
  std::vector<std::string> names;
  names.reserve(static_cast<std::size_t>(size));
  for (int i = 0; i < size; ++i) names.push_back(fmt::format("{}[{}]", name, i));
  return names;
}

std::vector<std::string> MatrixNames(std::string_view name, int rows, int columns) {
  std::vector<std::string> names;
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) names.push_back(fmt::format("{}[{},{}]", name, i, j));
  }
  return names;
}

void Append(std::vector<std::string>& names, const std::vector<std::string>& more) {
  names.insert(names.end(), more.begin(), more.end());
}

}  // namespace wellgyro

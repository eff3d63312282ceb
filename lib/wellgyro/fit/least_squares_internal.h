#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/result.h"
#include "wellgyro/calibration/bench_table.h"
#include "wellgyro/calibration/fit_report.h"

namespace wellgyro {

/// Of sound benches, the share in which chance alone makes a finding of one kind: a residual that
/// is too large, a trend, a reference that the readings contradict.
inline constexpr double kFalseAlarm = 0.01;

/// A reading further off than this many of the residuals' robust scale is an outlier: one in 5e8 of
/// a normal distribution.
inline constexpr double kOutlierSigmas = 6;

/// A row of a fit: which reading it is. Line 0 is a prior; of a second table it is negative.
struct FitRow {
  int line = 0;
  std::string channel;
  double unit = 1;      ///< the data's unit in one of the whitened residual, for reports
  bool in_time = true;  ///< false: a difference of readings, which drift does not move
  /// Where rows are whitened together: what one of the data's unit in this reading adds to the
  /// rows of its line. Empty: 1 / unit to this row alone.
  Eigen::VectorXd spread = {};
};

/// A sensor's channel that rows hold together with others, as the length of a vector holds three.
struct SensedChannel {
  std::string name;
  std::vector<Eigen::Index> first;  ///< of its readings, by their order: a row of the problem
  /// What one of the channel's unit more in the reading adds to y from that row on, over sigma.
  std::vector<Eigen::VectorXd> spread;
};

/// y = A x + noise of `sigma`, row by row.
struct LinearProblem {
  std::vector<std::string> parameters;
  Eigen::MatrixXd A;
  Eigen::VectorXd y;
  Eigen::VectorXd sigma;  ///< relative to each other where not sigma_given
  bool sigma_given = false;
  std::vector<FitRow> rows;
  std::vector<SensedChannel> sensed;  ///< beside the rows' own, where those are no channels
  bool robust = true;                 ///< look for outliers, all rows of a line together

  LinearProblem(std::vector<std::string> names, int n_rows);
  int size() const { return static_cast<int>(parameters.size()); }
};

/// What least squares gives, of the rows that were used; see Solve.
struct LinearSolution {
  Eigen::VectorXd x;
  Eigen::MatrixXd cov;       ///< empty where it cannot be known
  Eigen::VectorXd residual;  ///< (y - A x) / sigma, of the rows that were used
  Eigen::VectorXd leverage;
  std::vector<FitRow> rows;  ///< that were used
  int rank = 0;
  double condition = 1;
  double chi_square = 0;
  int dof = 0;
  std::vector<std::string> unseen;  ///< combinations of parameters that the rows do not determine
  std::vector<int> outlier_lines;
};

/// Least squares by singular values of the scaled design; what it cannot see is left at zero and
/// named in `unseen`. Where robust and there are enough rows, outliers are found by Cauchy's loss,
/// left out, and the rest solved without it.
LinearSolution Solve(const LinearProblem& problem);

/// Least squares by Cauchy's loss of all rows, whose scales are the medians of two tables'
/// residuals (lines above zero, and below): no few rows of one move it, nor what the other counts.
/// Residuals are in units of the problem's sigmas.
LinearSolution SolveByMedians(const LinearProblem& problem);

/// What people read of a solution.
FitReport ReportOf(const LinearProblem& problem, const LinearSolution& solution);

/// A reading as people know it, by FitRow::line without its sign.
using LineNames = std::function<std::string(int)>;
/// "line 7".
std::string LineName(int line);

/// The report of a solution that must determine everything: the Fault, of `data`, names what the
/// readings do not, and says `advice`.
Result<FitReport> WholeReport(const BenchTable& data, const LinearProblem& problem,
                              const LinearSolution& solution, std::string_view advice,
                              const LineNames& name = LineName);

/// Takes the report from its parameters to functions of them; the covariance by differences.
void Reparametrise(FitReport& report, std::vector<std::string> names,
                   const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& of);

/// Adds the parameters from `first` on as one quantity of the result.
void AddNumber(FitReport& report, std::string name, int first);
void AddVector(FitReport& report, std::string name, int first, int size);
void AddMatrix(FitReport& report, std::string name, int first, int rows, int columns);
/// A quantity that is no parameter.
void AddFixed(FitReport& report, std::string name, FitQuantity::Shape shape, Eigen::MatrixXd value);

/// "bias[0]", "sensitivity[1,2]".
std::vector<std::string> VectorNames(std::string_view name, int size);
std::vector<std::string> MatrixNames(std::string_view name, int rows, int columns);
/// Adds names behind the others.
void Append(std::vector<std::string>& names, const std::vector<std::string>& more);

}  // namespace wellgyro

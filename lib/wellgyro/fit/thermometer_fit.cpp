#include "wellgyro/fit/thermometer_fit.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/fit/bench_checks_internal.h"
#include "wellgyro/fit/least_squares_internal.h"
#include "wellgyro/math/golden_section.h"
#include "wellgyro/math/median.h"
#include "wellgyro/math/statistics.h"

namespace wellgyro {
namespace {

struct ThermometerReadings {
  Eigen::VectorXd t, error;
  std::vector<int> lines;
  double spread = 0;  ///< of the references about their mean, 1-sigma
};

Result<ThermometerReadings> ReadThermometers(const BenchTable& data) {
  const auto place = FindColumns(data, {"t_m"});
  if (!place) return place.fault();
  std::vector<int> refs;
  for (std::size_t i = 0; i < data.columns.size(); ++i) {
    if (data.columns[i].rfind("ref", 0) == 0) refs.push_back(static_cast<int>(i));
  }
  if (refs.empty()) {
    return BenchFault(data, "the table has no reference thermometer, a column ref1", 1,
                      FaultCode::kForeign);
  }
  if (auto fault = TooFew(data, 4, "temperatures", "read the thermometers at more of them")) {
    return *fault;
  }
  if (auto fault = Repeated(data)) return *fault;
  std::vector<int> all = refs;
  all.push_back(place->front());
  if (auto fault = Frozen(data, all)) return *fault;
  ThermometerReadings readings{data.values.col(place->front()), {}, data.lines, 0};
  const Eigen::MatrixXd references = data.values(Eigen::all, refs);
  const Eigen::VectorXd mean = references.rowwise().mean();
  readings.error = mean - readings.t;
  std::vector<double> sizes;
  for (const double error : readings.error) sizes.push_back(std::abs(error));
  const double middle = Median(std::move(sizes));
  // [degC]; a thermometer further off is not read in degC: K are 273 off, degF 32 + 0.8 T.
  constexpr double kLargest = 20;
  if (middle > kLargest) {
    return BenchFault(data,
                      fmt::format("the references differ from t_m by {:.1f} in the middle of the "
                                  "rows: give all of them in degC",
                                  middle),
                      data.lines[0]);
  }
  if (refs.size() > 1) {
    readings.spread = std::sqrt((references.colwise() - mean).squaredNorm() /
                                static_cast<double>(references.size() - references.rows()));
  }
  return readings;
}

// A knee that was found is a parameter too, linear about its place.
struct FoundKnee {
  double knee = 0, c2 = 0;
};

LinearProblem Problem(const ThermometerReadings& readings, const ThermometerFitSetup& setup,
                      double knee, bool bends, const std::optional<FoundKnee>& found = {}) {
  const int n = static_cast<int>(readings.t.size());
  std::vector<std::string> names = VectorNames("c", bends ? 3 : 2);
  if (found) names.emplace_back("knee_C");
  LinearProblem problem(names, n);
  problem.y = readings.error;
  problem.sigma.setConstant(setup.sigma.value_or(1));
  problem.sigma_given = setup.sigma.has_value();
  for (int i = 0; i < n; ++i) {
    const double t = readings.t[i], above = std::max(0.0, t - knee);
    problem.A(i, 0) = 1;
    problem.A(i, 1) = t;
    if (bends) problem.A(i, 2) = above * above;
    if (found) {
      problem.A(i, 3) = -2 * found->c2 * above;
      problem.y[i] += problem.A(i, 3) * found->knee;
    }
    problem.rows[static_cast<std::size_t>(i)] = {readings.lines[static_cast<std::size_t>(i)], "t_m",
                                                 problem.sigma[i]};
  }
  return problem;
}

// The knee with the least sum of squares, between the third reading from either end.
double FindKnee(const ThermometerReadings& readings, const ThermometerFitSetup& setup) {
  std::vector<double> t(readings.t.begin(), readings.t.end());
  std::sort(t.begin(), t.end());
  const auto cost = [&](double knee) {
    LinearProblem problem = Problem(readings, setup, knee, true);
    problem.robust = false;
    return Solve(problem).chi_square;
  };
  const double low = t[1], high = t[t.size() - 3];
  double best = low;
  // The cost is smooth from reading to reading, with a minimum in each interval at most: more steps
  // than a bench has temperatures.
  constexpr int kGrid = 60;
  const double step = (high - low) / kGrid;
  for (int i = 0; i <= kGrid; ++i) {
    if (cost(low + i * step) < cost(best)) best = low + i * step;
  }
  const auto goes_on = [&](double from, double to) {
    return to - from > 1e-9 * (1 + std::abs(best));
  };
  return GoldenSection(best - step, best + step, cost, goes_on);
}

// A knee without a bend behind it is found anywhere: its place has no meaning where c2 is no larger
// than chance makes the likeliest of many places, P(|t| > limit) = 1e-3 of one.
std::optional<Fault> NoKnee(const BenchTable& data, const FitReport& report) {
  if (report.cov.size() == 0) return std::nullopt;
  const double sigma = std::sqrt(std::max(0.0, report.cov(2, 2)));
  const double limit = report.sigma_given ? -NormalQuantile(5e-4) : StudentLimit(5e-4, report.dof);
  if (std::abs(report.values[2]) > limit * sigma) return std::nullopt;
  return BenchFault(data,
                    fmt::format("no knee is found: beyond {:.4g} degC the readings bend by c[2] = "
                                "{:.2g} +- {:.2g}; leave --fit-knee out",
                                report.values[3], report.values[2], sigma),
                    data.lines[0]);
}

void Remark(const ThermometerReadings& readings, double knee, bool bends, FitReport& report) {
  if (!bends) {
    report.remarks.push_back(fmt::format(
        "no reading beyond the knee at {:.4g} degC: c[2] is left at zero, and the range ends at "
        "{:.4g} degC",
        knee, readings.t.maxCoeff()));
  }
  if (readings.spread > 0) {
    report.remarks.push_back(
        fmt::format("the reference thermometers differ by {:.3g} degC (1 sigma) among themselves",
                    readings.spread));
  }
}

}  // namespace

Result<BenchCalibration> FitThermometer(const BenchTable& data, const ThermometerFitSetup& setup) {
  const Result<ThermometerReadings> readings = ReadThermometers(data);
  if (!readings) return readings.fault();
  double knee = setup.knee;
  if (setup.fit_knee) {
    if (auto fault = TooFew(data, 7, "temperatures", "read on both sides of the knee")) {
      return *fault;
    }
    knee = FindKnee(*readings, setup);
  }
  const double coldest = readings->t.minCoeff(), hottest = readings->t.maxCoeff();
  const bool bends = hottest > knee;
  LinearProblem problem = Problem(*readings, setup, knee, bends);
  const bool found = setup.fit_knee && bends;
  if (found) problem = Problem(*readings, setup, knee, bends, FoundKnee{knee, Solve(problem).x[2]});
  auto whole =
      WholeReport(data, problem, Solve(problem), "read the thermometers at more temperatures");
  if (!whole) return whole.fault();
  BenchCalibration out;
  out.report = *std::move(whole);
  FitReport& report = out.report;
  report.method = "thermometer";
  if (auto fault = DoesNotFit(data, {{"t_m", hottest - coldest}}, report)) return *fault;
  if (found) {
    if (auto fault = NoKnee(data, report)) return *fault;
  }
  std::vector<std::string> names = VectorNames("c", 3);
  if (found) names.emplace_back("knee_C");
  Reparametrise(report, names, [&names](const Eigen::VectorXd& c) {
    Eigen::VectorXd all = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(names.size()));
    all.head(c.size()) = c;
    return all;
  });
  AddVector(report, "c", 0, 3);
  if (found) {
    knee = report.values[3];
    AddNumber(report, "knee_C", 3);
  } else {
    AddFixed(report, "knee_C", FitQuantity::Shape::kNumber, Eigen::MatrixXd::Constant(1, 1, knee));
  }
  Remark(*readings, knee, bends, report);
  const Eigen::VectorXd& c = report.values;
  out.thermometer = ThermometerCalibration{
      .c0 = c[0], .c1 = c[1], .c2 = c[2], .knee = knee, .min = coldest, .max = hottest};
  return out;
}

}  // namespace wellgyro

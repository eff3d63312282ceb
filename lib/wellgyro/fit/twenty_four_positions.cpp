#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/fit/bench_checks_internal.h"
#include "wellgyro/fit/least_squares_internal.h"
#include "wellgyro/fit/position_fit.h"
#include "wellgyro/fit/position_readings_internal.h"
#include "wellgyro/math/linear_algebra.h"

namespace wellgyro {
namespace {

struct Reduced {
  double middle = 0, half_range = 1;  ///< [degC]
  double Of(double temperature) const { return (temperature - middle) / half_range; }
};

Reduced ReducedTemperature(const std::vector<PositionRun>& runs) {
  double low = runs.front().temperature, high = low;
  for (const PositionRun& run : runs) {
    low = std::min(low, run.temperature);
    high = std::max(high, run.temperature);
  }
  return {(low + high) / 2, high > low ? (high - low) / 2 : 1};
}

// Parameters: for every power of tau Vb (3) and S (9); then K2 (3).
std::vector<std::string> Names(int degree) {
  std::vector<std::string> names;
  for (int n = 0; n <= degree; ++n) {
    const std::string tau = n == 0 ? "" : fmt::format("_tau{}", n);
    Append(names, VectorNames("Vb_V" + tau, 3));
    Append(names, MatrixNames("S_V_per_g" + tau, 3, 3));
  }
  Append(names, VectorNames("K2_V_per_g2", 3));
  return names;
}

// The rotations' means and what is left of them, two rows for every axis, direction and channel.
LinearProblem Problem(const std::vector<PositionRun>& runs, const TwentyFourPositionSetup& setup,
                      int degree) {
  const Reduced reduced = ReducedTemperature(runs);
  LinearProblem problem(Names(degree), static_cast<int>(runs.size()) * 36);
  problem.sigma.setConstant(setup.sigma.value_or(1) / 2);
  problem.sigma_given = setup.sigma.has_value();
  const int second = 12 * (degree + 1);
  int row = 0;
  for (const PositionRun& run : runs) {
    for (int at = 0; at < 18; ++at, row += 2) {
      const int axis = at / 6, down = at / 3 % 2, c = at % 3;
      const double u = down != 0 ? -setup.gravity : setup.gravity;
      double power = 1;
      for (int n = 0; n <= degree; ++n, power *= reduced.Of(run.temperature)) {
        problem.A(row, 12 * n + c) = power;
        problem.A(row, 12 * n + 3 + 3 * c + axis) = power * u;
      }
      if (axis == c) problem.A(row, second + c) = u * u;
      problem.y[row] = run.P(axis, down, c);
      problem.y[row + 1] = run.Alternating(axis, down, c);
      const FitRow label{run.Of(axis, down, 0, c).line, std::string(1, "xyz"[c]),
                         problem.sigma[row]};
      const auto first = static_cast<std::size_t>(row);
      problem.rows[first] = problem.rows[first + 1] = label;
      problem.rows[first + 1].in_time = false;
    }
  }
  return problem;
}

// Schwarz's criterion; what the readings' last digits cannot carry counts as nothing.
double Criterion(const LinearProblem& problem, const LinearSolution& solution) {
  const double n = static_cast<double>(problem.y.size());
  const double digits = 1e-11 * problem.y.cwiseQuotient(problem.sigma).cwiseAbs().maxCoeff();
  return n * std::log(solution.chi_square / n + digits * digits) + problem.size() * std::log(n);
}

int Degree(const std::vector<PositionRun>& runs, const TwentyFourPositionSetup& setup) {
  std::vector<double> temperatures;
  temperatures.reserve(runs.size());
  for (const PositionRun& run : runs) temperatures.push_back(run.temperature);
  std::sort(temperatures.begin(), temperatures.end());
  // [degC]: one setting of the oven, as two thermometers that agree to one each may read it.
  constexpr double kApart = 2;
  int distinct = 1;
  double last = temperatures.front();
  for (const double t : temperatures) {
    if (t - last < kApart) continue;
    ++distinct;
    last = t;
  }
  if (temperatures.back() - temperatures.front() < setup.min_temperature_swing) return 0;
  const int most = std::clamp(std::min(setup.max_degree, distinct - 2), 0, 3);
  int best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (int degree = 0; degree <= most; ++degree) {
    const LinearProblem problem = Problem(runs, setup, degree);
    const double criterion = Criterion(problem, Solve(problem));
    if (criterion >= least) continue;
    least = criterion;
    best = degree;
  }
  return best;
}

// The tilt of the bench: of one turn's amplitude in the level channels [rad].
double Tilt(const std::vector<PositionRun>& runs, const Eigen::Matrix3d& S, double gravity,
            double sigma_M) {
  double square = 0;
  for (const PositionRun& run : runs) {
    for (int at = 0; at < 18; ++at) {
      const int axis = at / 6, down = at / 3 % 2, c = at % 3;
      if (axis == c) continue;
      // Noise alone would make an amplitude too: its mean square is taken off.
      square += (run.Harmonic(axis, down, c).squaredNorm() - sigma_M * sigma_M) /
                std::pow(S(c, c) * gravity, 2);
    }
  }
  const double mean = square / (12.0 * static_cast<double>(runs.size()));
  return std::asin(std::sqrt(std::clamp(mean, 0.0, 1.0)));
}

void FreeOfTilt(FitReport& report, int degree, double tilt) {
  Eigen::VectorXd factor = Eigen::VectorXd::Ones(report.values.size());
  for (int n = 0; n <= degree; ++n) factor.segment(12 * n + 3, 9).setConstant(1 / std::cos(tilt));
  report.values = report.values.cwiseProduct(factor);
  if (report.cov.size() > 0) report.cov = factor.asDiagonal() * report.cov * factor.asDiagonal();
}

// What is left of transients in short runs of readings has the same sign in many positions and does
// not show in their residuals: it is an error of bias and sensitivity.
void AddDrift(const std::vector<PositionRun>& runs, double gravity, FitReport& report) {
  double drift = 0;
  for (const PositionRun& run : runs) drift = std::max(drift, run.drift);
  if (drift == 0 || report.cov.size() == 0) return;
  for (int i = 0; i < 12; ++i) {
    report.cov(i, i) += std::pow(i < 3 ? drift : drift / gravity, 2);
  }
  report.remarks.push_back(fmt::format(
      "the readings of a position still change, by {:.3g} V from the first to the last: they are "
      "too few to follow it, the uncertainties of bias and sensitivity hold that much; wait longer "
      "before reading, or read eight times and more",
      drift));
}

// Readings that are all alike round to the same step whatever the rotation, so that neither their
// scatter nor their mean tells the rounding: of every mean it is an error of variance step^2 / 12.
// Noise of a step and more makes it random, and it is in the scatter.
void AddRounding(const std::vector<PositionRun>& runs, const LinearProblem& problem,
                 FitReport& report) {
  const double step = runs.front().step;
  if (!(step > report.scatter) || report.cov.size() == 0) return;
  report.cov += step * step / 12 * InverseOfSymmetric(problem.A.transpose() * problem.A);
  report.remarks.push_back(
      fmt::format("readings come in steps of {:.3g} V, larger than their noise: the uncertainties "
                  "hold what rounding may be; read with a finer converter",
                  step));
}

Eigen::Matrix3d SensitivityOf(const Eigen::VectorXd& values, int power) {
  const Eigen::VectorXd nine = values.segment(12 * power + 3, 9);
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(nine.data());
}

void AddAngles(FitReport& report, const Eigen::Matrix3d& S) {
  Eigen::VectorXd angles(3);
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d a = S.row(i).transpose(), b = S.row((i + 1) % 3).transpose();
    angles[i] = ToDegrees(std::atan2(a.cross(b).norm(), a.dot(b)));
  }
  AddFixed(report, "angle_deg", FitQuantity::Shape::kVector, angles);
}

void AddMeans(FitReport& report, const PositionRun& run) {
  Eigen::MatrixXd M(24, 3), P(3, 6);
  for (int at = 0; at < 72; ++at) {
    M(at / 3, at % 3) = run.readings[static_cast<std::size_t>(at)].volt;
  }
  for (int c = 0; c < 3; ++c) {
    for (int k = 0; k < 6; ++k) P(c, k) = run.P(k / 2, k % 2, c);
  }
  AddFixed(report, "P_V", FitQuantity::Shape::kMatrix, P);
  AddFixed(report, "M_V", FitQuantity::Shape::kMatrix, M);
}

SensorGroup Group(const FitReport& report, int degree, const std::vector<PositionRun>& runs) {
  constexpr double kG = units::kStandardGravity;
  SensorGroup group;
  group.n_channels = 3;
  group.channel = {0, 1, 2};
  group.unit = "V";
  for (int n = 0; n <= degree; ++n) {
    const auto power = static_cast<std::size_t>(n);
    group.bias[power].head<3>() = report.values.segment<3>(Eigen::Index{12} * n);
    group.sensitivity[power].topRows<3>() = SensitivityOf(report.values, n) / kG;
  }
  for (int c = 0; c < 3; ++c) {
    group.second_order(c, c) = report.values[12 * (degree + 1) + c] / (kG * kG);
  }
  if (degree == 0) return group;
  const Reduced reduced = ReducedTemperature(runs);
  group.thermometer = 0;
  group.reference = reduced.middle;
  group.half_range = reduced.half_range;
  group.min = reduced.middle - reduced.half_range;
  group.max = reduced.middle + reduced.half_range;
  return group;
}

struct FittedPositions {
  FitReport report;
  double tilt = 0;
};

Result<FittedPositions> Fit(const BenchTable& data, const std::vector<PositionRun>& runs,
                            const TwentyFourPositionSetup& setup, int degree) {
  const LinearProblem problem = Problem(runs, setup, degree);
  auto whole = WholeReport(data, problem, Solve(problem), "measure all 24 positions");
  if (!whole) return whole.fault();
  FittedPositions fitted{*std::move(whole), 0};
  const Eigen::Matrix3d S = SensitivityOf(fitted.report.values, 0);
  if (auto fault = WrongAxes(data, S, {"x", "y", "z"})) return *fault;
  const double volts_per_g = S.diagonal().cwiseAbs().minCoeff() * setup.gravity;
  if (auto fault = DoesNotFit(data, {{"", volts_per_g}}, fitted.report)) return *fault;
  const double sigma_M = setup.sigma.value_or(fitted.report.scatter);
  fitted.tilt = Tilt(runs, S, setup.gravity, sigma_M);
  FreeOfTilt(fitted.report, degree, fitted.tilt);
  AddDrift(runs, setup.gravity, fitted.report);
  AddRounding(runs, problem, fitted.report);
  return fitted;
}

std::optional<Fault> BadReadings(const BenchTable& data, const std::vector<PositionRun>& runs) {
  BenchTable positions{data.source, {"x", "y", "z"}, Eigen::MatrixXd(24 * runs.size(), 3), {}};
  for (std::size_t i = 0; i < 24 * runs.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const PositionReading& reading = runs[i / 24].readings[i % 24 * 3 + c];
      positions.values(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(c)) = reading.volt;
      if (c == 0) positions.lines.push_back(reading.line);
    }
  }
  if (auto fault = Frozen(positions, {0, 1, 2})) return fault;
  std::vector<UprightReading> upright;
  for (const PositionRun& run : runs) {
    for (int at = 0; at < 24; ++at) {
      const int axis = at / 8, down = at / 4 % 2;
      const PositionReading& reading = run.Of(axis, down, at % 4, axis);
      upright.push_back({axis, down != 0 ? -1.0 : 1.0, reading.volt, reading.line});
    }
  }
  if (auto fault = SwappedPositions(positions, upright)) return fault;
  return MixedUnits(positions, {0, 1, 2}, 0, "the length of (x, y, z)", "volts");
}

void AddRuns(const BenchTable& data, const std::vector<PositionRun>& runs,
             const TwentyFourPositionSetup& setup, FitReport& report) {
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const auto fitted = Fit(data, {runs[i]}, setup, 0);
    if (!fitted) continue;
    FitReport one = fitted->report;
    const std::string prefix = fmt::format("per_T[{}].", i);
    AddFixed(report, prefix + "T_C", FitQuantity::Shape::kNumber,
             Eigen::MatrixXd::Constant(1, 1, runs[i].temperature));
    one.result.clear();
    AddMatrix(one, prefix + "S_V_per_g", 3, 3, 3);
    AddVector(one, prefix + "Vb_V", 0, 3);
    AddVector(one, prefix + "K2_V_per_g2", 12, 3);
    for (FitQuantity& quantity : one.result) report.result.push_back(std::move(quantity));
  }
}

}  // namespace

Result<BenchCalibration> FitTwentyFourPositions(const BenchTable& data,
                                                const TwentyFourPositionSetup& setup) {
  const auto runs = ReadPositionRuns(data, setup.settle_tolerance);
  if (!runs) return runs.fault();
  if (auto fault = BadReadings(data, *runs)) return *fault;
  const bool varies = runs->size() > 1 && runs->front().has_temperature;
  const int degree = varies ? Degree(*runs, setup) : 0;
  auto fitted = Fit(data, *runs, setup, degree);
  if (!fitted) return fitted.fault();
  BenchCalibration out;
  out.report = std::move(fitted->report);
  FitReport& report = out.report;
  report.method = "24-position";
  for (int n = 0; n <= degree; ++n) {
    const std::string tau = n == 0 ? "" : fmt::format("_tau{}", n);
    AddMatrix(report, "S_V_per_g" + tau, 12 * n + 3, 3, 3);
    AddVector(report, "Vb_V" + tau, 12 * n, 3);
  }
  AddVector(report, "K2_V_per_g2", 12 * (degree + 1), 3);
  AddAngles(report, SensitivityOf(report.values, 0));
  AddFixed(report, "tilt_deg", FitQuantity::Shape::kNumber,
           Eigen::MatrixXd::Constant(1, 1, ToDegrees(fitted->tilt)));
  if (runs->size() == 1) AddMeans(report, runs->front());
  if (varies) {
    const Reduced reduced = ReducedTemperature(*runs);
    AddFixed(report, "T0_C", FitQuantity::Shape::kNumber,
             Eigen::MatrixXd::Constant(1, 1, reduced.middle));
    AddFixed(report, "T_half_range_C", FitQuantity::Shape::kNumber,
             Eigen::MatrixXd::Constant(1, 1, reduced.half_range));
    AddRuns(data, *runs, setup, report);
    if (degree == 0) {
      report.remarks.push_back(
          "no polynomial in temperature: the temperatures are too few, too close together, or do "
          "not matter");
    }
  }
  out.accel = Group(report, degree, *runs);
  out.accel.R_TS = ToolFromBench(setup.axes);
  return out;
}

}  // namespace wellgyro

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/fit/bench_checks_internal.h"
#include "wellgyro/fit/least_squares_internal.h"
#include "wellgyro/fit/position_fit.h"
#include "wellgyro/fit/residual_trends_internal.h"

namespace wellgyro {
namespace {

struct Position {
  int axis = 0, line = 0;
  double sign = 1;
  double seconds = 1;
  Eigen::Vector3d u;     ///< specific force [m/s^2]
  Eigen::Vector3d rate;  ///< pulses a second
};

double Mean(const std::vector<Position>& positions, double (*of)(const Position&)) {
  double sum = 0;
  for (const Position& position : positions) sum += of(position);
  return sum / static_cast<double>(positions.size());
}

Result<std::vector<Position>> ReadPositions(const BenchTable& data, const SixPositionSetup& setup) {
  const auto places = FindColumns(data, {"axis", "sign", "T_s", "Nx", "Ny", "Nz"});
  if (!places) return places.fault();
  const std::vector<int>& p = *places;
  const auto ux = data.Find("axb"), uy = data.Find("ayb"), uz = data.Find("azb");
  if (auto fault = Repeated(data)) return *fault;
  std::vector<Position> positions;
  for (int row = 0; row < data.rows(); ++row) {
    const auto value = [&](int column) { return data.values(row, column); };
    Position position;
    position.line = data.lines[static_cast<std::size_t>(row)];
    position.axis = static_cast<int>(value(p[0]));
    position.sign = value(p[1]);
    position.seconds = value(p[2]);
    if (value(p[0]) != 0 && value(p[0]) != 1 && value(p[0]) != 2) {
      return BenchFault(data, "column axis must be x, y or z", position.line);
    }
    if (std::abs(position.sign) != 1) {
      return BenchFault(data, "column sign must be 1 (up) or -1 (down)", position.line);
    }
    if (!(position.seconds > 0)) {
      return BenchFault(data, fmt::format("a position of {} s", position.seconds), position.line);
    }
    position.u = position.sign * setup.gravity * Eigen::Vector3d::Unit(position.axis);
    if (ux && uy && uz) position.u = {value(*ux), value(*uy), value(*uz)};
    if (position.sign * position.u[position.axis] <= 0.5 * position.u.norm()) {
      return BenchFault(data,
                        "axb, ayb, azb do not point where axis and sign say: up and down are "
                        "swapped in one of them",
                        position.line, FaultCode::kConflict);
    }
    position.rate = Eigen::Vector3d(value(p[3]), value(p[4]), value(p[5])) / position.seconds;
    positions.push_back(position);
  }
  return positions;
}

// The forces of the table against the gravity that was stated beside it.
std::optional<Fault> OtherGravity(const BenchTable& data, const std::vector<Position>& positions,
                                  const SixPositionSetup& setup) {
  const double length = Mean(positions, [](const Position& p) { return p.u.norm(); });
  // 100 mGal: one degree of latitude makes up to 90, 300 m of height 93; tilts are of second order.
  constexpr double kSame = 1e-4;
  if (!setup.gravity_stated || std::abs(length / setup.gravity - 1) < kSame) return std::nullopt;
  return BenchFault(data,
                    fmt::format("axb, ayb, azb are {:.6g} m/s2 long on average where the gravity "
                                "given beside them is {:.6g}: mend the one or leave out the other",
                                length, setup.gravity),
                    positions.front().line, FaultCode::kConflict);
}

std::optional<Fault> BadPositions(const BenchTable& data, const std::vector<Position>& positions,
                                  const SixPositionSetup& setup) {
  std::string missing;
  for (int at = 0; at < 6; ++at) {
    const bool there = std::any_of(positions.begin(), positions.end(), [&](const Position& p) {
      return p.axis == at / 2 && (p.sign < 0) == (at % 2 == 1);
    });
    if (!there) {
      missing += fmt::format("{}{} {}", missing.empty() ? "" : ", ", "xyz"[at / 2],
                             at % 2 == 1 ? "down" : "up");
    }
  }
  if (!missing.empty()) {
    return BenchFault(data, fmt::format("six positions are needed; measure {}", missing));
  }
  BenchTable rates{data.source, {"Nx", "Ny", "Nz"}, Eigen::MatrixXd(positions.size(), 3), {}};
  BenchTable forces = rates;
  forces.columns = {"axb", "ayb", "azb"};
  for (std::size_t i = 0; i < positions.size(); ++i) {
    rates.values.row(static_cast<Eigen::Index>(i)) = positions[i].rate.transpose();
    forces.values.row(static_cast<Eigen::Index>(i)) = positions[i].u.transpose();
    rates.lines.push_back(positions[i].line);
  }
  forces.lines = rates.lines;
  if (auto fault = Frozen(rates, {0, 1, 2})) return fault;
  std::vector<UprightReading> upright;
  upright.reserve(positions.size());
  for (const Position& position : positions) {
    upright.push_back({position.axis, position.sign, position.rate[position.axis], position.line});
  }
  if (auto fault = SwappedPositions(rates, upright)) return fault;
  if (auto fault = MixedUnits(rates, {0, 1, 2}, 0, "the length of N/T_s", "pulses and seconds")) {
    return fault;
  }
  if (auto fault =
          MixedUnits(forces, {0, 1, 2}, setup.gravity, "the length of (axb, ayb, azb)", "m/s2")) {
    return fault;
  }
  return OtherGravity(data, positions, setup);
}

// Parameters, pulses a second: offset in the own pair (3), offset elsewhere (3), S (9).
LinearProblem Problem(const std::vector<Position>& positions) {
  std::vector<std::string> names = VectorNames("own_offset", 3);
  Append(names, VectorNames("offset", 3));
  Append(names, MatrixNames("S", 3, 3));
  LinearProblem problem(names, static_cast<int>(positions.size()) * 3);
  for (int row = 0; row < problem.y.size(); ++row) {
    const Position& position = positions[static_cast<std::size_t>(row / 3)];
    const int c = row % 3;
    problem.A(row, c + (position.axis == c ? 0 : 3)) = 1;
    problem.A.block<1, 3>(row, 6 + 3 * c) = position.u.transpose();
    problem.y[row] = position.rate[c];
    problem.rows[static_cast<std::size_t>(row)] = {position.line, fmt::format("N{}", "xyz"[c]), 1};
  }
  return problem;
}

struct Classes {
  double own = 1, level = 1;  ///< sigma where the axis is upright, and where it lies level
  bool given = false;
};

void Weigh(const std::vector<Position>& positions, const Classes& sigma, LinearProblem& problem) {
  for (int row = 0; row < problem.y.size(); ++row) {
    const bool own = positions[static_cast<std::size_t>(row / 3)].axis == row % 3;
    problem.sigma[row] = own ? sigma.own : sigma.level;
    problem.rows[static_cast<std::size_t>(row)].unit = problem.sigma[row];
  }
  problem.sigma_given = sigma.given;
}

// Sigma of the two kinds of rows from their own scatter, where they have any to show.
Classes Scatter(const std::vector<Position>& positions, LinearProblem problem) {
  Classes sigma;
  const double seconds = Mean(positions, [](const Position& p) { return p.seconds; });
  const double rounding = 1 / std::sqrt(12.0) / seconds;
  problem.robust = false;
  for (int turn = 0; turn < 10; ++turn) {
    Weigh(positions, sigma, problem);
    const LinearSolution solution = Solve(problem);
    double square[2] = {}, freedom[2] = {};
    for (int row = 0; row < problem.y.size(); ++row) {
      const bool own = positions[static_cast<std::size_t>(row / 3)].axis == row % 3;
      square[own ? 1 : 0] += std::pow(solution.residual[row] * problem.sigma[row], 2);
      freedom[own ? 1 : 0] += 1 - solution.leverage[row];
    }
    const double before = sigma.level;
    if (freedom[0] > 0.5) sigma.level = std::sqrt(square[0] / freedom[0]);
    sigma.level = std::max(sigma.level, 1e-3 * rounding);
    // One of each position says nothing of its own noise: that of the others stands for it.
    sigma.own = freedom[1] > 0.5 ? std::sqrt(square[1] / freedom[1]) : sigma.level;
    sigma.own = std::max(sigma.own, 1e-3 * rounding);
    if (std::abs(sigma.level - before) < 1e-6 * before) break;
  }
  return sigma;
}

Classes SigmaOf(const std::vector<Position>& positions, const SixPositionSetup& setup,
                const LinearProblem& problem) {
  if (!setup.sigma && !setup.tilt_sigma) return Scatter(positions, problem);
  const double seconds = Mean(positions, [](const Position& p) { return p.seconds; });
  const double counting = *setup.sigma / seconds;
  const Eigen::VectorXd x = Solve(problem).x;
  const double tilt = setup.tilt_sigma.value_or(0) * setup.gravity * (x[6] + x[10] + x[14]) / 3;
  return {counting, std::hypot(counting, tilt), true};
}

// The own pair's offset is k (a0 + k2 g^2), with k2 in 1/(m/s^2); files have it in g/g^2.
void TakeResult(FitReport& report, bool second_order, double g) {
  std::vector<std::string> names = VectorNames("k_pulse_per_s_per_mps2", 3);
  Append(names, VectorNames("a0_mps2", 3));
  Append(names, MatrixNames("E_rad", 3, 3));
  if (second_order) Append(names, VectorNames("k2_g_per_g2", 3));
  Reparametrise(report, names, [=](const Eigen::VectorXd& x) {
    Eigen::VectorXd to(second_order ? 18 : 15);
    for (int c = 0; c < 3; ++c) {
      const double k = x[6 + 4 * c];
      to[c] = k;
      to[3 + c] = (second_order ? x[3 + c] : x[c]) / k;
      for (int j = 0; j < 3; ++j) to[6 + 3 * c + j] = c == j ? 0 : x[6 + 3 * c + j] / k;
      if (second_order) to[15 + c] = (x[c] - x[3 + c]) / (k * g * g) * units::kStandardGravity;
    }
    return to;
  });
  AddVector(report, "k_pulse_per_s_per_mps2", 0, 3);
  AddVector(report, "a0_mps2", 3, 3);
  AddMatrix(report, "E_rad", 6, 3, 3);
  if (second_order) AddVector(report, "k2_g_per_g2", 15, 3);
}

void Remark(const std::vector<Position>& positions, const SixPositionSetup& setup,
            FitReport& report) {
  std::set<std::pair<int, double>> distinct;
  for (const Position& position : positions) distinct.insert({position.axis, position.sign});
  const bool repeated = positions.size() >= 3 * distinct.size();
  if (!setup.second_order) {
    report.remarks.push_back(
        "k2 was not estimated: a0 is that of each axis's own pair, and holds k2 g");
  }
  if (setup.second_order && !repeated && !setup.tilt_sigma) {
    report.remarks.push_back(
        "one rotation a position: a0 and k2 take a tilt of the fixture for their own (1 arcsec is "
        "4.85 ug); rotate and repeat the positions, give the tilt's sigma, or leave k2 out");
  }
}

SensorGroup Group(const Eigen::VectorXd& x, bool second_order) {
  SensorGroup group;
  group.n_channels = 3;
  group.channel = {0, 1, 2};
  group.unit = "pulse/s";
  group.per_second = true;
  constexpr double kG = units::kStandardGravity;
  for (int c = 0; c < 3; ++c) {
    const double k = x[c];
    group.bias[0][c] = k * x[3 + c];
    for (int j = 0; j < 3; ++j) group.sensitivity[0](c, j) = k * (c == j ? 1 : x[6 + 3 * c + j]);
    if (second_order) group.second_order(c, c) = k * x[15 + c] / kG;
  }
  return group;
}

}  // namespace

Result<BenchCalibration> FitSixPositions(const BenchTable& data, const SixPositionSetup& setup) {
  if (setup.tilt_sigma && !setup.sigma) {
    throw std::invalid_argument("the tilt's sigma needs that of the pulses beside it");
  }
  const auto positions = ReadPositions(data, setup);
  if (!positions) return positions.fault();
  if (auto fault = BadPositions(data, *positions, setup)) return *fault;
  LinearProblem problem = Problem(*positions);
  Weigh(*positions, SigmaOf(*positions, setup, problem), problem);
  auto whole = WholeReport(data, problem, Solve(problem), "measure all six positions");
  if (!whole) return whole.fault();
  const Eigen::VectorXd nine = whole->values.tail<9>();
  const Eigen::Matrix3d S =
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(nine.data());
  if (auto fault = WrongAxes(data, S, {"Nx", "Ny", "Nz"})) return *fault;

  BenchCalibration out;
  out.report = *std::move(whole);
  FitReport& report = out.report;
  if (auto fault =
          DoesNotFit(data, {{"", S.diagonal().cwiseAbs().minCoeff() * setup.gravity}}, report)) {
    return *fault;
  }
  report.method = "six-position";
  RemarkTemperature(data, report);
  const double g = Mean(*positions, [](const Position& p) { return p.u.norm(); });
  TakeResult(report, setup.second_order, g);
  Remark(*positions, setup, report);
  out.accel = Group(report.values, setup.second_order);
  out.accel.R_TS = ToolFromBench(setup.axes);
  return out;
}

}  // namespace wellgyro

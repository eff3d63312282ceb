#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/fit/gyro_problem_internal.h"
#include "wellgyro/math/median.h"

namespace wellgyro {
namespace {

std::vector<std::string> Names(const GyroLayout& layout) {
  std::vector<std::string> names;
  for (int c = 0; c < layout.channels; ++c) {
    names.push_back(fmt::format("b_degh[{}]", c));
    for (int j = 0; j < 3; ++j) names.push_back(fmt::format("U[{},{}]", c, j));
  }
  if (layout.dual) Append(names, VectorNames("MQ", 2 * layout.rotors));
  for (const int c : layout.full) {
    for (int j = 0; j < 3; ++j) names.push_back(fmt::format("G_degh_per_g[{},{}]", c, j));
  }
  for (std::size_t k = 0; layout.aniso && k < layout.paired.size(); ++k) {
    names.push_back(fmt::format("aniso_degh_per_g2[{}]", layout.paired[k]));
  }
  if (layout.north) names.emplace_back("north_rad");
  return names;
}

int PlaceOf(const std::vector<int>& channels, int c) {
  const auto at = std::find(channels.begin(), channels.end(), c);
  return at == channels.end() ? -1 : static_cast<int>(at - channels.begin());
}

// Coefficients of the force's parameters in one row.
void FillForce(const GyroReadings& readings, const GyroLayout& layout, int i, int c,
               Eigen::MatrixXd::RowXpr row) {
  const Eigen::Vector3d f = readings.f.row(i).transpose();
  const int full = PlaceOf(layout.full, c), paired = PlaceOf(layout.paired, c);
  if (full >= 0) row.segment<3>(layout.full_first() + 3 * full) = f.transpose();
  for (std::size_t k = 0; k < readings.rotors.size(); ++k) {
    const Rotor& rotor = readings.rotors[k];
    if (c != rotor.a && c != rotor.c) continue;
    const double f_a = f[readings.channels[static_cast<std::size_t>(rotor.a)].axis];
    const double f_c = f[readings.channels[static_cast<std::size_t>(rotor.c)].axis];
    const int at = layout.force_first() + 2 * static_cast<int>(k);
    if (layout.dual) {
      row[at] = c == rotor.a ? f_a : f_c;
      row[at + 1] = c == rotor.a ? f_c : -f_a;
    }
    if (layout.aniso) {
      row[layout.aniso_first() + paired] = (c == rotor.a ? f_a : f_c) * f[rotor.spin];
    }
  }
}

// Negative on a joined rate table: its lines are those of another file.
int LineOf(const GyroReadings& readings, int i) {
  const auto at = static_cast<std::size_t>(i);
  return readings.joined && readings.on_table[at] != 0 ? -readings.lines[at] : readings.lines[at];
}

// About a fixture turned by `north` [rad], with the sensitivities U of the last turn.
LinearProblem Problem(const GyroReadings& readings, const GyroFitSetup& setup,
                      const GyroLayout& layout, double north, const Eigen::MatrixX3d& U,
                      double on_table) {
  LinearProblem problem(Names(layout), readings.rows() * layout.channels);
  problem.sigma_given = setup.sigma.has_value();
  const double at_rest = setup.sigma.value_or(1);
  const double cosine = std::cos(north), sine = std::sin(north);
  for (int i = 0; i < readings.rows(); ++i) {
    const Eigen::Vector3d level = readings.w_level.row(i).transpose();
    const Eigen::Vector3d across = readings.w_north.row(i).transpose();
    const Eigen::Vector3d w = readings.w.row(i).transpose() + (cosine - 1) * level + sine * across;
    const Eigen::Vector3d slope = cosine * across - sine * level;
    for (int c = 0; c < layout.channels; ++c) {
      const int row = i * layout.channels + c;
      const Eigen::Index first = Eigen::Index{4} * c;
      problem.A(row, first) = 1;
      problem.A.block<1, 3>(row, first + 1) = w.transpose();
      FillForce(readings, layout, i, c, problem.A.row(row));
      problem.y[row] = readings.m(i, c);
      if (layout.north) {
        problem.A(row, layout.north_first()) = U.row(c).dot(slope);
        problem.y[row] += U.row(c).dot(slope) * north;
      }
      problem.sigma[row] = readings.on_table[static_cast<std::size_t>(i)] != 0 ? on_table : at_rest;
      problem.rows[static_cast<std::size_t>(row)] = {
          LineOf(readings, i), readings.channels[static_cast<std::size_t>(c)].name,
          problem.sigma[row]};
    }
  }
  return problem;
}

FittedGyros FitWith(const GyroReadings& readings, const GyroFitSetup& setup,
                    const GyroLayout& layout, double on_table,
                    LinearSolution (*solve)(const LinearProblem&)) {
  Eigen::MatrixX3d U = Eigen::MatrixX3d::Zero(layout.channels, 3);
  for (int c = 0; c < layout.channels; ++c) {
    U(c, readings.channels[static_cast<std::size_t>(c)].axis) = 1;
  }
  double north = 0;
  FittedGyros fitted{Problem(readings, setup, layout, north, U, on_table), {}};
  fitted.solution = solve(fitted.problem);
  // Bilinear in U and the north offset: Gauss and Newton.
  for (int turn = 0; layout.north && turn < 50; ++turn) {
    const double next = fitted.solution.x[layout.north_first()];
    for (int c = 0; c < layout.channels; ++c) {
      U.row(c) = fitted.solution.x.segment<3>(4 * c + 1).transpose();
    }
    const bool still = std::abs(next - north) < 1e-14;
    north = next;
    fitted.problem = Problem(readings, setup, layout, north, U, on_table);
    fitted.solution = solve(fitted.problem);
    if (still) break;
  }
  return fitted;
}

// By how much the table's readings scatter more than those at rest, over their sigmas: by median or
// by squares, each residual freed of what the fit took of it.
double TableRatio(const LinearSolution& s, bool sigma_given, bool by_median) {
  std::vector<double> sizes[2];
  double square[2] = {}, redundancy[2] = {};
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    const int table = s.rows[i].line < 0 ? 1 : 0;
    const double rest = std::max(1e-9, 1 - s.leverage[at]);
    square[table] += s.residual[at] * s.residual[at];
    redundancy[table] += rest;
    sizes[table].push_back(std::abs(s.residual[at]) / std::sqrt(rest));
  }
  constexpr double kEnough = 6;  // a scatter to 1 / sqrt(12) = 29 %
  if (redundancy[0] < kEnough || redundancy[1] < kEnough) return 1;
  double scatter[2];
  for (int table = 0; table < 2; ++table) {
    scatter[table] = by_median ? RobustSigma(std::move(sizes[table]))
                               : std::sqrt(square[table] / redundancy[table]);
  }
  if (sigma_given) scatter[0] = 1;
  return scatter[0] > 0 && scatter[1] > 0 ? scatter[1] / scatter[0] : 1;
}

}  // namespace

GyroLayout LayoutOf(const GyroReadings& readings, const GyroFitSetup& setup) {
  GyroLayout layout;
  layout.channels = static_cast<int>(readings.channels.size());
  layout.rotors = static_cast<int>(readings.rotors.size());
  const GyroForceModel of_rotors = setup.force.value_or(GyroForceModel::kDualAxis);
  const GyroForceModel of_others = setup.force.value_or(GyroForceModel::kFull);
  layout.dual = layout.aniso = layout.rotors > 0 && of_rotors == GyroForceModel::kDualAxis;
  for (const Rotor& rotor : readings.rotors) {
    layout.paired.insert(layout.paired.end(), {rotor.a, rotor.c});
  }
  std::sort(layout.paired.begin(), layout.paired.end());
  for (int c = 0; c < layout.channels; ++c) {
    const GyroForceModel of = PlaceOf(layout.paired, c) >= 0 ? of_rotors : of_others;
    if (of == GyroForceModel::kFull) layout.full.push_back(c);
  }
  layout.north = setup.fit_north;
  return layout;
}

FittedGyros FitLayout(const GyroReadings& readings, const GyroFitSetup& setup,
                      const GyroLayout& layout) {
  double on_table = setup.sigma_table.value_or(setup.sigma.value_or(1));
  if (setup.sigma_table || !readings.joined) {
    return FitWith(readings, setup, layout, on_table, Solve);
  }
  std::optional<FittedGyros> fitted;
  // All readings first, their medians, for a start; then without the outliers, their squares.
  for (const bool last : {false, true}) {
    const double still = last ? 1e-6 : 1e-2;
    for (int turn = 0; turn < 30; ++turn) {
      fitted = FitWith(readings, setup, layout, on_table, last ? Solve : SolveByMedians);
      const double ratio = TableRatio(fitted->solution, setup.sigma.has_value(), !last);
      if (std::abs(ratio - 1) < still) break;
      on_table *= ratio;
    }
  }
  return *std::move(fitted);
}

LinearProblem ProblemAbout(const GyroReadings& readings, const GyroFitSetup& setup,
                           const GyroLayout& layout, const FittedGyros& fitted,
                           const Eigen::VectorXd& x) {
  Eigen::MatrixX3d U(layout.channels, 3);
  for (int c = 0; c < layout.channels; ++c) U.row(c) = x.segment<3>(4 * c + 1).transpose();
  const double north = layout.north ? x[layout.north_first()] : 0;
  LinearProblem problem = Problem(readings, setup, layout, north, U, 1);
  problem.sigma = fitted.problem.sigma;
  return problem;
}

}  // namespace wellgyro

#include "wellgyro/fit/roll_test.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Dense>
#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/fit/attitude_table_internal.h"
#include "wellgyro/fit/bench_checks_internal.h"
#include "wellgyro/fit/least_squares_internal.h"
#include "wellgyro/fit/residual_trends_internal.h"
#include "wellgyro/math/linear_algebra.h"

namespace wellgyro {
namespace {

// The set's places from 0, of each row.
std::vector<int> SetsOf(const BenchTable& data, int column) {
  std::map<double, int> places;
  std::vector<int> sets;
  for (int row = 0; row < data.rows(); ++row) {
    const auto place = static_cast<int>(places.size());
    sets.push_back(places.emplace(data.values(row, column), place).first->second);
  }
  return sets;
}

// By their variation about the sets' means; last the one that varies least.
Eigen::Matrix3d Directions(const Eigen::MatrixX3d& f, const std::vector<int>& sets, int n_sets) {
  Eigen::MatrixX3d mean = Eigen::MatrixX3d::Zero(n_sets, 3);
  Eigen::VectorXd count = Eigen::VectorXd::Zero(n_sets);
  for (Eigen::Index i = 0; i < f.rows(); ++i) {
    mean.row(sets[static_cast<std::size_t>(i)]) += f.row(i);
    count[sets[static_cast<std::size_t>(i)]] += 1;
  }
  Eigen::MatrixX3d centred = f;
  for (Eigen::Index i = 0; i < f.rows(); ++i) {
    const int set = sets[static_cast<std::size_t>(i)];
    centred.row(i) -= mean.row(set) / count[set];
  }
  return SingularValuesOf(centred).V;
}

std::optional<Fault> BadRolls(const BenchTable& data, const AttitudeTable& table, double gravity) {
  if (auto fault = TooFew(data, 6, "readings", "roll the tool right round, every 45 deg")) {
    return fault;
  }
  if (auto fault = BadReadings(data, table)) return fault;
  return MixedUnits(data, ColumnsOf(data, table.accel_channels), gravity,
                    "the length of the readings", "g or m/s2");
}

// An axis near that of the rolls; from it to that is linear: axis + x[0] e1 + x[1] e2.
struct NearAxis {
  Eigen::Vector3d axis, e1, e2;

  Eigen::Vector3d With(const Eigen::VectorXd& x) const {
    return (axis + x[0] * e1 + x[1] * e2).normalized();
  }
};

// From z [rad].
double AngleFromZ(const Eigen::Vector3d& axis) {
  return std::atan2(std::hypot(axis.x(), axis.y()), axis.z());
}

Result<NearAxis> FindAxis(const BenchTable& data, const Eigen::Matrix3d& directions) {
  const Eigen::Vector3d last = directions.col(2);
  const Eigen::Vector3d axis = last.z() < 0 ? Eigen::Vector3d(-last) : last;
  const double off = AngleFromZ(axis);
  if (off > kPi / 6) {
    return BenchFault(data,
                      fmt::format("the axis of the rolls lies {:.0f} deg from the sensors' z: "
                                  "exchange the columns, or the tool was not rolled about itself",
                                  ToDegrees(off)),
                      data.lines[0]);
  }
  const Eigen::Vector3d e1 = directions.col(0);
  return NearAxis{axis, e1, axis.cross(e1)};
}

// The two tilts of the axis from `about`, and what each set reads along the axis.
LinearProblem Problem(const AttitudeTable& table, const std::vector<int>& sets, int n_sets,
                      const NearAxis& about, const std::optional<double>& sigma) {
  std::vector<std::string> names = {"tilt_1", "tilt_2"};
  Append(names, VectorNames("along", n_sets));
  LinearProblem problem(names, table.rows());
  problem.sigma.setConstant(sigma.value_or(1));
  problem.sigma_given = sigma.has_value();
  for (int i = 0; i < table.rows(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    const Eigen::Vector3d f = table.accel.row(i).transpose();
    problem.A(i, 0) = f.dot(about.e1);
    problem.A(i, 1) = f.dot(about.e2);
    problem.A(i, 2 + sets[at]) = -1;
    problem.y[i] = -f.dot(about.axis);
    problem.rows[at] = {table.lines[at], "along", problem.sigma[i]};
  }
  return problem;
}

}  // namespace

Result<BenchCalibration> FitRollTest(const BenchTable& data, const RollTestSetup& setup) {
  const auto set_column = FindColumns(data, {"set"});
  if (!set_column) return set_column.fault();
  const auto table = ReadAttitudeTable(data, {.accel = true});
  if (!table) return table.fault();
  if (auto fault = BadRolls(data, *table, setup.reference.gravity)) return *fault;
  const std::vector<int> sets = SetsOf(data, set_column->front());
  const int n_sets = 1 + *std::max_element(sets.begin(), sets.end());
  const auto about = FindAxis(data, Directions(table->accel, sets, n_sets));
  if (!about) return about.fault();
  const LinearProblem problem = Problem(*table, sets, n_sets, *about, setup.sigma);
  auto whole = WholeReport(data, problem, Solve(problem),
                           "roll the tool right round, and at inclinations where "
                           "gravity lies across it");
  if (!whole) return whole.fault();
  BenchCalibration out;
  out.report = *std::move(whole);
  FitReport& report = out.report;
  report.method = "roll-test";
  RemarkTemperature(data, report);
  const double length = table->accel.rowwise().norm().maxCoeff();
  if (auto fault = DoesNotFit(data, {{"along", length}}, report)) return *fault;
  Reparametrise(report, VectorNames("axis_in_sensor", 3),
                [&](const Eigen::VectorXd& x) { return Eigen::VectorXd(about->With(x)); });
  AddVector(report, "axis_in_sensor", 0, 3);
  out.axis_B = report.values;
  AddFixed(report, "misalignment_deg", FitQuantity::Shape::kNumber,
           Eigen::MatrixXd::Constant(1, 1, ToDegrees(AngleFromZ(report.values))));
  return out;
}

}  // namespace wellgyro

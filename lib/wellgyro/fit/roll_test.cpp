#include "wellgyro/fit/roll_test.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/Dense>
#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/fit/attitude_table_internal.h"
#include "wellgyro/fit/bench_checks_internal.h"
#include "wellgyro/fit/least_squares_internal.h"

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

// The direction of least variation about the sets' means.
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
  return Eigen::JacobiSVD<Eigen::MatrixXd>(centred, Eigen::ComputeThinV).matrixV();
}

}  // namespace

Result<BenchCalibration> FitRollTest(const BenchTable& data, const RollTestSetup& setup) {
  const auto set_column = FindColumns(data, {"set"});
  if (!set_column) return set_column.fault();
  const auto table = ReadAttitudeTable(data, {.accel = true});
  if (!table) return table.fault();
  if (auto fault = TooFew(data, 6, "readings", "roll the tool right round, every 45 deg")) {
    return *fault;
  }
  if (auto fault = BadReadings(data, *table)) return *fault;
  if (auto fault =
          MixedUnits(data,
                     {*data.Find(table->accel_channels[0]), *data.Find(table->accel_channels[1]),
                      *data.Find(table->accel_channels[2])},
                     setup.reference.gravity, "the length of the readings", "g or m/s2")) {
    return *fault;
  }
  const std::vector<int> sets = SetsOf(data, set_column->front());
  const int n_sets = 1 + *std::max_element(sets.begin(), sets.end());
  const Eigen::Matrix3d V = Directions(table->accel, sets, n_sets);
  const Eigen::Vector3d axis = (V(2, 2) < 0 ? -1 : 1) * V.col(2);
  const double off = std::atan2(std::hypot(axis.x(), axis.y()), axis.z());
  if (off > kPi / 6) {
    return BenchFault(data,
                      fmt::format("the axis of the rolls lies {:.0f} deg from the sensors' z: "
                                  "exchange the columns, or the tool was not rolled about itself",
                                  ToDegrees(off)),
                      data.lines[0]);
  }
  const Eigen::Vector3d e1 = V.col(0), e2 = axis.cross(e1);

  // About it: axis + alpha e1 + beta e2, and what each set reads along it.
  std::vector<std::string> names = {"tilt_1", "tilt_2"};
  for (const std::string& name : VectorNames("along", n_sets)) names.push_back(name);
  LinearProblem problem(names, data.rows());
  problem.sigma.setConstant(setup.sigma.value_or(1));
  problem.sigma_given = setup.sigma.has_value();
  for (int i = 0; i < data.rows(); ++i) {
    const Eigen::Vector3d f = table->accel.row(i).transpose();
    problem.A(i, 0) = f.dot(e1);
    problem.A(i, 1) = f.dot(e2);
    problem.A(i, 2 + sets[static_cast<std::size_t>(i)]) = -1;
    problem.y[i] = -f.dot(axis);
    problem.rows[static_cast<std::size_t>(i)] = {data.lines[static_cast<std::size_t>(i)], "along",
                                                 problem.sigma[i]};
  }
  const auto solution = SolveWhole(problem,
                                   "roll the tool right round, and at inclinations where "
                                   "gravity lies across it");
  if (!solution) return BenchFault(data, solution.fault().text);
  BenchCalibration out;
  out.report = ReportOf(problem, *solution);
  FitReport& report = out.report;
  report.method = "roll-test";
  const double length = table->accel.rowwise().norm().maxCoeff();
  if (auto fault = DoesNotFit(data, {{"along", length}}, report)) return *fault;
  Reparametrise(report, VectorNames("axis_in_sensor", 3), [&](const Eigen::VectorXd& x) {
    return Eigen::VectorXd((axis + x[0] * e1 + x[1] * e2).normalized());
  });
  AddVector(report, "axis_in_sensor", 0, 3);
  const Eigen::Vector3d found = report.values;
  AddFixed(report, "misalignment_deg", FitQuantity::Shape::kNumber,
           Eigen::MatrixXd::Constant(
               1, 1, ToDegrees(std::atan2(std::hypot(found.x(), found.y()), found.z()))));
  out.axis = found;
  return out;
}

}  // namespace wellgyro

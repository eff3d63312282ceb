#include "wellgyro/fit/scalar_fit.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Dense>
#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/fit/bench_checks_internal.h"
#include "wellgyro/fit/residual_trends_internal.h"
#include "wellgyro/fit/scalar_internal.h"
#include "wellgyro/fit/scalar_start_internal.h"
#include "wellgyro/fit/sensor_groups_internal.h"
#include "wellgyro/math/linear_algebra.h"
#include "wellgyro/math/median.h"

namespace wellgyro {
namespace {

constexpr std::string_view kScalarAdvice =
    "faces alone, or one cone, do not do: add attitudes with gravity between the axes, 18 to 24 in "
    "all";

struct LengthResidual {
  Eigen::Vector3d v;
  double length, weight;
  template <class T>
  bool operator()(const T* const* p, T* r) const {
    using std::sqrt;
    const T* m = p[0];
    const T x = v[0] - m[6], y = v[1] - m[7], z = v[2] - m[8];
    const T fx = m[0] * x, fy = m[1] * x + m[2] * y, fz = m[3] * x + m[4] * y + m[5] * z;
    r[0] = (sqrt(fx * fx + fy * fy + fz * fz) - length) * weight;
    return true;
  }
};

std::vector<std::string> Names() {
  std::vector<std::string> names = {"M[0,0]", "M[1,0]", "M[1,1]", "M[2,0]", "M[2,1]", "M[2,2]"};
  Append(names, VectorNames("b", 3));
  return names;
}

// What a reading's sigma comes to in the length, at row i.
double SigmaOf(const ScalarReadings& readings, const Eigen::VectorXd& x, Eigen::Index i) {
  if (!readings.sigma) return 1;
  const Eigen::Matrix3d M = LowerOf(x);
  const Eigen::Vector3d f = M * (readings.v.row(i).transpose() - x.tail<3>());
  return *readings.sigma * (M.transpose() * f.normalized()).norm();
}

NonlinearProblem Problem(const ScalarReadings& readings, const Eigen::VectorXd& start) {
  NonlinearProblem problem(Names(), start);
  problem.sigma_given = readings.sigma.has_value();
  for (Eigen::Index i = 0; i < readings.v.rows(); ++i) {
    const double sigma = SigmaOf(readings, start, i);
    problem.Add({{readings.lines[static_cast<std::size_t>(i)], "length", sigma}},
                LengthResidual{readings.v.row(i).transpose(), readings.length, 1 / sigma});
  }
  return problem;
}

}  // namespace

Result<NonlinearProblem::Solution> SolveScalar(const ScalarReadings& readings) {
  std::optional<NonlinearProblem::Solution> best;
  std::optional<Fault> fault;
  for (const Eigen::VectorXd& start : ScalarStarts(readings.v, readings.length)) {
    auto solution = Problem(readings, start).Solve();
    if (!solution) {
      fault = solution.fault();
      continue;
    }
    // Fewer outliers first, then the smaller cost.
    if (!best || std::pair(solution->outlier_lines.size(), solution->cost) <
                     std::pair(best->outlier_lines.size(), best->cost)) {
      best = *std::move(solution);
    }
  }
  if (!best) return *fault;
  // Signs of rows of M are free; a sensor's own axis reads upwards.
  Eigen::VectorXd& x = best->x;
  if (x[0] < 0) x[0] = -x[0];
  if (x[2] < 0) x.segment<2>(1) *= -1;
  if (x[5] < 0) x.segment<3>(3) *= -1;
  if (!readings.sigma) {
    // About x again, with its signs.
    NonlinearProblem problem = Problem(readings, x);
    return problem.Solve();
  }
  // The weights were those of the start.
  return Problem(readings, x).Solve();
}

std::optional<Fault> BadVectors(const BenchTable& data, const Eigen::MatrixX3d& v,
                                const std::vector<std::string>& channels, std::string_view units) {
  BenchTable about{data.source, channels, v, data.lines};
  for (int c = 0; c < 3; ++c) {
    about.values.col(c).array() -= Median({v.col(c).begin(), v.col(c).end()});
  }
  // A quarter of the readings may lie close to the middle by chance; three times too long is never.
  std::vector<double> lengths;
  for (const auto& row : about.values.rowwise()) lengths.push_back(row.norm());
  std::vector<double> sorted = lengths;
  std::sort(sorted.begin(), sorted.end());
  const double middle = sorted[sorted.size() / 2];
  std::vector<int> lines;
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    if (lengths[i] > 5 * middle) lines.push_back(data.lines[i]);
  }
  if (lines.size() < 2) return std::nullopt;
  return BenchFault(data,
                    fmt::format("{}: the readings are more than five times as large as those of "
                                "the other rows: units are mixed; give every row in {}",
                                LinesText(lines), units),
                    lines.front(), FaultCode::kConflict);
}

std::optional<Fault> OnlyCones(const BenchTable& data, const ScalarReadings& readings,
                               const std::vector<int>& outlier_lines) {
  const Eigen::VectorXd sphere = ScalarStarts(readings.v, readings.length).front();
  const double unit = readings.length / sphere[0];
  std::vector<Eigen::Matrix<double, 1, 10>> rows;
  for (std::size_t i = 0; i < readings.lines.size(); ++i) {
    if (std::count(outlier_lines.begin(), outlier_lines.end(), readings.lines[i]) > 0) continue;
    const Eigen::Vector3d w =
        (readings.v.row(static_cast<Eigen::Index>(i)).transpose() - sphere.tail<3>()) / unit;
    rows.emplace_back();
    rows.back() << w.x() * w.x(), w.y() * w.y(), w.z() * w.z(), w.x() * w.y(), w.y() * w.z(),
        w.z() * w.x(), w.transpose(), 1;
  }
  constexpr std::size_t kUnknown = 10;  // coefficients of a quadric, to a common factor
  if (rows.size() < kUnknown) return TooFew(data, 12, "attitudes", kScalarAdvice);
  Eigen::MatrixXd A(static_cast<Eigen::Index>(rows.size()), 10);
  for (std::size_t i = 0; i < rows.size(); ++i) A.row(static_cast<Eigen::Index>(i)) = rows[i];
  const Eigen::VectorXd values =
      SingularValuesOf(A).values / std::sqrt(static_cast<double>(rows.size()));
  // All readings lie on one quadric, to the noise. Where they come as close to a second, as the
  // readings on one cone or two do to a pair of planes, noise alone tells the two apart. Of sets of
  // 12 to 26 attitudes with noise up to 1e-3 of the length sound ones miss the second by 0.13 to
  // 0.29, 95 % of them over 140 times the first; cones and faces by 1.3 of the noise at most, three
  // times the first (median; tests/bench/RESULTS.md). 2e-3 is beyond that; six times serves where
  // the noise is larger. It weighs two cones that pass against sound sets of 12 that are refused:
  // at 1 % of the length 6 % at the worst, and 9 %; with ten times 0.7 % and 27 %.
  constexpr double kApart = 6, kLeast = 2e-3;
  if (values[8] > std::max(kApart * values[9], kLeast)) return std::nullopt;
  return BenchFault(
      data,
      fmt::format("the readings lie on one or two cones, or on faces alone: beside the ellipsoid "
                  "that is looked for they fit another surface to {:.2g} of their length, and only "
                  "noise tells which ({:.2g}): {}",
                  values[8], values[9], kScalarAdvice));
}

std::optional<Fault> OtherUnit(const BenchTable& data, const std::vector<std::string>& channels,
                               const Eigen::Matrix3d& sensitivity,
                               const BenchReference& reference) {
  if (channels.front().front() == 'v') return std::nullopt;
  const double gain = std::cbrt(std::abs(sensitivity.determinant())) / units::kStandardGravity;
  const bool in_g = std::abs(reference.gravity - reference.gravity_mps2) > 1;
  // Makers' scales in a unit are within 3 % of it; the wrong unit is a factor of 9.8.
  constexpr double kClose = 0.03;
  if (in_g && std::abs(gain - 1) < kClose) {
    return BenchFault(
        data,
        "the readings are 9.8 times the gravity that is given in g: they are in m/s2; "
        "give --gravity-mps2",
        data.lines[0], FaultCode::kConflict);
  }
  if (!in_g && std::abs(gain * units::kStandardGravity * units::kStandardGravity - 1) < kClose) {
    return BenchFault(data,
                      "the readings are a 9.8th of the gravity that is given in m/s2: they are in "
                      "g; give --gravity-g",
                      data.lines[0], FaultCode::kConflict);
  }
  return std::nullopt;
}

namespace {

// Channels as the lengths hold them: of a reading v the length's slope is M' f / |f|, and y holds
// the length given less the one read.
std::vector<SensedChannel> SensedOf(const ScalarReadings& readings,
                                    const std::vector<std::string>& channels,
                                    const NonlinearProblem::Solution& solution) {
  const Eigen::Matrix3d M = LowerOf(solution.x);
  std::vector<SensedChannel> sensed(3);
  for (std::size_t c = 0; c < 3; ++c) sensed[c].name = channels[c];
  std::size_t at = 0;
  for (std::size_t row = 0; row < solution.linear.rows.size(); ++row) {
    const FitRow& label = solution.linear.rows[row];
    while (readings.lines[at] != label.line) ++at;
    const Eigen::Vector3d v = readings.v.row(static_cast<Eigen::Index>(at)).transpose();
    const Eigen::Vector3d slope = M.transpose() * (M * (v - solution.x.tail<3>())).normalized();
    for (std::size_t c = 0; c < 3; ++c) {
      sensed[c].first.push_back(static_cast<Eigen::Index>(row));
      sensed[c].spread.push_back(
          Eigen::VectorXd::Constant(1, -slope[static_cast<Eigen::Index>(c)] / label.unit));
    }
  }
  return sensed;
}

void RemarkFew(const BenchTable& data, FitReport& report) {
  if (data.rows() >= 18) return;
  report.remarks.push_back(
      fmt::format("{} attitudes are few for nine parameters: 18 to 24, some with gravity between "
                  "the axes, halve the uncertainty",
                  data.rows()));
}

}  // namespace

Result<BenchCalibration> FitScalar(const BenchTable& data, const ScalarSetup& setup) {
  const auto table = ReadAttitudeTable(data, {.accel = true});
  if (!table) return table.fault();
  if (auto fault = TooFew(data, 12, "attitudes", kScalarAdvice)) return *fault;
  if (auto fault = BadReadings(data, *table)) return *fault;
  if (auto fault = BadVectors(data, table->accel, table->accel_channels, "one unit")) return *fault;
  const ScalarReadings readings{table->lines, table->accel, setup.reference.gravity,
                                setup.sigma_accel};
  auto solution = SolveScalar(readings);
  if (!solution) {
    if (auto fault = OnlyCones(data, readings, {})) return *fault;
  } else {
    solution->linear.sensed = SensedOf(readings, table->accel_channels, *solution);
  }
  auto whole = WholeReport(data, solution, kScalarAdvice);
  if (!whole) return whole.fault();
  if (auto fault = OnlyCones(data, readings, solution->outlier_lines)) return *fault;
  BenchCalibration out;
  out.report = *std::move(whole);
  FitReport& report = out.report;
  report.method = "scalar";
  if (auto fault = DoesNotFit(data, {{"length", setup.reference.gravity}}, report)) return *fault;
  const Eigen::Matrix3d M = LowerOf(report.values);
  if (auto fault = OtherUnit(data, table->accel_channels, M.inverse(), setup.reference)) {
    return *fault;
  }
  RemarkTemperature(data, report);
  std::vector<std::string> names = MatrixNames("Ka", 3, 3);
  Append(names, VectorNames("ba", 3));
  Reparametrise(report, names, [](const Eigen::VectorXd& x) {
    const Eigen::Matrix3d K = LowerOf(x).inverse();
    Eigen::VectorXd to(12);
    to << K.row(0).transpose(), K.row(1).transpose(), K.row(2).transpose(), x.tail<3>();
    return to;
  });
  AddMatrix(report, "Ka", 0, 3, 3);
  AddVector(report, "ba", 9, 3);
  AddFixed(report, "MtM", FitQuantity::Shape::kMatrix, M.transpose() * M);
  RemarkFew(data, report);
  report.remarks.push_back("the frame is the sensors' own: tie it to the housing by a roll test");
  const double si = setup.reference.gravity_mps2 / setup.reference.gravity;
  out.accel = ThreeChannels(report.values.tail<3>(), M.inverse(), si, setup.reference.axes,
                            table->gravity_signed, "as read");
  return out;
}

}  // namespace wellgyro

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <Eigen/LU>
#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/fit/bench_checks_internal.h"
#include "wellgyro/fit/residual_trends_internal.h"
#include "wellgyro/fit/scalar_fit.h"
#include "wellgyro/fit/scalar_internal.h"
#include "wellgyro/fit/scalar_start_internal.h"
#include "wellgyro/fit/sensor_groups_internal.h"

namespace wellgyro {
namespace {

// Parameters: Ma (6), ba (3), Mm (9 by rows), bm (3) and, where it is found, the dip.
constexpr int kMag = 9, kMagBias = 18, kDip = 21;
constexpr std::string_view kDipAdvice =
    "turn the tool through attitudes between the axes, 18 to 24 in all, and give the field";

struct DipResidual {
  Eigen::Vector3d a, m;
  double gravity, field, dip, sign;
  bool free_dip;
  Eigen::Vector3d weight;

  template <class T>
  bool operator()(const T* const* parameters, T* r) const {
    using std::sin;
    using std::sqrt;
    const T* p = parameters[0];
    const T x = a[0] - p[6], y = a[1] - p[7], z = a[2] - p[8];
    const T f[3] = {p[0] * x, p[1] * x + p[2] * y, p[3] * x + p[4] * y + p[5] * z};
    const T u = m[0] - p[kMagBias], v = m[1] - p[kMagBias + 1], w = m[2] - p[kMagBias + 2];
    T h[3];
    for (int i = 0; i < 3; ++i) {
      const T* row = p + kMag + 3 * i;
      h[i] = row[0] * u + row[1] * v + row[2] * w;
    }
    const T f_length = sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
    const T h_length = sqrt(h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);
    const T along = (f[0] * h[0] + f[1] * h[1] + f[2] * h[2]) / (f_length * h_length);
    const T stated{std::sin(dip)};
    const T sine = free_dip ? sin(p[kDip]) : stated;
    r[0] = (f_length - gravity) * weight[0];
    r[1] = (h_length - field) * weight[1];
    r[2] = (along - sign * sine) * weight[2];
    return true;
  }
};

// Of a reading: what no bench calls noise or an outlier. Readings of ten digits are rounded to
// 3e-11 (1 sigma), and an outlier is six times 1e-10 off.
constexpr double kRounding = 1e-10;

struct Sigmas {
  double accel = 1, mag = 1;
  bool given = false;
};

Eigen::Matrix3d FullOf(const Eigen::VectorXd& x) {
  const Eigen::VectorXd nine = x.segment(kMag, 9);
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(nine.data());
}

// How the three residuals of row i change at x, not whitened: a row each.
struct RowSlopes {
  Eigen::Matrix3d by_accel = Eigen::Matrix3d::Zero(), by_mag = by_accel;
};

RowSlopes SlopesOf(const AttitudeTable& table, const Eigen::VectorXd& x, int i) {
  const Eigen::Matrix3d A = LowerOf(x), M = FullOf(x);
  const Eigen::Vector3d f = A * (table.accel.row(i).transpose() - x.segment<3>(6));
  const Eigen::Vector3d h = M * (table.mag.row(i).transpose() - x.segment<3>(kMagBias));
  const Eigen::Vector3d f1 = f.normalized(), h1 = h.normalized();
  const double along = f1.dot(h1);
  RowSlopes slopes;
  slopes.by_accel.row(0) = f1.transpose() * A;
  slopes.by_mag.row(1) = h1.transpose() * M;
  slopes.by_accel.row(2) = (h1 - along * f1).transpose() * A / f.norm();
  slopes.by_mag.row(2) = (f1 - along * h1).transpose() * M / h.norm();
  return slopes;
}

// Sigmas of the three residuals of row i at x.
Eigen::Vector3d RowSigmas(const AttitudeTable& table, const Eigen::VectorXd& x, const Sigmas& sigma,
                          int i) {
  const RowSlopes slopes = SlopesOf(table, x, i);
  const Eigen::Vector3d by_accel = slopes.by_accel.rowwise().norm() * sigma.accel;
  const Eigen::Vector3d by_mag = slopes.by_mag.rowwise().norm() * sigma.mag;
  return (by_accel.cwiseAbs2() + by_mag.cwiseAbs2()).cwiseSqrt();
}

// Channels as the three residuals hold them; y holds what is given less what is read.
std::vector<SensedChannel> SensedOf(const AttitudeTable& table,
                                    const NonlinearProblem::Solution& solution) {
  std::vector<SensedChannel> sensed(6);
  for (std::size_t c = 0; c < 3; ++c) {
    sensed[c].name = table.accel_channels[c];
    sensed[3 + c].name = table.mag_channels[c];
  }
  int at = 0;
  for (std::size_t row = 0; row < solution.linear.rows.size(); row += 3) {
    while (table.lines[static_cast<std::size_t>(at)] != solution.linear.rows[row].line) ++at;
    const RowSlopes slopes = SlopesOf(table, solution.x, at);
    Eigen::Vector3d unit;
    for (std::size_t k = 0; k < 3; ++k) {
      unit[static_cast<Eigen::Index>(k)] = solution.linear.rows[row + k].unit;
    }
    for (std::size_t c = 0; c < 6; ++c) {
      const Eigen::Matrix3d& by = c < 3 ? slopes.by_accel : slopes.by_mag;
      sensed[c].first.push_back(static_cast<Eigen::Index>(row));
      sensed[c].spread.emplace_back(-by.col(static_cast<Eigen::Index>(c % 3)).cwiseQuotient(unit));
    }
  }
  return sensed;
}

std::vector<std::string> Names(bool free_dip) {
  std::vector<std::string> names = {"Ma[0,0]", "Ma[1,0]", "Ma[1,1]",
                                    "Ma[2,0]", "Ma[2,1]", "Ma[2,2]"};
  Append(names, VectorNames("ba", 3));
  Append(names, MatrixNames("Mm", 3, 3));
  Append(names, VectorNames("bm", 3));
  if (free_dip) names.emplace_back("dip");
  return names;
}

NonlinearProblem Problem(const AttitudeTable& table, const ScalarSetup& setup, const Sigmas& sigma,
                         const Eigen::VectorXd& start) {
  NonlinearProblem problem(Names(setup.free_dip), start);
  problem.sigma_given = sigma.given;
  problem.least_scale = std::max(kRounding * setup.reference.gravity / sigma.accel,
                                 kRounding * *setup.reference.field / sigma.mag);
  for (int i = 0; i < table.rows(); ++i) {
    const Eigen::Vector3d sigmas = RowSigmas(table, start, sigma, i);
    const int line = table.lines[static_cast<std::size_t>(i)];
    problem.Add(
        {{line, "gravity", sigmas[0]}, {line, "field", sigmas[1]}, {line, "dip", sigmas[2]}},
        DipResidual{table.accel.row(i).transpose(), table.mag.row(i).transpose(),
                    setup.reference.gravity, *setup.reference.field,
                    setup.reference.dip.value_or(0), table.gravity_signed ? 1.0 : -1.0,
                    setup.free_dip, sigmas.cwiseInverse()});
  }
  return problem;
}

struct Start {
  Eigen::VectorXd x;
  Sigmas sigma;
};

// Each sensor by its own lengths, the magnetometer's frame along its own z axis.
Result<Start> StartOf(const AttitudeTable& table, const ScalarSetup& setup) {
  const auto accel =
      SolveScalar({table.lines, table.accel, setup.reference.gravity, setup.sigma_accel});
  if (!accel) return accel.fault();
  const auto mag = SolveScalar({table.lines, table.mag, *setup.reference.field, setup.sigma_mag});
  if (!mag) return mag.fault();
  Start start;
  start.x.resize(setup.free_dip ? 22 : 21);
  const Eigen::Matrix3d M = LowerOf(mag->x);
  start.x << accel->x, M.row(0).transpose(), M.row(1).transpose(), M.row(2).transpose(),
      mag->x.tail<3>(), Eigen::VectorXd::Zero(setup.free_dip ? 1 : 0);
  if (setup.free_dip) {
    double sum = 0;
    for (int i = 0; i < table.rows(); ++i) {
      const Eigen::Vector3d f =
          LowerOf(accel->x) * (table.accel.row(i).transpose() - accel->x.tail<3>());
      const Eigen::Vector3d h = M * (table.mag.row(i).transpose() - mag->x.tail<3>());
      sum += f.normalized().dot(h.normalized());
    }
    const double sine = (table.gravity_signed ? 1 : -1) * sum / table.rows();
    start.x[kDip] = std::asin(std::min(1.0, std::max(-1.0, sine)));
  }
  const auto scatter = [&](const NonlinearProblem::Solution& solution, double scale,
                           double length) {
    const double dof = static_cast<double>(solution.linear.y.size()) - 9;
    return std::max(std::sqrt(2 * solution.cost / std::max(1.0, dof)), kRounding * length) / scale;
  };
  start.sigma.given = setup.sigma_accel && setup.sigma_mag;
  start.sigma.accel =
      setup.sigma_accel.value_or(scatter(*accel, accel->x[0], setup.reference.gravity));
  start.sigma.mag = setup.sigma_mag.value_or(scatter(*mag, mag->x[0], *setup.reference.field));
  return start;
}

void TakeResult(FitReport& report, bool free_dip) {
  std::vector<std::string> names = MatrixNames("Ka", 3, 3);
  Append(names, VectorNames("ba", 3));
  Append(names, MatrixNames("Km", 3, 3));
  Append(names, VectorNames("bm", 3));
  if (free_dip) names.emplace_back("dip_deg");
  Reparametrise(report, names, [free_dip](const Eigen::VectorXd& x) {
    const Eigen::Matrix3d A = LowerOf(x).inverse(), M = FullOf(x).inverse();
    Eigen::VectorXd to(free_dip ? 25 : 24);
    to.head<24>() << A.row(0).transpose(), A.row(1).transpose(), A.row(2).transpose(),
        x.segment<3>(6), M.row(0).transpose(), M.row(1).transpose(), M.row(2).transpose(),
        x.segment<3>(kMagBias);
    if (free_dip) to[24] = ToDegrees(x[kDip]);
    return to;
  });
  AddMatrix(report, "Ka", 0, 3, 3);
  AddVector(report, "ba", 9, 3);
  AddMatrix(report, "Km", 12, 3, 3);
  AddVector(report, "bm", 21, 3);
  if (free_dip) AddNumber(report, "dip_deg", 24);
}

std::optional<Fault> DoesNotFitAsDip(const BenchTable& data, const ScalarSetup& setup,
                                     FitReport& report) {
  return DoesNotFit(
      data, {{"gravity", setup.reference.gravity}, {"field", *setup.reference.field}, {"dip", 1}},
      report);
}

std::optional<Fault> BadTable(const BenchTable& data, const AttitudeTable& table) {
  if (auto fault = TooFew(data, 12, "attitudes", kDipAdvice)) return fault;
  if (auto fault = BadReadings(data, table)) return fault;
  if (auto fault = BadVectors(data, table.accel, table.accel_channels, "one unit")) return fault;
  return BadVectors(data, table.mag, table.mag_channels, "one unit");
}

}  // namespace

Result<BenchCalibration> FitScalarDip(const BenchTable& data, const ScalarSetup& setup) {
  if (!setup.reference.field) throw std::invalid_argument("scalar-dip needs the field");
  if (!setup.reference.dip && !setup.free_dip) {
    throw std::invalid_argument("scalar-dip needs the dip, or is to find it");
  }
  const auto table = ReadAttitudeTable(data, {.accel = true, .mag = true});
  if (!table) return table.fault();
  if (auto fault = BadTable(data, *table)) return *fault;
  const ScalarReadings accel{table->lines, table->accel, setup.reference.gravity, {}};
  const ScalarReadings mag{table->lines, table->mag, *setup.reference.field, {}};
  const auto start = StartOf(*table, setup);
  if (!start) return BenchFault(data, start.fault().text);
  // Twice: the weights are those of the start.
  Eigen::VectorXd x = start->x;
  Result<NonlinearProblem::Solution> solution = Problem(*table, setup, start->sigma, x).Solve();
  if (solution) solution = Problem(*table, setup, start->sigma, solution->x).Solve();
  if (solution) solution->linear.sensed = SensedOf(*table, *solution);
  auto whole = WholeReport(data, solution, kDipAdvice);
  if (!whole) return whole.fault();
  for (const ScalarReadings* readings : {&accel, &mag}) {
    if (auto fault = OnlyCones(data, *readings, solution->outlier_lines)) return *fault;
  }
  BenchCalibration out;
  out.report = *std::move(whole);
  if (auto fault = DoesNotFitAsDip(data, setup, out.report)) return *fault;
  FitReport& report = out.report;
  report.method = "scalar-dip";
  const Eigen::Matrix3d A = LowerOf(report.values).inverse(), M = FullOf(report.values).inverse();
  // A frame that mirrors or turns the accelerometers' own comes from signs or columns.
  if (auto fault = WrongAxes(data, M, table->mag_channels)) {
    fault->text += ", against the accelerometers' axes, or a sign of theirs is wrong";
    return *fault;
  }
  if (auto fault = OtherUnit(data, table->accel_channels, A, setup.reference)) return *fault;
  RemarkTemperature(data, report);
  const Eigen::Vector3d ba = report.values.segment<3>(6), bm = report.values.segment<3>(kMagBias);
  TakeResult(report, setup.free_dip);
  report.remarks.push_back(
      "the frame is the accelerometers' own: tie it to the housing by a roll "
      "test");
  const BenchReference& reference = setup.reference;
  out.accel = ThreeChannels(ba, A, reference.gravity_mps2 / reference.gravity, reference.axes,
                            table->gravity_signed, "as read");
  out.mag = ThreeChannels(bm, M, units::kNanotesla, reference.axes, false, "as read");
  return out;
}

}  // namespace wellgyro

#include "wellgyro/fit/tool_verify.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include <Eigen/Dense>
#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/calibration/members.h"
#include "wellgyro/fit/bench_checks_internal.h"
#include "wellgyro/fit/shift_estimate_internal.h"
#include "wellgyro/fit/tool_rows_internal.h"
#include "wellgyro/math/so3.h"
#include "wellgyro/math/statistics.h"
#include "wellgyro/record/products.h"

namespace wellgyro {
namespace {

using Kind = CalibrationMember::Kind;
// Chance that residuals beside the shifts are so large: of a thousand sound tools one, beside those
// that the false alarm rate of the shifts calls shifted.
constexpr double kMisfit = 1e-3;

// One channel's reading by the tool model, and how it changes.
struct ChannelAt {
  double tau = 0;
  Eigen::Vector3d u, f;  // sensors' axes, SI
  Eigen::RowVector3d by_u = Eigen::RowVector3d::Zero(), by_f = Eigen::RowVector3d::Zero();
  double value = 0;
};

ChannelAt ReadingOf(const SensorGroup& group, int c, const Eigen::Vector3d& u_T,
                    const Eigen::Vector3d& f_T, const ToolRow& row) {
  ChannelAt at;
  const double held = std::clamp(row.temperature, group.min, group.max);
  at.tau = group.thermometer < 0 ? 0 : (held - group.reference) / group.half_range;
  at.u = group.R_TS.transpose() * u_T;
  at.f = group.R_TS.transpose() * f_T;
  double power = 1;
  for (std::size_t n = 0; n < SensorGroup::kPowers; ++n, power *= at.tau) {
    at.value += power * group.bias[n][c];
    at.by_u += power * group.sensitivity[n].row(c);
    at.by_f += power * group.g_dependence[n].row(c);
  }
  at.value += at.by_u.dot(at.u) + at.by_f.dot(at.f) +
              group.second_order.row(c).dot(ProductsOf(at.u)) +
              group.g_squared.row(c).dot(ProductsOf(at.f)) + group.heating[c] * row.heating;
  return at;
}

double ByMember(const CalibrationMember& member, const ChannelAt& at, const ToolRow& row) {
  const double power = std::pow(at.tau, member.power);
  switch (member.kind) {
    case Kind::kBias:
      return power;
    case Kind::kSensitivity:
      return power * at.u[member.column];
    case Kind::kForce:
      return power * at.f[member.column];
    case Kind::kSecondOrder:
      return ProductsOf(at.u)[member.column];
    case Kind::kForceSquare:
      return ProductsOf(at.f)[member.column];
    case Kind::kHeating:
      break;
  }
  return row.heating;
}

// Residuals of one reading against the tool model, a row a channel: by the shifts B, by the
// calibration's own errors J, by the bench's turn (about north, east, down) and the zero of its
// inclination, by this attitude's wobble.
struct Residuals {
  Eigen::VectorXd e;
  Eigen::MatrixXd J, B, bench, wobble;
  Eigen::VectorXd variance;  // of the channels' noise
};

class Comparison {
 public:
  Comparison(const ToolReadings& readings, const ToolCalibration& tool, const VerifySetup& setup)
      : readings_(readings), tool_(tool), setup_(setup) {
    for (int c = 0; c < readings.n_accel; ++c) {
      shifts_.push_back({fmt::format("accel_b[{}]", c), "g", 0, 0, 3 * setup.budget_accel_bias});
      members_.push_back({false, Kind::kBias, 0, c, 0});
    }
    for (int c = 0; c < readings.n_gyro; ++c) {
      shifts_.push_back({fmt::format("gyro_b[{}]", c), "deg/h", 0, 0, 3 * setup.budget_gyro_bias});
      members_.push_back({true, Kind::kBias, 0, c, 0});
    }
    for (int c = 0; c < readings.n_gyro; ++c) {
      for (int j = 0; j < 3; ++j) {
        shifts_.push_back(
            {fmt::format("gyro_G[{},{}]", c, j), "deg/h/g", 0, 0, 3 * setup.budget_gyro_force});
        members_.push_back({true, Kind::kForce, 0, c, j});
      }
    }
    TakeKnown();
  }

  const std::vector<ToolShift>& shifts() const { return shifts_; }

  // In the shifts' units: of one shift in the channel's.
  double UnitOf(std::size_t k) const {
    const CalibrationMember& member = members_[k];
    const SensorGroup& group = member.is_gyro ? tool_.gyro : tool_.accel;
    const double si = group.sensitivity[0].row(member.channel).norm();
    const double g = setup_.bench.reference.gravity_mps2;
    if (!member.is_gyro) return si * g;
    return member.kind == Kind::kBias ? si * units::kDegPerHour : si * units::kDegPerHour / g;
  }

  // Generalised least squares, linear about the bench's turn (about north, east, down) and zero of
  // inclination, which become the likeliest.
  ToolShiftEstimate Estimate(Eigen::Vector4d& bench) const {
    const Eigen::Index known = factor_.cols();
    ToolShiftEstimator estimator(known + 4, static_cast<Eigen::Index>(members_.size()));
    const Eigen::Vector4d sigmas = SigmasOfBench();
    const double sigma = setup_.bench.sigma_wobble.value_or(0);
    for (const ToolRow& row : readings_.rows) {
      const Residuals r = Compare(row, bench);
      Eigen::MatrixXd common(r.e.size(), known + 4);
      common << r.J * factor_, r.bench * sigmas.asDiagonal();
      Eigen::MatrixXd cov = sigma * sigma * r.wobble * r.wobble.transpose();
      cov.diagonal() += r.variance;
      estimator.Add(cov, common, r.B, r.e + r.bench * bench);
    }
    ToolShiftEstimate found = estimator.Estimate();
    bench = sigmas.cwiseProduct(found.common.tail<4>());
    return found;
  }

  // Root mean square of the readings over that of what the tool model foretells; of the gyros, or
  // of the accelerometers.
  double ReadOverForetold(bool gyros) const {
    double read = 0, foretold = 0;
    for (const ToolRow& row : readings_.rows) {
      const Residuals r = Compare(row, Eigen::Vector4d::Zero());
      for (Eigen::Index i = 0; i < r.e.size(); ++i) {
        const int channel = row.channels[static_cast<std::size_t>(i)];
        if (readings_.channels[static_cast<std::size_t>(channel)].is_gyro != gyros) continue;
        read += row.v[i] * row.v[i];
        foretold += std::pow(row.v[i] - r.e[i], 2);
      }
    }
    return std::sqrt(read / foretold);
  }

 private:
  Eigen::Vector4d SigmasOfBench() const {
    const ToolFitSetup& bench = setup_.bench;
    return {bench.sigma_level, bench.sigma_level, bench.sigma_north, bench.sigma_inclination};
  }

  void TakeKnown() {
    Eigen::MatrixXd cov(0, 0);
    for (const SensorGroup* group : {&tool_.gyro, &tool_.accel}) {
      if (!group->covariance || group->covariance->names.empty()) continue;
      const auto& names = group->covariance->names;
      if (names.front().rfind("gyro.", 0) != 0 && names.front().rfind("accel.", 0) != 0) continue;
      for (const std::string& name : names) known_.push_back(MemberOf(name));
      const Eigen::Index had = cov.rows(), more = group->covariance->cov.rows();
      Eigen::MatrixXd both = Eigen::MatrixXd::Zero(had + more, had + more);
      both.topLeftCorner(had, had) = cov;
      both.bottomRightCorner(more, more) = group->covariance->cov;
      cov = std::move(both);
    }
    factor_ = FactorOf(cov);
  }

  Residuals Compare(const ToolRow& row, const Eigen::Vector4d& bench) const {
    const auto n = static_cast<Eigen::Index>(row.channels.size());
    Residuals r{Eigen::VectorXd(n),
                Eigen::MatrixXd::Zero(n, static_cast<Eigen::Index>(known_.size())),
                Eigen::MatrixXd::Zero(n, static_cast<Eigen::Index>(members_.size())),
                Eigen::MatrixXd(n, 4),
                Eigen::MatrixXd(n, 3),
                Eigen::VectorXd(n)};
    for (Eigen::Index i = 0; i < n; ++i) {
      CompareChannel(row, row.channels[static_cast<std::size_t>(i)], row.v[i], i, bench, r);
    }
    return r;
  }

  void CompareChannel(const ToolRow& row, int channel, double read, Eigen::Index at,
                      const Eigen::Vector4d& bench, Residuals& r) const {
    const BenchReference& reference = setup_.bench.reference;
    const bool is_gyro = readings_.channels[static_cast<std::size_t>(channel)].is_gyro;
    const int c = channel - (is_gyro ? readings_.n_accel : 0);
    const SensorGroup& group = is_gyro ? tool_.gyro : tool_.accel;
    const double L = reference.latitude.value_or(0);
    const Eigen::Matrix3d turned = Exp(bench.head<3>());
    const Eigen::Vector3d w_L =
        kBenchEarthRate * (turned * Eigen::Vector3d(std::cos(L), 0, -std::sin(L)));
    const Eigen::Vector3d f_L = -reference.gravity_mps2 * turned.col(2);
    const Eigen::Matrix3d R_TB = ToolFromBench(reference.axes);
    const Eigen::Matrix3d R = R_TB * row.R_BL * Exp(-bench[3] * row.across_L);
    const Eigen::Vector3d w_T = R * w_L, f_T = R * f_L;
    const ChannelAt v = ReadingOf(group, c, is_gyro ? w_T : f_T, f_T, row);
    r.e[at] = read - v.value;
    const double sigma = is_gyro ? *setup_.bench.sigma_gyro : *setup_.bench.sigma_accel;
    r.variance[at] = sigma * sigma;
    const Eigen::RowVector3d by_u = v.by_u * group.R_TS.transpose();
    const Eigen::RowVector3d by_f = v.by_f * group.R_TS.transpose();
    const Eigen::Vector3d own = is_gyro ? w_T : f_T, own_L = is_gyro ? w_L : f_L;
    r.wobble.row(at) = (by_u * Skew(own) + by_f * Skew(f_T)) * R_TB;
    r.bench.row(at).head<3>() = by_u * R * -Skew(own_L) + by_f * R * -Skew(f_L);
    // A tool inclined by more sees what acts on it turned by less.
    r.bench(at, 3) =
        -(by_u * R * row.across_L.cross(own_L) + by_f * R * row.across_L.cross(f_L))[0];
    for (std::size_t k = 0; k < known_.size(); ++k) {
      if (known_[k].is_gyro != is_gyro || known_[k].channel != c) continue;
      r.J(at, static_cast<Eigen::Index>(k)) = ByMember(known_[k], v, row);
    }
    for (std::size_t k = 0; k < members_.size(); ++k) {
      if (members_[k].is_gyro != is_gyro || members_[k].channel != c) continue;
      r.B(at, static_cast<Eigen::Index>(k)) = UnitOf(k) * ByMember(members_[k], v, row);
    }
  }

  const ToolReadings& readings_;
  const ToolCalibration& tool_;
  const VerifySetup& setup_;
  std::vector<ToolShift> shifts_;
  std::vector<CalibrationMember> members_, known_;
  Eigen::MatrixXd factor_;  // R R' the calibration's covariance, of known_
};

std::optional<Fault> Unlike(const BenchTable& data, const ToolReadings& readings,
                            const ToolCalibration& tool) {
  const auto differs = [](int read, const SensorGroup& group) {
    return read > 0 && read != group.n_channels;
  };
  if (!differs(readings.n_gyro, tool.gyro) && !differs(readings.n_accel, tool.accel)) {
    return std::nullopt;
  }
  return BenchFault(
      data,
      fmt::format("the table has {} gyros and {} accelerometers, the tool {} and {}",
                  readings.n_gyro, readings.n_accel, tool.gyro.n_channels, tool.accel.n_channels),
      1, FaultCode::kConflict);
}

// g and m/s2 are 9.8 apart, deg/h and deg/s 3600; no sensor in service is so far off.
std::optional<Fault> OtherUnit(const BenchTable& data, const ToolReadings& readings,
                               const Comparison& comparison) {
  constexpr double kAccel = 3, kGyro = 50;
  for (const bool gyros : {false, true}) {
    if ((gyros ? readings.n_gyro : readings.n_accel) == 0) continue;
    const double ratio = comparison.ReadOverForetold(gyros), most = gyros ? kGyro : kAccel;
    if (!(ratio > most) && !(ratio < 1 / most)) continue;
    return BenchFault(data,
                      fmt::format("the {} read {:.3g} times what the calibration foretells: give "
                                  "them in the unit that the tool was calibrated in, as {}",
                                  gyros ? "gyros" : "accelerometers", ratio,
                                  gyros ? "deg/h and not deg/s" : "g and not m/s2"));
  }
  return std::nullopt;
}

std::optional<Fault> RateTable(const BenchTable& data) {
  if (!data.Find("rate_deg_s")) return std::nullopt;
  return BenchFault(data, "it is a rate table: verify takes positions read at rest", 1,
                    FaultCode::kForeign);
}

bool GoesWithTemperature(const SensorGroup& group) {
  return group.n_channels > 0 && group.thermometer >= 0 && group.max > group.min;
}

// A calibration that goes with temperature says nothing of readings at one that nobody wrote down.
std::optional<Fault> WithoutTemperature(const BenchTable& data, const ToolCalibration& tool) {
  if (data.Find("T_C") || !(GoesWithTemperature(tool.gyro) || GoesWithTemperature(tool.accel))) {
    return std::nullopt;
  }
  return BenchFault(data,
                    "no column T_C: the tool's calibration goes with temperature; say at what "
                    "temperature each row was read [degC]",
                    1, FaultCode::kForeign);
}

std::optional<std::pair<double, double>> Beyond(const ToolReadings& readings,
                                                const ToolCalibration& tool) {
  constexpr double kSlack = 1;  // degC, about what thermometers agree to
  const auto [low, high] = std::minmax_element(
      readings.rows.begin(), readings.rows.end(),
      [](const ToolRow& a, const ToolRow& b) { return a.temperature < b.temperature; });
  for (const SensorGroup* group : {&tool.gyro, &tool.accel}) {
    if (!GoesWithTemperature(*group)) continue;
    if (low->temperature < group->min - kSlack || high->temperature > group->max + kSlack) {
      return std::pair(low->temperature, high->temperature);
    }
  }
  return std::nullopt;
}

// What a survey needs to know of a shift where no budget is stated, 1-sigma [the shift's unit].
double MatterOf(const ToolShift& shift) {
  constexpr double kGyro = kCoarseShare * kBenchEarthRate / units::kDegPerHour, kAccel = 2e-3;
  return shift.name.rfind("accel", 0) == 0 ? kAccel : kGyro;
}

// All shifts against chance and their budgets, and what they come to.
void TakeShifts(const std::vector<ToolShift>& shifts, const ToolShiftEstimate& found,
                double false_alarm, Verification& out) {
  const auto n_told = std::count(found.told.begin(), found.told.end(), 1);
  out.reach = -NormalQuantile(false_alarm / 2 / std::max(1.0, static_cast<double>(n_told)));
  bool told = true, within = true, shifted = false, budgets = false;
  for (std::size_t i = 0; i < shifts.size(); ++i) {
    ToolShift shift = shifts[i];
    const auto at = static_cast<Eigen::Index>(i);
    const bool apart = found.told[i] != 0;
    shift.sigma = apart ? std::sqrt(found.cov(at, at)) : std::numeric_limits<double>::infinity();
    shift.value = apart ? found.x[at] : 0;
    shift.told = shift.sigma <= (shift.limit > 0 ? shift.limit / 3 : MatterOf(shift));
    shift.shifted = std::abs(shift.value) > out.reach * shift.sigma;
    // What is not told to its budget is beyond it only where chance does not reach so far.
    shift.within = shift.limit > 0
                       ? std::abs(shift.value) <= shift.limit || !(shift.told || shift.shifted)
                       : !shift.shifted;
    told = told && shift.told;
    within = within && shift.within;
    shifted = shifted || shift.shifted;
    budgets = budgets || shift.limit > 0;
    out.shifts.push_back(std::move(shift));
  }
  out.unassigned = !told && !shifted && found.rank > 0 &&
                   1 - ChiSquareCdf(out.chi_square - out.left, found.rank) < false_alarm;
  const bool fail = !out.fits || !within || (out.unassigned && !budgets);
  out.outcome = fail   ? VerifyOutcome::kFail
                : told ? VerifyOutcome::kPass
                       : VerifyOutcome::kNotVerified;
}

}  // namespace

Result<Verification> VerifyTool(const BenchTable& data, const ToolCalibration& tool,
                                const VerifySetup& setup) {
  if (auto fault = RateTable(data)) return *fault;
  const auto readings = ReadTool({&data, 1}, setup.bench);
  if (!readings) return readings.fault();
  if ((readings->n_gyro > 0 && (!setup.bench.sigma_gyro || !setup.bench.reference.latitude)) ||
      (readings->n_accel > 0 && !setup.bench.sigma_accel)) {
    throw std::invalid_argument("verify needs the sigmas of the readings, and gyros the latitude");
  }
  if (auto fault = Unlike(data, *readings, tool)) return *fault;
  if (auto fault = WithoutTemperature(data, tool)) return *fault;
  Comparison comparison(*readings, tool, setup);
  if (auto fault = OtherUnit(data, *readings, comparison)) return *fault;
  ToolShiftEstimate found;
  Eigen::Vector4d bench = Eigen::Vector4d::Zero();
  // A tilt of a third of a degree acts on the force to the second order, by 1e-5 of it.
  constexpr int kTurns = 3;
  for (int k = 0; k < kTurns; ++k) found = comparison.Estimate(bench);
  Verification out;
  out.beyond = Beyond(*readings, tool);
  out.chi_square = found.chi_square;
  out.dof = found.dof;
  out.probability = 1 - ChiSquareCdf(out.chi_square, out.dof);
  out.left_dof = found.dof - found.rank;
  out.left = found.left;
  out.fits = out.left_dof <= 0 || 1 - ChiSquareCdf(out.left, out.left_dof) > kMisfit;
  TakeShifts(comparison.shifts(), found, setup.false_alarm, out);
  return out;
}

}  // namespace wellgyro

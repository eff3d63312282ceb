#include "wellgyro/fit/gyro_fit.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/fit/added_terms_internal.h"
#include "wellgyro/fit/bench_checks_internal.h"
#include "wellgyro/fit/gyro_problem_internal.h"
#include "wellgyro/fit/hemisphere_internal.h"
#include "wellgyro/fit/residual_trends_internal.h"
#include "wellgyro/math/linear_algebra.h"
#include "wellgyro/record/products.h"

namespace wellgyro {
namespace {

std::optional<Fault> WrongChannels(const BenchTable& data, const GyroReadings& readings,
                                   const Eigen::VectorXd& x) {
  for (std::size_t c = 0; c < readings.channels.size(); ++c) {
    const GyroChannel& channel = readings.channels[c];
    const Eigen::Vector3d U = x.segment<3>(4 * static_cast<Eigen::Index>(c) + 1);
    Eigen::Index most = 0;
    U.cwiseAbs().maxCoeff(&most);
    if (most != channel.axis) {
      return BenchFault(data, fmt::format("channel {} follows {}{}: its axis is not {}; exchange "
                                          "the columns, or mend their names",
                                          channel.name, U[most] < 0 ? "-" : "", "xyz"[most],
                                          "xyz"[channel.axis]));
    }
    if (U[most] < 0) {
      return BenchFault(data,
                        fmt::format("channel {} falls where the rate about {} rises: its sign "
                                    "is wrong, or up and down of the positions are swapped",
                                    channel.name, "xyz"[most]));
    }
    if (auto fault = OtherRate(data, channel.name, U[most])) return fault;
  }
  return std::nullopt;
}

// Where the result stands in the report, for n channels: b (n), U (n x 3), G (n x 3); then M and Q
// by rotor, N and the north offset where the layout has them.
struct ResultPlaces {
  explicit ResultPlaces(const GyroLayout& layout)
      : U(layout.channels),
        G(4 * layout.channels),
        MQ(7 * layout.channels),
        aniso(MQ + (layout.dual ? 2 * layout.rotors : 0)),
        north(aniso + (layout.aniso ? layout.channels : 0)),
        size(north + (layout.north ? 1 : 0)) {}

  int U, G, MQ, aniso, north, size;
};

Eigen::VectorXd ResultOf(const GyroReadings& readings, const GyroLayout& layout,
                         const Eigen::VectorXd& x) {
  const ResultPlaces at(layout);
  const int n = layout.channels;
  Eigen::VectorXd to = Eigen::VectorXd::Zero(at.size);
  for (int c = 0; c < n; ++c) {
    to[c] = x[Eigen::Index{4} * c];
    to.segment<3>(at.U + 3 * c) = x.segment<3>(4 * c + 1);
  }
  for (std::size_t k = 0; k < layout.full.size(); ++k) {
    to.segment<3>(at.G + 3 * layout.full[k]) =
        x.segment<3>(layout.full_first() + 3 * static_cast<int>(k));
  }
  for (int k = 0; layout.dual && k < layout.rotors; ++k) {
    const Rotor& rotor = readings.rotors[static_cast<std::size_t>(k)];
    const int a = readings.channels[static_cast<std::size_t>(rotor.a)].axis;
    const int c = readings.channels[static_cast<std::size_t>(rotor.c)].axis;
    const double M = x[layout.force_first() + 2 * k], Q = x[layout.force_first() + 2 * k + 1];
    to[at.G + 3 * rotor.a + a] = M;
    to[at.G + 3 * rotor.a + c] = Q;
    to[at.G + 3 * rotor.c + c] = M;
    to[at.G + 3 * rotor.c + a] = -Q;
    to.segment<2>(at.MQ + 2 * k) << M, Q;
  }
  for (std::size_t k = 0; layout.aniso && k < layout.paired.size(); ++k) {
    to[at.aniso + layout.paired[k]] = x[layout.aniso_first() + static_cast<int>(k)];
  }
  if (layout.north) to[at.north] = ToDegrees(x[layout.north_first()]);
  return to;
}

void TakeResult(const GyroReadings& readings, const GyroLayout& layout, FitReport& report) {
  const ResultPlaces at(layout);
  const int n = layout.channels, rotors = layout.rotors;
  const bool dual = layout.dual;
  std::vector<std::string> names = VectorNames("b_degh", n);
  Append(names, MatrixNames("U", n, 3));
  Append(names, MatrixNames("G_degh_per_g", n, 3));
  if (dual) Append(names, VectorNames("MQ", 2 * rotors));
  if (layout.aniso) Append(names, VectorNames("aniso_degh_per_g2", n));
  if (layout.north) names.emplace_back("north_deg");
  Reparametrise(report, names,
                [&](const Eigen::VectorXd& x) { return ResultOf(readings, layout, x); });
  AddVector(report, "b_degh", 0, n);
  AddMatrix(report, "U", at.U, n, 3);
  if (dual || !layout.full.empty()) AddMatrix(report, "G_degh_per_g", at.G, n, 3);
  if (dual) AddVector(report, "MQ", at.MQ, 2 * rotors);
  if (layout.aniso) AddVector(report, "aniso_degh_per_g2", at.aniso, n);
  if (layout.north) AddNumber(report, "north_deg", at.north);
}

SensorGroup Group(const GyroReadings& readings, const GyroLayout& layout,
                  const BenchReference& reference, const Eigen::VectorXd& values) {
  const int n = layout.channels;
  const ResultPlaces at(layout);
  SensorGroup group;
  group.n_channels = n;
  group.unit = "deg/h";
  group.R_TS = ToolFromBench(reference.axes);
  const double g = reference.gravity_mps2;
  for (int c = 0; c < n; ++c) {
    group.channel[static_cast<std::size_t>(c)] = c;
    group.bias[0][c] = values[c];
    group.sensitivity[0].row(c) = values.segment<3>(at.U + 3 * c).transpose() / units::kDegPerHour;
    group.g_dependence[0].row(c) = values.segment<3>(at.G + 3 * c).transpose() / g;
  }
  if (!layout.aniso) return group;
  for (const Rotor& rotor : readings.rotors) {
    for (const int c : {rotor.a, rotor.c}) {
      const int axis = readings.channels[static_cast<std::size_t>(c)].axis;
      group.g_squared(c, PlaceOfProduct(axis, rotor.spin)) = values[at.aniso + c] / (g * g);
    }
  }
  return group;
}

// What four channels contradict each other by, of the residuals of every attitude.
void AddParity(const SensorGroup& group, FitReport& report) {
  if (group.n_channels != 4) return;
  const Eigen::Vector4d direction = UnitBeside(group.sensitivity[0]);
  double square = 0;
  int rows = 0;
  for (std::size_t i = 0; i + 3 < report.residuals.size(); i += 4) {
    if (report.residuals[i].line != report.residuals[i + 3].line) continue;
    double parity = 0;
    for (int c = 0; c < 4; ++c) {
      parity += direction[c] * report.residuals[i + static_cast<std::size_t>(c)].value;
    }
    square += parity * parity;
    ++rows;
  }
  AddFixed(report, "parity_rms_degh", FitQuantity::Shape::kNumber,
           Eigen::MatrixXd::Constant(1, 1, std::sqrt(square / std::max(1, rows))));
}

// What the readings at rest cannot show of themselves.
void RemarkReference(const GyroReadings& readings, const BenchReference& reference,
                     const Eigen::MatrixXd& cov, const Eigen::VectorXd& x, FitReport& report) {
  // [g], 0.06 deg and 0.015 deg/h of the Earth's rate: what a reading of 7 min scatters by at
  // 0.005 deg/sqrt(h).
  constexpr double kLevel = 1e-3;
  if (readings.f_off > kLevel) {
    report.remarks.push_back(fmt::format(
        "fx, fy, fz lie {:.1f} mg (rms) beside what inc and tf say: the fixture's angles or the "
        "accelerometers are off by {:.2f} deg, {:.2g} deg/h of the Earth's rate",
        1e3 * readings.f_off, ToDegrees(readings.f_off),
        readings.f_off * kBenchEarthRate / units::kDegPerHour));
  }
  double sum = 0, square = 0, variance = 0;
  const auto n = static_cast<double>(readings.channels.size());
  for (std::size_t c = 0; c < readings.channels.size(); ++c) {
    const auto at = static_cast<Eigen::Index>(4 * c) + 1 + readings.channels[c].axis;
    sum += x[at] / n;
    square += x[at] * x[at] / n;
    if (cov.size() > 0) variance += cov(at, at) / n;
  }
  const double scatter = std::sqrt(std::max(0.0, square - sum * sum));
  // An error of all channels is the reference's: 1 % of cos L is 0.33 deg of latitude at 60 deg,
  // and makers' scales, which differ, are within it. Chance: P(|x| > 4) = 6.3e-5.
  constexpr double kUnusual = 0.01, kSigmas = 4;
  const double off = std::abs(sum - 1);
  if (off < kUnusual || off < kSigmas * std::sqrt(variance) || off < 3 * scatter) return;
  const double cosine = sum * std::cos(*reference.latitude);
  report.remarks.push_back(fmt::format(
      "all channels read {:.4g} of the rate: the latitude is wrong{}, or their unit", sum,
      cosine < 1 ? fmt::format(" (the readings suit {:.2f} deg)", ToDegrees(std::acos(cosine)))
                 : std::string()));
}

// Readings at rest show the horizontal rate by U, which the table's rates show too.
void TellLatitude(const GyroReadings& readings, const FittedGyros& fitted,
                  const BenchReference& reference, FitReport& report) {
  Eigen::MatrixXd z(fitted.problem.y.size(), 1);
  for (Eigen::Index row = 0; row < z.rows(); ++row) {
    const auto n = static_cast<Eigen::Index>(readings.channels.size());
    const Eigen::Vector3d U = fitted.solution.x.segment<3>(4 * (row % n) + 1);
    z(row, 0) = readings.w_by_latitude.row(row / n).dot(U);
  }
  const AddedTerm off =
      AddedTerms(fitted.problem, fitted.solution).Test(z, kFalseAlarm / 2).front();
  if (!(off.sigmas > off.limit)) return;
  report.remarks.push_back(fmt::format(
      "with the rate table's sensitivities the readings at rest suit a latitude of {:.4g} deg, "
      "{:+.2g} deg beside the one given ({:.1f} sigmas, chance reaches {:.1f}): the latitude is "
      "wrong, or the scale of the table's rates",
      ToDegrees(*reference.latitude + off.coefficient), ToDegrees(off.coefficient), off.sigmas,
      off.limit));
}

// `south`: what the readings would be of with the other sign of the latitude.
void TellHemisphere(const GyroReadings& south, const GyroFitSetup& setup, const GyroLayout& layout,
                    const FittedGyros& fitted, FitReport& report) {
  std::vector<Eigen::Index> forces(
      static_cast<std::size_t>(layout.aniso_first() - layout.force_first()));
  std::iota(forces.begin(), forces.end(), layout.force_first());
  auto remark = OtherHemisphere(
      fitted.problem, fitted.solution,
      [&](const Eigen::VectorXd& x) { return ProblemAbout(south, setup, layout, fitted, x); },
      forces);
  if (remark) report.remarks.push_back(*std::move(remark));
}

}  // namespace

Result<BenchCalibration> FitGyro(const BenchTable& rest, const BenchTable& table,
                                 const GyroFitSetup& setup) {
  const auto readings = ReadGyros(rest, table, setup.reference);
  if (!readings) return readings.fault();
  const BenchTable& data = rest.rows() > 0 ? rest : table;
  GyroLayout layout = LayoutOf(*readings, setup);
  FittedGyros fitted = FitLayout(*readings, setup, layout);
  std::vector<std::string> remarks;
  if (layout.aniso && !fitted.solution.unseen.empty()) {
    layout.aniso = false;
    fitted = FitLayout(*readings, setup, layout);
    remarks.emplace_back(
        "the anisoelastic terms are left out: no attitude has force along input and spin axis at "
        "once; add inclinations of 45 deg and toolfaces that are no multiples of 90 deg");
  }
  auto whole = WholeReport(
      data, fitted.problem, fitted.solution,
      "measure inclinations every 45 deg, four azimuths and toolfaces every 60 deg, or join a rate "
      "table's readings");
  if (!whole) return whole.fault();
  if (auto fault = WrongChannels(data, *readings, whole->values)) return *fault;

  BenchCalibration out;
  out.report = *std::move(whole);
  FitReport& report = out.report;
  constexpr double kEarth = kBenchEarthRate / units::kDegPerHour;
  const double largest = readings->w.cwiseAbs().maxCoeff();
  const double at_rest = rest.rows() > 0 ? kEarth : largest;
  if (auto fault = DoesNotFit(data, {{"m_", at_rest}, {"table", largest}}, report)) return *fault;
  report.method = table.rows() > 0 && rest.rows() == 0 ? "gyro-rate-table" : "gyro-multi-position";
  report.remarks.insert(report.remarks.end(), remarks.begin(), remarks.end());
  RemarkTemperature(data, report);
  RemarkReference(*readings, setup.reference, report.cov, report.values, report);
  if (readings->joined) TellLatitude(*readings, fitted, setup.reference, report);
  if (rest.rows() > 0 && table.rows() == 0) {
    report.remarks.push_back(
        "a wrong latitude would not show in these residuals: 0.1 deg of it is 3e-3 in U and 0.05 "
        "deg/h/g in G; a rate table's readings break that");
  }
  BenchReference other = setup.reference;
  other.latitude = -*other.latitude;
  if (const auto turned = ReadGyros(rest, table, other)) {
    TellHemisphere(*turned, setup, layout, fitted, report);
  }
  TakeResult(*readings, layout, report);
  out.gyro = Group(*readings, layout, setup.reference, report.values);
  AddParity(out.gyro, report);
  return out;
}

}  // namespace wellgyro

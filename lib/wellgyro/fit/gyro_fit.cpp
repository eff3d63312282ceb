#include "wellgyro/fit/gyro_fit.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/QR>
#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/fit/added_terms_internal.h"
#include "wellgyro/fit/bench_checks_internal.h"
#include "wellgyro/fit/gyro_readings_internal.h"
#include "wellgyro/fit/least_squares_internal.h"
#include "wellgyro/fit/residual_trends_internal.h"
#include "wellgyro/math/linear_algebra.h"

namespace wellgyro {
namespace {

// Where the parameters stand: for every channel b and U (3); then the force's terms; then N; then
// the north offset.
struct Layout {
  GyroForceModel force = GyroForceModel::kFull;
  bool aniso = false, north = false;
  int channels = 0, rotors = 0;

  int force_first() const { return 4 * channels; }
  int force_size() const {
    if (force == GyroForceModel::kNone) return 0;
    return force == GyroForceModel::kFull ? 3 * channels : 2 * rotors;
  }
  int aniso_first() const { return force_first() + force_size(); }
  int north_first() const { return aniso_first() + (aniso ? channels : 0); }
  int size() const { return north_first() + (north ? 1 : 0); }
};

std::vector<std::string> Names(const Layout& layout) {
  std::vector<std::string> names;
  for (int c = 0; c < layout.channels; ++c) {
    names.push_back(fmt::format("b_degh[{}]", c));
    for (int j = 0; j < 3; ++j) names.push_back(fmt::format("U[{},{}]", c, j));
  }
  if (layout.force == GyroForceModel::kFull) {
    Append(names, MatrixNames("G_degh_per_g", layout.channels, 3));
  }
  if (layout.force == GyroForceModel::kDualAxis) {
    Append(names, VectorNames("MQ", 2 * layout.rotors));
  }
  if (layout.aniso) Append(names, VectorNames("aniso_degh_per_g2", layout.channels));
  if (layout.north) names.emplace_back("north_rad");
  return names;
}

// Coefficients of the force's parameters in one row.
void FillForce(const GyroReadings& readings, const Layout& layout, int i, int c,
               Eigen::MatrixXd::RowXpr row) {
  const Eigen::Vector3d f = readings.f.row(i).transpose();
  if (layout.force == GyroForceModel::kFull) {
    row.segment<3>(layout.force_first() + 3 * c) = f.transpose();
  }
  for (std::size_t k = 0; k < readings.rotors.size(); ++k) {
    const Rotor& rotor = readings.rotors[k];
    if (c != rotor.a && c != rotor.c) continue;
    const double f_a = f[readings.channels[static_cast<std::size_t>(rotor.a)].axis];
    const double f_c = f[readings.channels[static_cast<std::size_t>(rotor.c)].axis];
    const int at = layout.force_first() + 2 * static_cast<int>(k);
    if (layout.force == GyroForceModel::kDualAxis) {
      row[at] = c == rotor.a ? f_a : f_c;
      row[at + 1] = c == rotor.a ? f_c : -f_a;
    }
    if (layout.aniso) row[layout.aniso_first() + c] = (c == rotor.a ? f_a : f_c) * f[rotor.spin];
  }
}

// Negative on a joined rate table: its lines are those of another file.
int LineOf(const GyroReadings& readings, int i) {
  const auto at = static_cast<std::size_t>(i);
  return readings.joined && readings.on_table[at] != 0 ? -readings.lines[at] : readings.lines[at];
}

// About a fixture turned by `north` [rad], with the sensitivities U of the last turn.
LinearProblem Problem(const GyroReadings& readings, const GyroFitSetup& setup, const Layout& layout,
                      double north, const Eigen::MatrixX3d& U, double on_table) {
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

struct FittedGyros {
  LinearProblem problem;
  LinearSolution solution;
};

FittedGyros FitWith(const GyroReadings& readings, const GyroFitSetup& setup, const Layout& layout,
                    double on_table, bool robust) {
  Eigen::MatrixX3d U = Eigen::MatrixX3d::Zero(layout.channels, 3);
  for (int c = 0; c < layout.channels; ++c) {
    U(c, readings.channels[static_cast<std::size_t>(c)].axis) = 1;
  }
  double north = 0;
  FittedGyros fitted{Problem(readings, setup, layout, north, U, on_table), {}};
  fitted.problem.robust = robust;
  fitted.solution = Solve(fitted.problem);
  // Bilinear in U and the north offset: Gauss and Newton.
  for (int turn = 0; layout.north && turn < 50; ++turn) {
    const double next = fitted.solution.x[layout.north_first()];
    for (int c = 0; c < layout.channels; ++c) {
      U.row(c) = fitted.solution.x.segment<3>(4 * c + 1).transpose();
    }
    const bool still = std::abs(next - north) < 1e-14;
    north = next;
    fitted.problem = Problem(readings, setup, layout, north, U, on_table);
    fitted.problem.robust = robust;
    fitted.solution = Solve(fitted.problem);
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
  constexpr double kEnough = 6;
  if (redundancy[0] < kEnough || redundancy[1] < kEnough) return 1;
  double scatter[2];
  for (int table = 0; table < 2; ++table) {
    std::vector<double>& all = sizes[table];
    const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
    std::nth_element(all.begin(), middle, all.end());
    scatter[table] = by_median ? 1.4826 * *middle : std::sqrt(square[table] / redundancy[table]);
  }
  if (sigma_given) scatter[0] = 1;
  return scatter[0] > 0 && scatter[1] > 0 ? scatter[1] / scatter[0] : 1;
}

// The table's own scatter where no sigma of it is given: Helmert's variance components.
FittedGyros FitLayout(const GyroReadings& readings, const GyroFitSetup& setup,
                      const Layout& layout) {
  double on_table = setup.sigma_table.value_or(setup.sigma.value_or(1));
  const bool robust = setup.sigma_table || !readings.joined;
  FittedGyros fitted = FitWith(readings, setup, layout, on_table, robust);
  if (robust) return fitted;
  // All readings first, their medians; then without the outliers, their squares.
  for (const bool last : {false, true}) {
    for (int turn = 0; turn < 30; ++turn) {
      const double ratio = TableRatio(fitted.solution, setup.sigma.has_value(), !last);
      on_table *= ratio;
      fitted = FitWith(readings, setup, layout, on_table, last);
      if (std::abs(ratio - 1) < 1e-3) break;
    }
  }
  return fitted;
}

Layout LayoutOf(const GyroReadings& readings, const GyroFitSetup& setup) {
  Layout layout;
  layout.channels = static_cast<int>(readings.channels.size());
  layout.rotors = static_cast<int>(readings.rotors.size());
  const bool paired = 2 * layout.rotors == layout.channels;
  layout.force = setup.force.value_or(paired ? GyroForceModel::kDualAxis : GyroForceModel::kFull);
  layout.aniso = layout.force == GyroForceModel::kDualAxis;
  layout.north = setup.fit_north;
  return layout;
}

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
    if (U[most] < 0.2 || U[most] > 5) {
      return BenchFault(data,
                        fmt::format("channel {} reads {:.4g} for one deg/h: give the readings "
                                    "in deg/h, all in one unit",
                                    channel.name, U[most]));
    }
  }
  return std::nullopt;
}

// Where the result stands in the report, for n channels: b (n), U (n x 3), G (n x 3); then M and Q
// by rotor, N and the north offset where the layout has them.
struct ResultPlaces {
  explicit ResultPlaces(const Layout& layout)
      : U(layout.channels),
        G(4 * layout.channels),
        MQ(7 * layout.channels),
        aniso(MQ + (layout.force == GyroForceModel::kDualAxis ? 2 * layout.rotors : 0)),
        north(aniso + (layout.aniso ? layout.channels : 0)),
        size(north + (layout.north ? 1 : 0)) {}

  int U, G, MQ, aniso, north, size;
};

Eigen::VectorXd ResultOf(const GyroReadings& readings, const Layout& layout,
                         const Eigen::VectorXd& x) {
  const ResultPlaces at(layout);
  const int n = layout.channels;
  Eigen::VectorXd to = Eigen::VectorXd::Zero(at.size);
  for (int c = 0; c < n; ++c) {
    to[c] = x[Eigen::Index{4} * c];
    to.segment<3>(at.U + 3 * c) = x.segment<3>(4 * c + 1);
    if (layout.force == GyroForceModel::kFull) {
      to.segment<3>(at.G + 3 * c) = x.segment<3>(layout.force_first() + 3 * c);
    }
  }
  for (int k = 0; layout.force == GyroForceModel::kDualAxis && k < layout.rotors; ++k) {
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
  if (layout.aniso) to.segment(at.aniso, n) = x.segment(layout.aniso_first(), n);
  if (layout.north) to[at.north] = ToDegrees(x[layout.north_first()]);
  return to;
}

void TakeResult(const GyroReadings& readings, const Layout& layout, FitReport& report) {
  const ResultPlaces at(layout);
  const int n = layout.channels, rotors = layout.rotors;
  const bool dual = layout.force == GyroForceModel::kDualAxis;
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
  if (layout.force != GyroForceModel::kNone) AddMatrix(report, "G_degh_per_g", at.G, n, 3);
  if (dual) AddVector(report, "MQ", at.MQ, 2 * rotors);
  if (layout.aniso) AddVector(report, "aniso_degh_per_g2", at.aniso, n);
  if (layout.north) AddNumber(report, "north_deg", at.north);
}

SensorGroup Group(const GyroReadings& readings, const Layout& layout,
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
      // q(f) holds xy, yz, zx behind the squares.
      const int axis = readings.channels[static_cast<std::size_t>(c)].axis;
      const int place = axis + rotor.spin == 1 ? 3 : axis + rotor.spin == 3 ? 4 : 5;
      group.g_squared(c, place) = values[at.aniso + c] / (g * g);
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
  constexpr double kLevel = 1e-3;  // g
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
  constexpr double kFalseAlarm = 0.01;
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

void TellHemisphere(const BenchReference& reference, FitReport& report) {
  for (const FitQuantity& q : report.result) {
    if (!reference.latitude || q.name != "G_degh_per_g") continue;
    for (const double term : q.value.reshaped()) {
      if (auto remark = OtherHemisphere(q.name, term, *reference.latitude)) {
        report.remarks.push_back(*std::move(remark));
        return;
      }
    }
  }
}

}  // namespace

Result<BenchCalibration> FitGyro(const BenchTable& rest, const BenchTable& table,
                                 const GyroFitSetup& setup) {
  const auto readings = ReadGyros(rest, table, setup.reference);
  if (!readings) return readings.fault();
  const BenchTable& data = rest.rows() > 0 ? rest : table;
  Layout layout = LayoutOf(*readings, setup);
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
  TakeResult(*readings, layout, report);
  TellHemisphere(setup.reference, report);
  out.gyro = Group(*readings, layout, setup.reference, report.values);
  AddParity(out.gyro, report);
  return out;
}

}  // namespace wellgyro

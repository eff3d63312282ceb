#include "wellgyro/fit/multi_station_fit.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/fit/added_terms_internal.h"
#include "wellgyro/fit/attitude_table_internal.h"
#include "wellgyro/fit/bench_checks_internal.h"
#include "wellgyro/fit/nonlinear_internal.h"
#include "wellgyro/fit/residual_trends_internal.h"
#include "wellgyro/math/median.h"

namespace wellgyro {
namespace {

constexpr std::string_view kStationAdvice =
    "add stations at other toolfaces and inclinations, or give priors of the biases and scales";

template <class T>
T Length(const T (&a)[3]) {
  using std::sqrt;
  return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

/// |M| and the dip of one station; parameters b (3), s (3).
struct FieldResidual {
  Eigen::Vector3d down, raw;
  double field, dip, sigma_field, sigma_dip;
  template <class T>
  bool operator()(const T* const* parameters, T* r) const {
    using std::asin;
    const T* p = parameters[0];
    T m[3];
    for (int i = 0; i < 3; ++i) m[i] = (raw[i] - p[i]) / (1.0 + p[3 + i]);
    const T length = Length(m);
    const T sine = (m[0] * down[0] + m[1] * down[1] + m[2] * down[2]) / length;
    r[0] = (length - field) / sigma_field;
    r[1] = (asin(sine) - dip) / sigma_dip;
    return true;
  }
};

/// Level and vertical part of w at one station, which noise moves independently; parameters b (3).
struct RateResidual {
  Eigen::Vector3d down, raw;
  double level, up, sigma;
  template <class T>
  bool operator()(const T* const* parameters, T* r) const {
    const T* p = parameters[0];
    const T w[3] = {raw[0] - p[0], raw[1] - p[1], raw[2] - p[2]};
    const T along = w[0] * down[0] + w[1] * down[1] + w[2] * down[2];
    const T across[3] = {w[0] - along * down[0], w[1] - along * down[1], w[2] - along * down[2]};
    r[0] = (Length(across) - level) / sigma;
    r[1] = (-along - up) / sigma;
    return true;
  }
};

/// Rates across the tool alone, at one station of which the azimuth is not known: parameters b (2),
/// then the azimuth of every station.
struct AcrossResidual {
  Eigen::Vector2d high, right, raw;  ///< high and right side in the sensors' axes
  double sine_inc, cosine_inc, level, up, sigma;
  int azimuth;
  template <class T>
  bool operator()(const T* const* parameters, T* r) const {
    using std::cos;
    using std::sin;
    const T* p = parameters[0];
    const T w_high = level * cosine_inc * cos(p[azimuth]) + up * sine_inc;
    const T w_right = -level * sin(p[azimuth]);
    for (int i = 0; i < 2; ++i) {
      r[i] = (p[i] + high[i] * w_high + right[i] * w_right - raw[i]) / sigma;
    }
    return true;
  }
};

struct PriorResidual {
  int parameter;
  double sigma;
  template <class T>
  bool operator()(const T* const* parameters, T* r) const {
    r[0] = parameters[0][parameter] / sigma;
    return true;
  }
};

Eigen::Vector3d DownOf(const AttitudeTable& table, int i) {
  const Eigen::Vector3d a = table.accel.row(i).transpose().normalized();
  return table.gravity_signed ? a : Eigen::Vector3d(-a);
}

void AddPriors(const MultiStationSetup& setup, int axes, bool scales, NonlinearProblem& problem) {
  for (int i = 0; i < axes; ++i) {
    if (setup.prior_bias) problem.Add({{0, "prior", 1}}, PriorResidual{i, *setup.prior_bias});
    if (scales && setup.prior_scale) {
      problem.Add({{0, "prior", 1}}, PriorResidual{3 + i, *setup.prior_scale});
    }
  }
}

NonlinearProblem Magnetic(const AttitudeTable& table, const MultiStationSetup& setup) {
  std::vector<std::string> names = VectorNames("bm_nT", 3);
  Append(names, VectorNames("sm", 3));
  NonlinearProblem problem(names, Eigen::VectorXd::Zero(6));
  // Without sigmas only their ratio matters. Magnetometers' 50 nT turn the dip by 50 / 50 000 rad =
  // 0.06 deg, accelerometers by as much: sqrt(2) of that is 0.08 deg.
  constexpr double kUsualField = 50, kUsualDip = 0.1 * units::kDeg;
  problem.sigma_given = setup.sigma_field && setup.sigma_dip;
  const double sigma_field = setup.sigma_field.value_or(kUsualField);
  const double sigma_dip = setup.sigma_dip.value_or(kUsualDip);
  for (int i = 0; i < table.rows(); ++i) {
    const int line = table.lines[static_cast<std::size_t>(i)];
    problem.Add(
        {{line, "field", sigma_field}, {line, "dip", sigma_dip}},
        FieldResidual{DownOf(table, i), table.mag.row(i).transpose(), *setup.reference.field,
                      *setup.reference.dip, sigma_field, sigma_dip});
  }
  AddPriors(setup, 3, true, problem);
  return problem;
}

NonlinearProblem Gyros(const BenchTable& data, const std::vector<int>& columns,
                       const AttitudeTable& table, const MultiStationSetup& setup) {
  NonlinearProblem problem(VectorNames("bg_degh", 3), Eigen::VectorXd::Zero(3));
  problem.sigma_given = setup.sigma_rate.has_value();
  const double sigma = setup.sigma_rate.value_or(1);
  for (int i = 0; i < table.rows(); ++i) {
    const int line = table.lines[static_cast<std::size_t>(i)];
    problem.Add({{line, "level", sigma}, {line, "vertical", sigma}},
                RateResidual{DownOf(table, i), data.values(i, columns).transpose(),
                             kBenchEarthDegPerHour * std::cos(*setup.reference.latitude),
                             kBenchEarthDegPerHour * std::sin(*setup.reference.latitude), sigma});
  }
  AddPriors(setup, 3, false, problem);
  return problem;
}

std::vector<AcrossResidual> AcrossStations(const BenchTable& data, const std::vector<int>& columns,
                                           const AttitudeTable& table,
                                           const MultiStationSetup& setup) {
  std::vector<AcrossResidual> stations;
  stations.reserve(static_cast<std::size_t>(table.rows()));
  for (int i = 0; i < table.rows(); ++i) {
    const Eigen::Vector3d down = DownOf(table, i);
    const double sine = down.head<2>().norm();
    // Where it is vertical any direction will do for the high side.
    const Eigen::Vector2d high =
        sine > 1e-9 ? Eigen::Vector2d(-down.head<2>() / sine) : Eigen::Vector2d(1, 0);
    stations.push_back({high,
                        {-high.y(), high.x()},
                        data.values(i, columns).transpose(),
                        sine,
                        down.z(),
                        kBenchEarthDegPerHour * std::cos(*setup.reference.latitude),
                        kBenchEarthDegPerHour * std::sin(*setup.reference.latitude),
                        setup.sigma_rate.value_or(1),
                        2 + i});
  }
  return stations;
}

// The azimuth of every station that suits the biases in x best, of a whole circle: two minima, east
// and west of north or north and south of east, may both be near.
void TakeBestAzimuths(const std::vector<AcrossResidual>& stations, Eigen::VectorXd& x) {
  // The cost has harmonics of the azimuth up to the second, 90 samples to the period of that: at
  // most 1 deg from each minimum, where the solver goes on.
  constexpr int kDirections = 180;
  for (const AcrossResidual& station : stations) {
    double least = std::numeric_limits<double>::infinity(), best = 0;
    for (int k = 0; k < kDirections; ++k) {
      const double azimuth = kTwoPi * k / kDirections;
      x[station.azimuth] = azimuth;
      const double* const parameters = x.data();
      double r[2];
      station(&parameters, r);
      const double cost = r[0] * r[0] + r[1] * r[1];
      if (cost < least) {
        least = cost;
        best = azimuth;
      }
    }
    x[station.azimuth] = best;
  }
}

Result<NonlinearProblem::Solution> SolveTwoGyros(const BenchTable& data,
                                                 const std::vector<int>& columns,
                                                 const AttitudeTable& table,
                                                 const MultiStationSetup& setup) {
  const std::vector<AcrossResidual> stations = AcrossStations(data, columns, table, setup);
  std::vector<std::string> names = VectorNames("bg_degh", 2);
  Append(names, VectorNames("azimuth", table.rows()));
  Eigen::VectorXd start = Eigen::VectorXd::Zero(2 + table.rows());
  TakeBestAzimuths(stations, start);
  NonlinearProblem problem(names, start);
  problem.sigma_given = setup.sigma_rate.has_value();
  problem.robust = false;
  for (std::size_t i = 0; i < stations.size(); ++i) {
    const double sigma = stations[i].sigma;
    problem.Add({{table.lines[i], "wx", sigma}, {table.lines[i], "wy", sigma}}, stations[i]);
  }
  AddPriors(setup, 2, false, problem);
  auto best = problem.Solve();
  for (int turn = 0; turn < 5 && best; ++turn) {
    Eigen::VectorXd again = best->x;
    TakeBestAzimuths(stations, again);
    problem.Start(again);
    auto next = problem.Solve();
    if (!next || next->cost > best->cost * (1 - 1e-9)) break;
    best = std::move(next);
  }
  return best;
}

void RemarkPriors(const MultiStationSetup& setup, FitReport& report) {
  for (Eigen::Index i = 0; i < report.values.size() && report.cov.size() > 0; ++i) {
    const auto& prior = i < 3 ? setup.prior_bias : setup.prior_scale;
    if (prior && std::sqrt(report.cov(i, i)) > 0.7 * *prior) {
      report.remarks.push_back(
          fmt::format("the stations say next to nothing of {}: it rests on "
                      "its prior",
                      report.parameters[static_cast<std::size_t>(i)]));
    }
  }
}

std::optional<Fault> BadStations(const BenchTable& data, const AttitudeTable& table,
                                 const MultiStationSetup& setup) {
  if (auto fault = TooFew(data, 4, "stations", kStationAdvice)) return fault;
  if (auto fault = BadReadings(data, table)) return fault;
  return MixedUnits(data, ColumnsOf(data, table.accel_channels), setup.reference.gravity,
                    "the length of the accelerometers", "g, or m/s2");
}

// The dip as read, of the wrong sign: the accelerometers give the force where gravity is asked for.
std::optional<Fault> WrongDip(const BenchTable& data, const AttitudeTable& table, double dip) {
  std::vector<double> dips;
  for (int i = 0; i < table.rows(); ++i) {
    const Eigen::Vector3d m = table.mag.row(i).transpose(), down = DownOf(table, i);
    dips.push_back(std::atan2(m.dot(down), (m - m.dot(down) * down).norm()));
  }
  const double middle = Median(std::move(dips));
  if (std::abs(middle + dip) > std::abs(middle - dip) / 2) return std::nullopt;
  return BenchFault(data,
                    fmt::format("the readings dip by {:.1f} deg where {:.1f} deg is expected: the "
                                "sign of the accelerometers is wrong (Gx, Gy, Gz show gravity, fx, "
                                "fy, fz the force against it), or that of the magnetometers",
                                middle / units::kDeg, dip / units::kDeg),
                    data.lines[0]);
}

std::optional<Fault> BadField(const BenchTable& data, const AttitudeTable& table,
                              const BenchReference& reference) {
  if (auto fault = MixedUnits(data, ColumnsOf(data, table.mag_channels), *reference.field,
                              "the length of the magnetometers", "nT")) {
    return fault;
  }
  return WrongDip(data, table, *reference.dip);
}

Result<std::vector<int>> RateColumns(const BenchTable& data) {
  if (!data.Find("wz")) return FindColumns(data, {"wx", "wy"});
  auto rates = FindColumns(data, {"wx", "wy", "wz"});
  if (!rates) return rates;
  if (auto fault =
          MixedUnits(data, *rates, kBenchEarthDegPerHour, "the length of (wx, wy, wz)", "deg/h")) {
    return *fault;
  }
  return rates;
}

void RequireReference(const BenchReference& reference, bool gyros) {
  if (!gyros && (!reference.field || !reference.dip)) {
    throw std::invalid_argument("magnetometers need the field and its dip");
  }
  if (gyros && !reference.latitude) throw std::invalid_argument("gyros need the latitude");
}

// From two gyros, from three, or from the magnetometers where `rates` has no columns.
Result<NonlinearProblem::Solution> SolveStations(const BenchTable& data,
                                                 const std::vector<int>& rates,
                                                 const AttitudeTable& table,
                                                 const MultiStationSetup& setup) {
  if (rates.empty()) return Magnetic(table, setup).Solve();
  if (rates.size() == 2) return SolveTwoGyros(data, rates, table, setup);
  return Gyros(data, rates, table, setup).Solve();
}

struct GivenOfPlace {
  const char* name;
  double stated, unit;
  const char* in;
};

// What was given of the place is a term too, of which the stations may say something else: of a dip
// that is 1 deg off the biases take a part, and the rest looked like noise.
void TellPlace(LinearProblem linear, const BenchReference& reference, FitReport& report) {
  linear.robust = false;
  const double latitude = reference.latitude.value_or(0);
  Eigen::MatrixXd Z = Eigen::MatrixXd::Zero(linear.y.size(), 3);
  for (Eigen::Index row = 0; row < Z.rows(); ++row) {
    const std::string& channel = linear.rows[static_cast<std::size_t>(row)].channel;
    if (channel == "field") Z(row, 0) = 1;
    if (channel == "dip") Z(row, 1) = 1;
    if (channel == "level") Z(row, 2) = -kBenchEarthDegPerHour * std::sin(latitude);
    if (channel == "vertical") Z(row, 2) = kBenchEarthDegPerHour * std::cos(latitude);
  }
  const std::vector<AddedTerm> terms = AddedTerms(linear, Solve(linear)).Test(Z, kFalseAlarm / 4);
  const GivenOfPlace references[] = {{"field", reference.field.value_or(0), 1, "nT"},
                                     {"dip", reference.dip.value_or(0), units::kDeg, "deg"},
                                     {"latitude", latitude, units::kDeg, "deg"}};
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const GivenOfPlace& of = references[i];
    if (!(terms[i].sigmas > terms[i].limit)) continue;
    report.remarks.push_back(fmt::format(
        "the stations suit a {} of {:.5g} {}, {:+.2g} beside the one given ({:.1f} sigmas, chance "
        "reaches {:.1f}): it is wrong there, and the result with it, or the readings are disturbed",
        of.name, (of.stated - terms[i].coefficient) / of.unit, of.in,
        -terms[i].coefficient / of.unit, terms[i].sigmas, terms[i].limit));
  }
}

void TakeResult(std::size_t gyros, FitReport& report) {
  // The stations' azimuths served their turn.
  if (gyros == 2) {
    Reparametrise(report, VectorNames("bg_degh", 2),
                  [](const Eigen::VectorXd& x) { return Eigen::VectorXd(x.head<2>()); });
  }
  AddVector(report, gyros > 0 ? "bg_degh" : "bm_nT", 0, gyros == 2 ? 2 : 3);
  if (gyros == 0) AddVector(report, "sm", 3, 3);
}

}  // namespace

Result<BenchCalibration> FitMultiStation(const BenchTable& data, const MultiStationSetup& setup) {
  const bool gyros = data.Find("wx").has_value();
  const auto table = ReadAttitudeTable(data, {.accel = true, .mag = !gyros});
  if (!table) return table.fault();
  if (auto fault = BadStations(data, *table, setup)) return *fault;
  RequireReference(setup.reference, gyros);
  const auto rates = gyros ? RateColumns(data) : std::vector<int>();
  if (!rates) return rates.fault();
  if (!gyros) {
    if (auto fault = BadField(data, *table, setup.reference)) return *fault;
  }
  const auto solution = SolveStations(data, *rates, *table, setup);
  auto whole = WholeReport(data, solution, kStationAdvice);
  if (!whole) return whole.fault();
  BenchCalibration out;
  out.report = *std::move(whole);
  FitReport& report = out.report;
  report.method = "multi-station";
  RemarkTemperature(data, report);
  if (auto fault = DoesNotFit(data,
                              {{"wx", kBenchEarthDegPerHour},
                               {"wy", kBenchEarthDegPerHour},
                               {"field", setup.reference.field.value_or(0)},
                               {"dip", 1},
                               {"level", kBenchEarthDegPerHour},
                               {"vertical", kBenchEarthDegPerHour}},
                              report)) {
    return *fault;
  }
  if (rates->size() != 2) TellPlace(solution->linear, setup.reference, report);
  TakeResult(rates->size(), report);
  RemarkPriors(setup, report);
  return out;
}

}  // namespace wellgyro

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/fit/bench_checks_internal.h"
#include "wellgyro/fit/position_readings_internal.h"
#include "wellgyro/fit/settled_run.h"

namespace wellgyro {
namespace {

constexpr std::string_view kAxes = "xyz";

std::string PositionText(std::size_t at) {
  const std::size_t quarter = at / 3 % 4, down = at / 12 % 2, axis = at / 24;
  return fmt::format("{} {} at {} deg", kAxes[axis], down != 0 ? "down" : "up", quarter * 90);
}

struct Series {
  std::vector<double> volts;
  int line = 0;
};

struct RawRun {
  std::map<std::size_t, Series> series;
  double temperature_sum = 0;
  int rows = 0;
};

// Places of the columns.
struct Columns {
  int axis = 0, dir = 0, rot = 0, channel = 0, volt = 0;
  std::optional<int> temperature;
};

std::optional<Fault> Place(const BenchTable& data, const Columns& columns, int row,
                           std::size_t* at) {
  const auto value = [&](int column) { return data.values(row, column); };
  const int line = data.lines[static_cast<std::size_t>(row)];
  const double axis = value(columns.axis), channel = value(columns.channel);
  const double quarter = std::fmod(std::fmod(value(columns.rot), 360.0) + 360.0, 360.0) / 90;
  if (axis != 0 && axis != 1 && axis != 2) {
    return BenchFault(data, "column axis must be x, y or z", line);
  }
  if (channel != 0 && channel != 1 && channel != 2) {
    return BenchFault(data, "column channel must be x, y or z", line);
  }
  if (std::abs(value(columns.dir)) != 1) {
    return BenchFault(data, "column dir must be up or down", line);
  }
  if (quarter != std::floor(quarter)) {
    return BenchFault(
        data,
        fmt::format("rotation {} deg: the four rotations are 0, 90, 180, 270", value(columns.rot)),
        line);
  }
  *at = PositionRun::At(static_cast<int>(axis), value(columns.dir) < 0 ? 1 : 0,
                        static_cast<int>(quarter), static_cast<int>(channel));
  return std::nullopt;
}

std::optional<Fault> Gather(const BenchTable& data, const Columns& columns,
                            std::vector<RawRun>* runs) {
  std::set<std::size_t> visited;
  std::optional<std::size_t> here;
  runs->emplace_back();
  for (int row = 0; row < data.rows(); ++row) {
    std::size_t at = 0;
    if (auto fault = Place(data, columns, row, &at)) return fault;
    const std::size_t position = at / 3;
    if (here != position) {
      if (visited.count(position) > 0) {
        runs->emplace_back();
        visited.clear();
      }
      visited.insert(position);
      here = position;
    }
    RawRun& run = runs->back();
    Series& series = run.series[at];
    if (series.volts.empty()) series.line = data.lines[static_cast<std::size_t>(row)];
    series.volts.push_back(data.values(row, columns.volt));
    if (columns.temperature) run.temperature_sum += data.values(row, *columns.temperature);
    ++run.rows;
  }
  return std::nullopt;
}

std::optional<Fault> Missing(const BenchTable& data, const RawRun& run, bool alone) {
  std::string text;
  int missing = 0;
  for (std::size_t at = 0; at < 72; ++at) {
    if (run.series.count(at) > 0) continue;
    if (++missing > 4) continue;
    text +=
        fmt::format("{}{}, channel {}", missing > 1 ? "; " : "", PositionText(at), kAxes[at % 3]);
  }
  if (missing == 0) return std::nullopt;
  if (missing > 4) text += fmt::format("; and {} more", missing - 4);
  return BenchFault(
      data,
      fmt::format("readings are missing: {}; measure these positions, all three axes "
                  "up and down at four rotations{}",
                  text, alone ? "" : "; rows stand in the order of time, a position's together"),
      run.series.empty() ? 0 : run.series.begin()->second.line);
}

// Slopes of short runs against the scatter about them, pooled over all positions: those of settled
// readings are noise, F with (series, n - 2 each) degrees of freedom, one false alarm in a
// thousand.
double PooledDrift(const RawRun& raw) {
  double slopes = 0, squares = 0, freedom = 0, n_series = 0, length = 0, spread = 0;
  for (const auto& [at, series] : raw.series) {
    const auto n = static_cast<double>(series.volts.size());
    if (n < 3 || n >= 8) continue;
    const double middle = (n - 1) / 2, first = series.volts.front();
    double tt = 0, tv = 0, sum = 0, vv = 0;
    for (std::size_t i = 0; i < series.volts.size(); ++i) {
      const double t = static_cast<double>(i) - middle, v = series.volts[i] - first;
      tt += t * t;
      tv += t * v;
      sum += v;
      vv += v * v;
    }
    slopes += tv * tv / tt;
    squares += std::max(0.0, vv - sum * sum / n - tv * tv / tt);
    freedom += n - 2;
    n_series += 1;
    length += (n - 1) * (n - 1);
    spread += tt;
  }
  if (n_series < 1) return 0;
  const double noise = squares / freedom, mean = slopes / n_series;
  // Paulson's normal form of F.
  const double root = std::cbrt(mean / std::max(noise, 1e-30));
  const double a = 2 / (9 * n_series), b = 2 / (9 * freedom);
  const double z = ((1 - b) * root - (1 - a)) / std::sqrt(b * root * root + a);
  constexpr double kOnceInAThousand = 3.09;  // normal quantile at 0.999
  if (!(z > kOnceInAThousand)) return 0;
  return std::sqrt((mean - noise) * length / spread);
}

Result<PositionRun> Settled(const BenchTable& data, const RawRun& raw, double tolerance,
                            bool alone) {
  if (auto fault = Missing(data, raw, alone)) return *fault;
  PositionRun run;
  run.temperature = raw.temperature_sum / raw.rows;
  for (const auto& [at, series] : raw.series) {
    // Readings that differ by exactly the tolerance repeat; their decimals are not exact. A double
    // holds one to 1e-16, and no voltmeter has twelve digits.
    constexpr double kRounding = 1e-12;
    const double largest = std::abs(series.volts.back());
    const SettledRun settled = Settle(series.volts, tolerance * (1 + 1e-9) + kRounding * largest);
    if (!settled.settled) {
      const std::vector<double> end(
          series.volts.end() - std::min<std::ptrdiff_t>(3, std::ssize(series.volts)),
          series.volts.end());
      const double left =
          std::abs(std::accumulate(end.begin(), end.end(), 0.0) / static_cast<double>(end.size()) -
                   settled.value);
      return BenchFault(
          data,
          series.volts.size() < 3
              ? fmt::format("{}, channel {}: {} readings, three that repeat are needed",
                            PositionText(at), kAxes[at % 3], series.volts.size())
              : fmt::format("{}, channel {}: the readings have not settled, the last three {} by "
                            "{:.3g} V; read on until they repeat, or give the tolerance",
                            PositionText(at), kAxes[at % 3],
                            series.volts.size() < 8 ? "differ" : "lie beside where they tend to",
                            series.volts.size() < 8 ? settled.spread : left),
          series.line);
    }
    run.readings[at] = {settled.value, series.line};
  }
  run.drift = PooledDrift(raw);
  return run;
}

// The greatest number of which both are multiples, to `rounding` (Euclid).
double CommonDivisor(double a, double b, double rounding) {
  while (b > rounding) {
    const double rest = std::abs(a - b * std::round(a / b));
    a = b;
    b = rest;
  }
  return a;
}

// The converter's step: the greatest of which all differences are multiples, where so few values
// stand for so many readings that it is no noise. Not the least difference: still readings of the
// 24 positions may all be several steps apart.
double StepOf(const BenchTable& data, int volt) {
  std::vector<double> values(data.values.col(volt).begin(), data.values.col(volt).end());
  std::sort(values.begin(), values.end());
  const double first = values.front(), range = values.back() - first;
  double step = 0;
  std::size_t distinct = 1;
  for (std::size_t i = 1; i < values.size(); ++i) {
    if (!(values[i] - values[i - 1] > 1e-12 * range)) continue;
    // Of the range: finer than a converter of 26 bits, 2^-26 = 1.5e-8, coarser than the rounding of
    // differences, 1e-12.
    constexpr double kFinest = 1e-8;
    const double apart = values[i] - first;
    step = CommonDivisor(apart, step, kFinest * range);
    step = apart / std::round(apart / step);  // or rounding grows from value to value
    ++distinct;
  }
  if (!(step > 0) || 2 * distinct > values.size()) return 0;
  // [steps]: of values that are no multiples of it one in fifty is so close by chance.
  constexpr double kWhole = 0.01;
  const bool multiples = std::all_of(values.begin(), values.end(), [&](double value) {
    const double steps = (value - first) / step;
    return std::abs(steps - std::round(steps)) < kWhole;
  });
  return multiples ? step : 0;
}

}  // namespace

double PositionRun::P(int axis, int down, int channel) const {
  double sum = 0;
  for (int q = 0; q < 4; ++q) sum += Of(axis, down, q, channel).volt;
  return sum / 4;
}

double PositionRun::Alternating(int axis, int down, int channel) const {
  const auto v = [&](int q) { return Of(axis, down, q, channel).volt; };
  return ((v(0) + v(2)) - (v(1) + v(3))) / 4;
}

Eigen::Vector2d PositionRun::Harmonic(int axis, int down, int channel) const {
  const auto v = [&](int q) { return Of(axis, down, q, channel).volt; };
  return {(v(1) - v(3)) / 2, (v(0) - v(2)) / 2};
}

Result<std::vector<PositionRun>> ReadPositionRuns(const BenchTable& data, double tolerance) {
  const auto places = FindColumns(data, {"axis", "dir", "rot_deg", "channel", "volt"});
  if (!places) return places.fault();
  const std::vector<int>& p = *places;
  const Columns columns{p[0], p[1], p[2], p[3], p[4], data.Find("T_C")};
  if (data.Find("sample")) {
    if (auto fault = Repeated(data)) return *fault;
  }
  std::vector<RawRun> raw;
  if (auto fault = Gather(data, columns, &raw)) return *fault;
  const double step = StepOf(data, columns.volt);
  std::vector<PositionRun> runs;
  for (const RawRun& run : raw) {
    auto settled = Settled(data, run, tolerance, raw.size() == 1);
    if (!settled) return settled.fault();
    settled->has_temperature = columns.temperature.has_value();
    settled->step = step;
    runs.push_back(*std::move(settled));
  }
  return runs;
}

}  // namespace wellgyro

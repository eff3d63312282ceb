#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/fit/attitude_table_internal.h"
#include "wellgyro/fit/bench_checks_internal.h"
#include "wellgyro/fit/tool_rows_internal.h"

namespace wellgyro {
namespace {

bool IsRateTable(const BenchTable& data) { return data.Find("rate_deg_s").has_value(); }

std::string Lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

// A column whose name is known but for capitals or a unit behind it would be passed over in
// silence.
std::optional<Fault> Misnamed(const BenchTable& data) {
  static constexpr const char* kKnown[] = {"inc",        "az", "tf", "T_C", "t_s", "axis",
                                           "rate_deg_s", "Gx", "Gy", "Gz",  "fx",  "fy",
                                           "fz",         "vx", "vy", "vz"};
  for (const std::string& column : data.columns) {
    const std::string bare = Lower(column.substr(0, column.find('[')));
    const bool gyro = bare.rfind("m_", 0) == 0 && column != bare;
    const auto meant = std::find_if(std::begin(kKnown), std::end(kKnown), [&](const char* name) {
      return Lower(name) == bare && column != name;
    });
    if (!gyro && (meant == std::end(kKnown) || data.Find(*meant))) continue;
    return BenchFault(data,
                      fmt::format("column \"{}\" would not be read: its name is {}, without a unit",
                                  column, gyro ? bare : *meant),
                      1, FaultCode::kForeign);
  }
  return std::nullopt;
}

// Of three columns one that is missing or misnamed would leave all three out in silence.
std::optional<Fault> PartOfAccelerometers(const BenchTable& data) {
  for (const char kind : {'G', 'f', 'v'}) {
    std::vector<std::string> there, lacking;
    for (const char axis : {'x', 'y', 'z'}) {
      const std::string name{kind, axis};
      (data.Find(name) ? there : lacking).push_back(name);
    }
    if (there.empty() || lacking.empty()) continue;
    return BenchFault(data,
                      fmt::format("column {} is missing beside {}: accelerometers come by three",
                                  fmt::join(lacking, ", "), fmt::join(there, ", ")),
                      1, FaultCode::kForeign);
  }
  return std::nullopt;
}

std::optional<Fault> TakeAccelerometers(const BenchTable& data, ToolReadings& readings) {
  if (auto fault = PartOfAccelerometers(data)) return fault;
  const auto table = ReadAttitudeTable(data, {.attitude = true});
  if (!table) return table.fault();
  if (table->accel.rows() == 0) return std::nullopt;
  if (readings.n_accel == 0) {
    readings.n_accel = 3;
    readings.gravity_signed = table->gravity_signed;
    for (int c = 0; c < 3; ++c) {
      readings.channels.insert(readings.channels.begin() + c,
                               {table->accel_channels[static_cast<std::size_t>(c)], false, c});
    }
  }
  if (table->accel_channels.front() == readings.channels.front().name) return std::nullopt;
  return BenchFault(data,
                    fmt::format("the accelerometers are {}.. here and {}.. in another table: give "
                                "all tables the same columns",
                                table->accel_channels.front(), readings.channels.front().name),
                    1, FaultCode::kConflict);
}

bool HasGyros(const BenchTable& data) {
  return std::any_of(data.columns.begin(), data.columns.end(),
                     [](const std::string& name) { return name.rfind("m_", 0) == 0; });
}

std::optional<Fault> TakeGyros(const BenchTable& data, ToolReadings& readings) {
  if (!HasGyros(data)) return std::nullopt;
  const auto channels = GyroChannelsOf(data);
  if (!channels) return channels.fault();
  if (readings.n_gyro == 0) {
    readings.n_gyro = static_cast<int>(channels->size());
    readings.rotors = RotorsOf(*channels);
    for (const GyroChannel& channel : *channels) {
      readings.channels.push_back({channel.name, true, channel.axis});
    }
    return std::nullopt;
  }
  for (const GyroChannel& channel : *channels) {
    const bool known = std::any_of(readings.channels.begin(), readings.channels.end(),
                                   [&](const ToolChannel& c) { return c.name == channel.name; });
    if (!known) {
      return BenchFault(data,
                        fmt::format("channel {} is in no other table: give all tables the same "
                                    "gyros",
                                    channel.name),
                        1, FaultCode::kConflict);
    }
  }
  return std::nullopt;
}

// Places of the tool's channels in a table, -1 where it has none.
std::vector<int> PlacesIn(const BenchTable& data, const ToolReadings& readings) {
  std::vector<int> places;
  const bool attitudes = !IsRateTable(data);
  for (const ToolChannel& channel : readings.channels) {
    // A rate table says nothing to the accelerometers.
    const bool usable = channel.is_gyro || attitudes;
    places.push_back(usable ? data.Find(channel.name).value_or(-1) : -1);
  }
  return places;
}

std::optional<Fault> Attitude(const BenchTable& data, const ToolFitSetup& setup, int i,
                              ToolRow& row) {
  const auto value = [&](const char* name) { return data.values(i, *data.Find(name)); };
  if (IsRateTable(data)) {
    const double axis = value("axis");
    if (axis != 0 && axis != 1 && axis != 2) {
      return BenchFault(data, "column axis must be x, y or z", row.line);
    }
    row.mount = 3 * row.table + static_cast<int>(axis);
    row.rate = value("rate_deg_s") * units::kHour;
    return std::nullopt;
  }
  SetAttitude(setup.reference.axes,
              {FromDegrees(value("inc")), FromDegrees(value("az")), FromDegrees(value("tf"))}, row);
  return std::nullopt;
}

// Temperature, its rate and the branch that it is on, and time through the table.
void Follow(const BenchTable& data, std::span<ToolRow> rows) {
  const auto T = data.Find("T_C"), t = data.Find("t_s");
  const int n = data.rows();
  const auto second_of = [&](int i) { return t ? data.values(i, *t) : static_cast<double>(i); };
  const double middle = (second_of(0) + second_of(n - 1)) / 2;
  const double half = std::max(std::abs(second_of(n - 1) - second_of(0)) / 2, 1e-9);
  // [degC/s], 0.36 degC/h: a hundredth of a degree in 100 s, a thermometer's last digit from
  // reading to reading; ramps are ten times as fast and more.
  constexpr double kStill = 1e-4;
  double branch = 0;
  for (int i = 0; i < n; ++i) {
    ToolRow& row = rows[static_cast<std::size_t>(i)];
    row.time = (second_of(i) - middle) / half;
    if (!T) continue;
    row.temperature = data.values(i, *T);
    const int a = std::max(0, i - 1), b = std::min(n - 1, i + 1);
    if (!t || !(second_of(b) > second_of(a))) continue;
    row.heating = (data.values(b, *T) - data.values(a, *T)) / (second_of(b) - second_of(a));
    if (std::abs(row.heating) > kStill) branch = row.heating > 0 ? 1 : -1;
    row.branch = branch;
  }
}

std::optional<Fault> CheckOrder(const BenchTable& data) {
  const auto t = data.Find("t_s");
  for (int i = 1; t && i < data.rows(); ++i) {
    if (data.values(i, *t) > data.values(i - 1, *t)) continue;
    return BenchFault(data, "t_s does not rise from row to row: rows stand in the order of time",
                      data.lines[static_cast<std::size_t>(i)], FaultCode::kOrder);
  }
  return std::nullopt;
}

std::optional<Fault> Check(const BenchTable& data, const std::vector<int>& places) {
  if (auto fault = CheckOrder(data)) return fault;
  if (auto fault = Repeated(data)) return fault;
  std::vector<int> read;
  for (const int place : places) {
    if (place >= 0) read.push_back(place);
  }
  if (read.empty()) {
    return BenchFault(data, "the table has no channels: Gx.. or fx.. or vx.., or m_x1, m_y1 ...", 1,
                      FaultCode::kForeign);
  }
  if (auto fault = Frozen(data, read)) return fault;
  if (IsRateTable(data)) {
    const auto found = FindColumns(data, {"axis"});
    return found ? std::optional<Fault>() : found.fault();
  }
  const auto found = FindColumns(data, {"inc", "az", "tf"});
  if (!found) return found.fault();
  return RadiansForDegrees(data, *found);
}

// What a column of a rate table rises by with the rate about an axis, 0 where none was turned.
double SlopeOnTable(const BenchTable& data, int column, int axis) {
  const auto axes = data.values.col(*data.Find("axis")).array();
  const Eigen::ArrayXd turned =
      (axes == axis).select(data.values.col(*data.Find("rate_deg_s")).array() * units::kHour, 0.0);
  const double square = turned.square().sum();
  return square > 0 ? (turned * data.values.col(column).array()).sum() / square : 0;
}

// A factor between units leaves nothing of the readings at rest beside it to see it by. The axis
// that a channel follows most is found, for names of axes may be exchanged.
std::optional<Fault> OtherRates(const BenchTable& data, const ToolReadings& readings) {
  for (const ToolChannel& channel : readings.channels) {
    const auto column = data.Find(channel.name);
    if (!channel.is_gyro || !column || SlopeOnTable(data, *column, channel.axis) == 0) continue;
    double most = 0;
    for (int axis = 0; axis < 3; ++axis) {
      most = std::max(most, std::abs(SlopeOnTable(data, *column, axis)));
    }
    if (auto fault = OtherRate(data, channel.name, most)) return fault;
  }
  return std::nullopt;
}

std::optional<Fault> AddTable(const BenchTable& data, const ToolFitSetup& setup, int table,
                              ToolReadings& readings) {
  const std::vector<int> places = PlacesIn(data, readings);
  if (auto fault = Check(data, places)) return fault;
  if (IsRateTable(data)) {
    if (auto fault = OtherRates(data, readings)) return fault;
  }
  const std::size_t first = readings.rows.size();
  for (int i = 0; i < data.rows(); ++i) {
    ToolRow row;
    row.table = table;
    row.line = data.lines[static_cast<std::size_t>(i)];
    if (auto fault = Attitude(data, setup, i, row)) return fault;
    for (std::size_t c = 0; c < places.size(); ++c) {
      if (places[c] < 0) continue;
      row.channels.push_back(static_cast<int>(c));
      row.v.conservativeResize(row.v.size() + 1);
      row.v[row.v.size() - 1] = data.values(i, places[c]);
    }
    readings.rows.push_back(std::move(row));
  }
  Follow(data, std::span(readings.rows).subspan(first));
  return std::nullopt;
}

// Readings that stand twice would count twice.
std::optional<Fault> SameTable(std::span<const BenchTable> tables) {
  for (std::size_t b = 1; b < tables.size(); ++b) {
    for (std::size_t a = 0; a < b; ++a) {
      const bool same = tables[a].columns == tables[b].columns &&
                        tables[a].rows() == tables[b].rows() &&
                        tables[a].values == tables[b].values;
      if (!same) continue;
      return BenchFault(
          tables[b], fmt::format("the same readings as {}: give each table once", tables[a].source),
          1, FaultCode::kConflict);
    }
  }
  return std::nullopt;
}

// Under whatever times: rows that read the same channels.
std::optional<Fault> CopiedReadings(std::span<const BenchTable> tables,
                                    const ToolReadings& readings) {
  std::map<std::vector<int>, std::vector<const ToolRow*>> of;
  for (const ToolRow& row : readings.rows) of[row.channels].push_back(&row);
  for (const auto& [channels, rows] : of) {
    Eigen::MatrixXd values(rows.size(), channels.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      values.row(static_cast<Eigen::Index>(i)) = rows[i]->v.transpose();
    }
    const auto copy = CopyAmong(values);
    if (!copy) continue;
    const ToolRow& first = *rows[static_cast<std::size_t>(copy->first)];
    const ToolRow& second = *rows[static_cast<std::size_t>(copy->second)];
    const BenchTable& data = tables[static_cast<std::size_t>(second.table)];
    const std::string& source = tables[static_cast<std::size_t>(first.table)].source;
    return BenchFault(
        data,
        fmt::format("line {} repeats the readings of {}line {} to the last digit in "
                    "every channel: two readings never do; give each once, or "
                    "measure again",
                    second.line, first.table == second.table ? "" : source + ", ", first.line),
        second.line, FaultCode::kConflict);
  }
  return std::nullopt;
}

std::optional<Fault> SpanTemperatures(std::span<const BenchTable> tables, ToolReadings& readings) {
  std::size_t with = 0;
  for (const BenchTable& data : tables) with += data.Find("T_C") ? 1 : 0;
  if (with == 0) return std::nullopt;
  if (with < tables.size()) {
    const auto without = std::find_if(tables.begin(), tables.end(), [](const BenchTable& data) {
      return !data.Find("T_C").has_value();
    });
    return BenchFault(*without,
                      "no column T_C where other tables have one: say at what temperature these "
                      "were read",
                      1, FaultCode::kForeign);
  }
  readings.coldest = readings.hottest = readings.rows.front().temperature;
  for (const ToolRow& row : readings.rows) {
    readings.coldest = std::min(readings.coldest, row.temperature);
    readings.hottest = std::max(readings.hottest, row.temperature);
  }
  // [degC]: thermometers agree to one, a tenth of what a slope would then be told by; less than ten
  // is the room, and its terms would be carried on to a hole that is 100 degC warmer.
  constexpr double kLeastSweep = 10;
  readings.has_temperature = readings.hottest - readings.coldest >= kLeastSweep;
  readings.middle = (readings.coldest + readings.hottest) / 2;
  if (readings.has_temperature) readings.half_range = (readings.hottest - readings.coldest) / 2;
  return std::nullopt;
}

}  // namespace

void SetAttitude(BenchAxes axes, const StandAngles& stated, ToolRow& row) {
  row.stated = stated;
  row.across_L = {-std::sin(stated.azimuth), std::cos(stated.azimuth), 0};
  row.R_BL = BenchFromLevel(axes, stated.inclination, stated.azimuth, stated.toolface);
}

Result<ToolReadings> ReadTool(std::span<const BenchTable> tables, const ToolFitSetup& setup) {
  ToolReadings readings;
  if (auto fault = SameTable(tables)) return *fault;
  for (const BenchTable& data : tables) {
    if (auto fault = Misnamed(data)) return *fault;
    if (!IsRateTable(data)) {
      if (auto fault = TakeAccelerometers(data, readings)) return *fault;
    }
    if (auto fault = TakeGyros(data, readings)) return *fault;
  }
  for (const BenchTable& data : tables) {
    if (auto fault = AddTable(data, setup, readings.n_tables++, readings)) return *fault;
  }
  if (auto fault = CopiedReadings(tables, readings)) return *fault;
  if (auto fault = SpanTemperatures(tables, readings)) return *fault;
  return readings;
}

}  // namespace wellgyro

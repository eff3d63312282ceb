#include "wellgyro/io/toml/tool_file.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <stdexcept>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/calibration/apply.h"
#include "wellgyro/io/formats.h"
#include "wellgyro/io/text_file.h"
#include "wellgyro/io/toml/coefficients_internal.h"
#include "wellgyro/io/toml/toml_writer_internal.h"
#include "wellgyro/io/toml/tool_sections_internal.h"

namespace wellgyro {
namespace {

constexpr std::string_view kHead =
    "From counts of raw_batch_t to SI units in tool axes T (z down-hole, x to the reference mark,\n"
    "y right-handed). Every channel c of a group of sensors reads, in its own unit,\n"
    "  v[c] = count[c] * unit_per_count[c]   (per second of the sample where per_second)\n"
    "       = bias[c] + sensitivity[c] . u + second_order[c] . q(u)\n"
    "         + g_dependence[c] . f + g_squared[c] . q(f) + heating[c] * dT/dt\n"
    "with u what the group senses, f the specific force (+1 g upwards at rest), both in the axes "
    "of\n"
    "the sensors, and q(a) = (ax ax, ay ay, az az, ax ay, ay az, az ax). Solved for u, it is\n"
    "  u = inverse(sensitivity) (v - bias - the other terms),   u of the tool = axes * u.\n"
    "bias, sensitivity and g_dependence are polynomials in\n"
    "  tau = (T - reference_degc) / half_range_degc:   bias + bias_tau * tau + bias_tau2 * tau^2 "
    "...\n"
    "with T held at the end of min_degc .. max_degc beyond it, where samples are flagged.\n"
    "dT/dt = (T - lagged T) / heating_lag_s.";

ThermometerCalibration ReadThermometer(TomlTable& table) {
  ThermometerCalibration t;
  t.channel = static_cast<int>(
      table.Need("channel", table.FindInteger("channel", 0, RawSample::kTemperaturesMax - 1)));
  table.Read("offset_degc", t.offset);
  table.Read("gain_degc_per_unit", t.gain);
  table.Read("c0_degc", t.c0);
  table.Read("c1", t.c1);
  table.Read("c2_per_degc", t.c2);
  table.Read("knee_degc", t.knee);
  table.Read("min_degc", t.min);
  table.Read("max_degc", t.max);
  return t;
}

std::optional<UtcTime> ReadDate(TomlTable& table, std::string_view key) {
  const auto text = table.FindString(key);
  if (!text) return std::nullopt;
  const auto date = DateOf(*text);
  if (!date) table.Refuse(key, fmt::format("\"{}\" is no date, as \"2026-01-31\"", *text));
  return date;
}

ToolCalibration TakeToolFile(TomlTable& root) {
  ToolCalibration tool;
  root.Read("asset_serial", tool.asset_serial);
  root.Read("sensor_serials", tool.sensor_serials);
  root.Read("note", tool.note);
  tool.calibrated = ReadDate(root, "calibrated");
  tool.expires = ReadDate(root, "expires");
  root.Read("rests_on_prior", tool.rests_on_prior);
  tool.rests_on = root.FindStrings("rests_on").value_or(std::vector<std::string>{});
  for (TomlTable& table : root.FindTables("thermometer")) {
    tool.thermometers.push_back(ReadThermometer(table));
  }
  if (auto table = root.FindTable("gyro")) tool.gyro = ReadGroup(*table, kGyroWords);
  if (auto table = root.FindTable("accel")) tool.accel = ReadGroup(*table, kAccelWords);
  if (auto table = root.FindTable("mag")) tool.mag = ReadGroup(*table, kMagWords);
  if (auto table = root.FindTable("errors")) {
    tool.errors = ReadPriors(*table);
    tool.errors_none = PriorsOfNone(*table, *tool.errors);
  }
  if (const auto complaint = FindComplaint(tool)) root.Refuse("", *complaint);
  return tool;
}

void WriteThermometer(TomlWriter& out, const ThermometerCalibration& t) {
  out.Element("thermometer");
  out.Comment(
      "reads t = offset_degc + gain_degc_per_unit * raw;\n"
      "true T = t + c0_degc + c1 t + c2_per_degc max(0, t - knee_degc)^2, t from min_degc to "
      "max_degc");
  out.Whole("channel", t.channel);
  out.Number("offset_degc", t.offset);
  out.Number("gain_degc_per_unit", t.gain);
  out.Number("c0_degc", t.c0);
  out.Number("c1", t.c1);
  out.Number("c2_per_degc", t.c2);
  out.Number("knee_degc", t.knee);
  out.Number("min_degc", t.min);
  out.Number("max_degc", t.max);
}

void WriteAxes(TomlWriter& out, const SensorGroup& group) {
  static constexpr std::string_view kAxes = "xyz";
  std::vector<std::string> words;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const double e = group.R_TS(i, j);
      if (e == 1 || e == -1) {
        words.push_back(fmt::format("{}{}", e > 0 ? '+' : '-', kAxes[static_cast<std::size_t>(j)]));
      }
    }
  }
  if (words.size() == 3) {
    out.Comment("x, y, z of the tool along these axes of the sensors");
    out.Texts("axes", words);
  } else {
    out.Rows("axes_rows", group.R_TS);
  }
}

void WriteColumn(TomlWriter& out, std::string_view key, const SensorGroup::Column& column, int n) {
  out.Numbers(key, std::span(column.data(), static_cast<std::size_t>(n)));
}

void WritePolynomials(TomlWriter& out, const SensorGroup& group, const GroupWords& words) {
  const int n = group.n_channels;
  for (std::size_t power = 0; power < SensorGroup::kPowers; ++power) {
    const std::string_view tau = kPowerWords[power];
    if (power == 0 || !group.bias[power].isZero(0)) {
      WriteColumn(out, fmt::format("bias{}", tau), group.bias[power], n);
    }
  }
  for (std::size_t power = 0; power < SensorGroup::kPowers; ++power) {
    const std::string_view tau = kPowerWords[power];
    if (power == 0 || !group.sensitivity[power].isZero(0)) {
      out.Rows(fmt::format("sensitivity{}_{}", tau, words.per),
               group.sensitivity[power].topRows(n) * words.unit);
    }
  }
  for (std::size_t power = 0; power < SensorGroup::kPowers; ++power) {
    const std::string_view tau = kPowerWords[power];
    if (!group.g_dependence[power].isZero(0)) {
      out.Rows(fmt::format("g_dependence{}_per_g", tau),
               group.g_dependence[power].topRows(n) * units::kStandardGravity);
    }
  }
}

void WriteTemperature(TomlWriter& out, const SensorGroup& group) {
  if (group.thermometer < 0) return;
  out.Whole("thermometer", group.thermometer);
  out.Number("reference_degc", group.reference);
  out.Number("half_range_degc", group.half_range);
  out.Number("min_degc", group.min);
  out.Number("max_degc", group.max);
  if (group.heating.isZero(0)) return;
  WriteColumn(out, "heating_per_degc_per_s", group.heating, group.n_channels);
  out.Number("heating_lag_s", group.heating_lag);
}

void WriteGroup(TomlWriter& out, const SensorGroup& group, const GroupWords& words) {
  const int n = group.n_channels;
  if (n == 0) return;
  out.Table(words.table);
  out.Comment(fmt::format("u: {}", words.kind));
  out.Wholes("channels", std::span(group.channel).first(static_cast<std::size_t>(n)));
  out.Text("unit", group.unit);
  WriteColumn(out, "unit_per_count", group.unit_per_count, n);
  out.Flag("per_second", group.per_second);
  WriteAxes(out, group);
  WritePolynomials(out, group, words);
  if (!group.second_order.isZero(0)) {
    out.Rows(fmt::format("second_order_{}", words.per_square),
             group.second_order.topRows(n) * (words.unit * words.unit));
  }
  if (!group.g_squared.isZero(0)) {
    out.Rows("g_squared_per_g2",
             group.g_squared.topRows(n) * (units::kStandardGravity * units::kStandardGravity));
  }
  WriteTemperature(out, group);
  if (!group.covariance) return;
  out.Table(fmt::format("{}.covariance", words.table));
  out.Texts("parameters", group.covariance->names);
  out.Rows("rows", group.covariance->cov);
}

}  // namespace

Result<ToolCalibration> ParseTool(std::string_view text, const std::string& source) {
  return ReadTomlText<ToolCalibration>(text, source, formats::kTool, TakeToolFile);
}

Result<ToolCalibration> ReadToolFile(const std::filesystem::path& path) {
  const Result<std::string> text = ReadTextFile(path);
  if (!text) return text.fault();
  return ParseTool(*text, path.string());
}

std::string ToolToml(const ToolCalibration& tool) {
  if (const auto complaint = FindComplaint(tool)) throw std::invalid_argument(*complaint);
  TomlWriter out;
  out.Text("format", formats::kTool);
  out.Comment(kHead);
  if (!tool.asset_serial.empty()) out.Text("asset_serial", tool.asset_serial);
  if (!tool.sensor_serials.empty()) out.Text("sensor_serials", tool.sensor_serials);
  if (!tool.note.empty()) out.Text("note", tool.note);
  if (tool.calibrated) out.Text("calibrated", DateText(*tool.calibrated));
  if (tool.expires) out.Text("expires", DateText(*tool.expires));
  if (tool.rests_on_prior) out.Flag("rests_on_prior", true);
  if (!tool.rests_on.empty()) {
    out.Comment("SHA-256 of the readings it rests on: none of them may count twice");
    out.Texts("rests_on", tool.rests_on);
  }
  for (const ThermometerCalibration& t : tool.thermometers) WriteThermometer(out, t);
  WriteGroup(out, tool.gyro, kGyroWords);
  WriteGroup(out, tool.accel, kAccelWords);
  WriteGroup(out, tool.mag, kMagWords);
  if (tool.errors) {
    out.Table("errors");
    out.Comment("what remains after it, 1-sigma; the job's own [errors] win");
    WritePriors(out, *tool.errors, tool.errors_none);
  }
  return out.text();
}

}  // namespace wellgyro

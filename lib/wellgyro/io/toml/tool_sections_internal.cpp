#include "wellgyro/io/toml/tool_sections_internal.h"

#include <charconv>
#include <chrono>
#include <cstdint>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/io/toml/tool_file.h"

namespace wellgyro {
namespace {

using Rows = std::vector<std::vector<double>>;

std::string KeyOf(std::string_view name, std::size_t power, std::string_view per = {}) {
  return fmt::format("{}{}{}{}", name, kPowerWords[power], per.empty() ? "" : "_", per);
}

void Fill(TomlTable& table, std::string_view key, std::size_t n, SensorGroup::Column& column) {
  const auto numbers = table.FindNumbers(key, kAnyNumber);
  if (!numbers) return;
  if (numbers->size() != n) {
    table.Refuse(key, fmt::format("has {} numbers, one for each of {} channels are needed",
                                  numbers->size(), n));
  }
  for (std::size_t c = 0; c < n; ++c) column[static_cast<Eigen::Index>(c)] = (*numbers)[c];
}

// True where the key is there.
template <class Matrix>
bool Fill(TomlTable& table, std::string_view key, std::size_t n, double unit, Matrix& matrix) {
  const auto rows = table.FindRows(key, static_cast<std::size_t>(matrix.cols()));
  if (!rows) return false;
  if (rows->size() != n) {
    table.Refuse(
        key, fmt::format("has {} rows, one for each of {} channels are needed", rows->size(), n));
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < (*rows)[i].size(); ++j) {
      matrix(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = (*rows)[i][j] / unit;
    }
  }
  return true;
}

void ReadChannels(TomlTable& table, SensorGroup& group) {
  const auto channels =
      table.Need("channels", table.FindNumbers("channels", {.min = 0, .max = 15}));
  if (channels.size() < 2 || channels.size() > 4) {
    table.Refuse("channels", fmt::format("names {} channels, it takes 2 to 4", channels.size()));
  }
  group.n_channels = static_cast<int>(channels.size());
  for (std::size_t c = 0; c < channels.size(); ++c) {
    group.channel[c] = static_cast<int>(channels[c]);
    if (static_cast<double>(group.channel[c]) != channels[c]) {
      table.Refuse("channels", "must be whole numbers, places in raw_batch_t from 0");
    }
  }
}

void ReadAxes(TomlTable& table, SensorGroup& group) {
  const auto words = table.FindStrings("axes");
  const auto rows = table.FindRows("axes_rows", 3);
  if (words && rows) table.Refuse("axes_rows", "stands beside axes; one of them says it all");
  if (words && words->size() != 3) {
    table.Refuse("axes", "must name three axes of the sensors, for x, y and z of the tool");
  }
  if (rows && rows->size() != 3) table.Refuse("axes_rows", "must be three rows of three numbers");
  if (words) {
    const auto R_TS = AxesOf(*words);
    if (!R_TS) {
      table.Refuse("axes",
                   "names no axes at right angles: +x, -x, +y, -y, +z or -z, each axis once");
    }
    group.R_TS = *R_TS;
  }
  for (std::size_t i = 0; rows && i < 3; ++i) {
    group.R_TS.row(static_cast<Eigen::Index>(i)) =
        Eigen::Map<const Eigen::RowVector3d>((*rows)[i].data());
  }
}

void ReadTemperature(TomlTable& table, SensorGroup& group) {
  if (const auto place = table.FindInteger("thermometer", 0, RawSample::kTemperaturesMax - 1)) {
    group.thermometer = static_cast<int>(*place);
  }
  table.Read("reference_degc", group.reference);
  table.Read("half_range_degc", group.half_range, 1, kPositive);
  table.Read("min_degc", group.min);
  table.Read("max_degc", group.max);
  table.Read("heating_lag_s", group.heating_lag, 1, kPositive);
}

std::optional<ParameterCovariance> ReadCovariance(TomlTable& table) {
  auto sub = table.FindTable("covariance");
  if (!sub) return std::nullopt;
  ParameterCovariance known;
  known.names = sub->Need("parameters", sub->FindStrings("parameters"));
  const std::size_t n = known.names.size();
  const Rows rows = sub->Need("rows", sub->FindRows("rows", n));
  if (rows.size() != n) sub->Refuse("rows", fmt::format("must be {} rows of {} numbers", n, n));
  const auto size = static_cast<Eigen::Index>(n);
  known.cov.resize(size, size);
  for (std::size_t i = 0; i < n; ++i) {
    known.cov.row(static_cast<Eigen::Index>(i)) =
        Eigen::Map<const Eigen::RowVectorXd>(rows[i].data(), size);
  }
  return known;
}

}  // namespace

SensorGroup ReadGroup(TomlTable& table, const GroupWords& words) {
  SensorGroup group;
  ReadChannels(table, group);
  const auto n = static_cast<std::size_t>(group.n_channels);
  table.Read("unit", group.unit);
  Fill(table, "unit_per_count", n, group.unit_per_count);
  table.Read("per_second", group.per_second);
  for (std::size_t power = 0; power < SensorGroup::kPowers; ++power) {
    Fill(table, KeyOf("bias", power), n, group.bias[power]);
    const std::string key = KeyOf("sensitivity", power, words.per);
    if (!Fill(table, key, n, words.unit, group.sensitivity[power]) && power == 0) {
      table.RefuseAbsent(key, "is missing");
    }
    Fill(table, KeyOf("g_dependence", power, "per_g"), n, units::kStandardGravity,
         group.g_dependence[power]);
  }
  Fill(table, fmt::format("second_order_{}", words.per_square), n, words.unit * words.unit,
       group.second_order);
  Fill(table, "g_squared_per_g2", n, units::kStandardGravity * units::kStandardGravity,
       group.g_squared);
  Fill(table, "heating_per_degc_per_s", n, group.heating);
  ReadAxes(table, group);
  ReadTemperature(table, group);
  group.covariance = ReadCovariance(table);
  return group;
}

std::optional<Eigen::Matrix3d> AxesOf(const std::vector<std::string>& words) {
  static constexpr std::string_view kAxes = "xyz";
  if (words.size() != 3) return std::nullopt;
  Eigen::Matrix3d R_TS = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < 3; ++i) {
    const std::string& word = words[i];
    if (word.size() != 2 || (word[0] != '+' && word[0] != '-')) return std::nullopt;
    const std::size_t axis = kAxes.find(word[1]);
    if (axis == std::string_view::npos) return std::nullopt;
    R_TS(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(axis)) = word[0] == '+' ? 1 : -1;
  }
  if ((R_TS * R_TS.transpose()).isIdentity()) return R_TS;
  return std::nullopt;
}

std::optional<UtcTime> DateOf(std::string_view text) {
  if (text.size() != 10 || text[4] != '-' || text[7] != '-') return std::nullopt;
  const auto number = [&](std::size_t at, std::size_t length) {
    int value = -1;
    const char* const end = text.data() + at + length;
    const auto [stop, error] = std::from_chars(text.data() + at, end, value);
    return error == std::errc() && stop == end ? value : -1;
  };
  const int month = number(5, 2), day = number(8, 2);
  if (month < 0 || day < 0) return std::nullopt;
  const std::chrono::year_month_day date{std::chrono::year{number(0, 4)},
                                         std::chrono::month{static_cast<unsigned>(month)},
                                         std::chrono::day{static_cast<unsigned>(day)}};
  if (!date.ok()) return std::nullopt;
  const std::int64_t days = std::chrono::sys_days{date}.time_since_epoch().count();
  return UtcTime{days * 86'400 * 1'000'000'000};
}

std::string DateText(UtcTime time) {
  const std::chrono::year_month_day date{std::chrono::floor<std::chrono::days>(
      std::chrono::sys_time<std::chrono::nanoseconds>(std::chrono::nanoseconds(time.ns)))};
  return fmt::format("{:04}-{:02}-{:02}", static_cast<int>(date.year()),
                     static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()));
}

}  // namespace wellgyro

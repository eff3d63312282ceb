#include "wellgyro/io/toml/run_lesson_file.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include <Eigen/Core>
#include <fmt/core.h>

#include "wellgyro/io/formats.h"
#include "wellgyro/io/toml/run_lesson_internal.h"
#include "wellgyro/io/toml/toml_internal.h"
#include "wellgyro/io/toml/tool_file.h"

namespace wellgyro {
namespace {

/// In the order of ErrorSource.
constexpr std::array<std::string_view, kErrorSources> kNames{"gyro_bias_x",
                                                             "gyro_bias_y",
                                                             "mass_unbalance",
                                                             "quadrature",
                                                             "gyro_scale_x",
                                                             "gyro_scale_y",
                                                             "gyro_misalignment_x",
                                                             "gyro_misalignment_y",
                                                             "toolface_offset",
                                                             "time_skew",
                                                             "accel_bias_x",
                                                             "accel_bias_y",
                                                             "accel_bias_z",
                                                             "accel_scale_x",
                                                             "accel_scale_y",
                                                             "accel_scale_z",
                                                             "accel_misalignment_x",
                                                             "accel_misalignment_y",
                                                             "accel_shear",
                                                             "accel_misalignment_zx",
                                                             "accel_misalignment_zy",
                                                             "gyro_bias_z",
                                                             "gyro_scale_z",
                                                             "gyro_misalignment_zx",
                                                             "gyro_misalignment_zy",
                                                             "gyro_shear",
                                                             "mass_unbalance_difference",
                                                             "quadrature_sum",
                                                             "accel_second_order_x_xx",
                                                             "accel_second_order_x_yy",
                                                             "accel_second_order_x_zz",
                                                             "accel_second_order_x_xy",
                                                             "accel_second_order_x_yz",
                                                             "accel_second_order_x_zx",
                                                             "accel_second_order_y_xx",
                                                             "accel_second_order_y_yy",
                                                             "accel_second_order_y_zz",
                                                             "accel_second_order_y_xy",
                                                             "accel_second_order_y_yz",
                                                             "accel_second_order_y_zx",
                                                             "accel_second_order_z_xx",
                                                             "accel_second_order_z_yy",
                                                             "accel_second_order_z_zz",
                                                             "accel_second_order_z_xy",
                                                             "accel_second_order_z_yz",
                                                             "accel_second_order_z_zx"};

std::vector<Eigen::Index> PlacesOf(TomlTable& table) {
  const auto names = table.Need("errors", table.FindStrings("errors"));
  std::vector<Eigen::Index> places;
  for (const std::string& name : names) {
    const auto found = std::find(kNames.begin(), kNames.end(), name);
    if (found == kNames.end()) table.Refuse("errors", fmt::format("{} is no error", name));
    places.push_back(found - kNames.begin());
  }
  return places;
}

std::vector<double> NumbersOf(TomlTable& table, std::string_view key, std::size_t n) {
  auto numbers = table.Need(key, table.FindNumbers(key, kAnyNumber));
  if (numbers.size() != n) table.Refuse(key, fmt::format("must be {} numbers", n));
  return numbers;
}

void ReadCov(TomlTable& table, std::string_view key, const std::vector<Eigen::Index>& places,
             ErrorMatrix& cov) {
  const auto rows = table.Need(key, table.FindRows(key, places.size()));
  if (rows.size() != places.size()) {
    table.Refuse(key, fmt::format("must be {0} rows of {0} numbers", places.size()));
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::size_t j = 0; j < rows.size(); ++j) cov(places[i], places[j]) = rows[i][j];
    if (!(rows[i][i] > 0)) table.Refuse(key, "has a variance that is not positive");
  }
}

RunLesson LessonOf(TomlTable& table) {
  RunLesson lesson;
  const std::vector<Eigen::Index> places = PlacesOf(table);
  const std::vector<double> found = NumbersOf(table, "found", places.size());
  for (std::size_t i = 0; i < places.size(); ++i) lesson.errors[places[i]] = found[i];
  ReadCov(table, "cov_before", places, lesson.cov_before);
  ReadCov(table, "cov", places, lesson.cov);
  const auto shares = table.Need("share", table.FindNumbers("share", kPositive));
  const auto temperatures = NumbersOf(table, "temperature_degc", shares.size());
  const auto heating = NumbersOf(table, "heating_degc_per_s", shares.size());
  const auto force = NumbersOf(table, "axial_force_mps2", shares.size());
  for (std::size_t i = 0; i < shares.size(); ++i) {
    lesson.uses.push_back({shares[i], temperatures[i], heating[i], force[i]});
  }
  return lesson;
}

std::string Failed(TomlTable& run) { return run.FindString("verdict").value_or("fail"); }

/// Of a run that stands.
std::optional<RunLesson> LessonOfRun(TomlTable& run) {
  auto fit = run.FindTable("fit");
  if (!fit || Failed(run) == "fail") return std::nullopt;
  if (!fit->FindBool("converged").value_or(false) || fit->FindBool("ambiguous").value_or(true)) {
    return std::nullopt;
  }
  auto table = fit->FindTable("lesson");
  if (!table) return std::nullopt;
  return LessonOf(*table);
}

RunLessons LessonsOf(TomlTable& root, const std::string& source) {
  RunLessons all;
  bool has_tool = false;
  for (TomlTable& input : root.FindTables("input")) {
    if (input.FindString("role").value_or("") != "tool") continue;
    auto tool = ParseTool(input.Need("text", input.FindString("text")), source + ": its tool file");
    if (!tool) throw TomlError{tool.fault()};
    all.tool = *std::move(tool);
    all.tool_sha256 = input.FindString("sha256").value_or("");
    has_tool = true;
  }
  if (!has_tool) root.Refuse("", "the job had no tool file: nothing can be learnt of it");
  for (TomlTable& channel : root.FindTables("channel")) {
    const std::string type = channel.FindString("type").value_or("");
    if (type != "raw_batch_t" && type != "imu_batch_t") continue;
    if (auto sha256 = channel.FindString("sha256")) all.readings.push_back(*std::move(sha256));
  }
  for (TomlTable& run : root.FindTables("run")) {
    if (auto lesson = LessonOfRun(run)) all.lessons.push_back(*std::move(lesson));
  }
  if (all.lessons.empty()) {
    root.Refuse("",
                "no run of it tells anything of the tool's errors: a run must pass or warn, and "
                "its tool file must have the covariance that calibrate tool writes");
  }
  return all;
}

}  // namespace

Result<RunLessons> ParseRunLessons(std::string_view text, const std::string& source) {
  try {
    TomlDocument document(text, source, formats::kRun);
    TomlTable root(document);
    return LessonsOf(root, source);
  } catch (const TomlError& error) {
    return error.fault;
  }
}

void WriteRunLesson(TomlWriter& toml, const RunLesson& lesson) {
  std::vector<Eigen::Index> places;
  std::vector<std::string> names;
  std::vector<double> found, share, temperature, heating, force;
  for (Eigen::Index i = 0; i < kErrorSources; ++i) {
    if (!(lesson.cov_before(i, i) > 0)) continue;
    places.push_back(i);
    names.emplace_back(kNames[static_cast<std::size_t>(i)]);
    found.push_back(lesson.errors[i]);
  }
  for (const ToolUse& use : lesson.uses) {
    share.push_back(use.share);
    temperature.push_back(use.temperature);
    heating.push_back(use.heating);
    force.push_back(use.axial_force);
  }
  toml.Table("run.fit.lesson");
  toml.Comment("the tool's constant errors in SI units, as its calibration left them and as found");
  toml.Texts("errors", names);
  toml.Numbers("found", found);
  toml.Rows("cov_before", lesson.cov_before(places, places));
  toml.Rows("cov", lesson.cov(places, places));
  toml.Numbers("share", share);
  toml.Numbers("temperature_degc", temperature);
  toml.Numbers("heating_degc_per_s", heating);
  toml.Numbers("axial_force_mps2", force);
}

}  // namespace wellgyro

#include "wellgyro/io/toml/plan_file.h"

#include <cmath>

#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/formats.h"
#include "wellgyro/io/toml/toml_internal.h"
#include "wellgyro/io/toml/toml_writer_internal.h"

namespace wellgyro {
namespace {

namespace range = plan_range;

constexpr double kRpm = kTwoPi / 60;                                         // [rad/s]
constexpr TomlRange kSpeed{.min = range::kSlowest, .max = range::kFastest};  // [m/s]
constexpr TomlRange kDepth{.min = 0, .max = range::kWayMost};                // [m]

/// Without the last digits that a unit's conversion leaves.
double Tidy(double value, double digits = 1e6) { return std::round(value * digits) / digits; }

void WriteWay(TomlWriter& toml, const PlannedWay& way) {
  toml.Table("run");
  toml.Number("begin_md_m", Tidy(way.begin_md));
  toml.Number("end_md_m", Tidy(way.end_md));
  toml.Number("speed_in_mps", Tidy(way.speed_in));
  toml.Number("speed_out_mps", Tidy(way.speed_out));
  toml.Number("roll_rpm", Tidy(way.roll_rate / kRpm));
  if (way.roll_rate == 0) {
    toml.Number("swing_deg", Tidy(ToDegrees(way.swing)));
    toml.Number("swing_period_s", Tidy(way.swing_period));
  }
  toml.Number("start_toolface_deg", Tidy(ToDegrees(way.toolface)));
}

void WriteLimits(TomlWriter& toml, const PlanLimits& limits) {
  toml.Table("limits");
  toml.Number("ellipse_m", limits.ellipse);
  if (limits.hidden) toml.Number("hidden_m", *limits.hidden);
  toml.Number("least_stop_s", limits.least_stop);
  toml.Number("longest_stop_s", limits.longest_stop);
  toml.Number("overhead_s", limits.overhead);
  toml.Flag("toolfaces", limits.turns);
}

void WritePath(TomlWriter& toml, const Trajectory& well) {
  toml.Table("path");
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(well.size()), 3);
  for (std::size_t i = 0; i < well.size(); ++i) {
    const TrajectoryPoint p = well.station(i);
    rows.row(static_cast<Eigen::Index>(i)) << Tidy(p.md), Tidy(ToDegrees(p.inclination)),
        Tidy(ToDegrees(p.azimuth));
  }
  toml.Rows("stations", rows);
}

void WriteEnd(TomlWriter& toml, std::string_view name, const ExpectedEnd& end) {
  toml.Table(name);
  toml.Number("ellipse_major_m", Tidy(end.semi_major, 1e3));
  toml.Number("ellipse_minor_m", Tidy(end.semi_minor, 1e3));
  toml.Number("ellipse_azimuth_deg", Tidy(ToDegrees(end.azimuth_major), 1e2));
  toml.Number("sigma_tvd_m", Tidy(std::sqrt(std::max(0.0, end.cov_p_WT_W(2, 2))), 1e3));
  toml.Number("sigma_azimuth_deg", Tidy(ToDegrees(end.sigma_azimuth), 1e4));
  if (!end.hidden_cause.empty()) {
    toml.Number("hidden_m", Tidy(end.hidden, 1e3));
    toml.Text("hidden_cause", end.hidden_cause);
  }
  toml.Number("run_h", Tidy(end.seconds / units::kHour, 1e3));
}

void WriteStops(TomlWriter& toml, const StopPlan& plan) {
  for (std::size_t i = 0; i < plan.stops.size(); ++i) {
    const PlannedStop& stop = plan.stops[i];
    toml.Element("stop");
    toml.Text("pass", stop.out ? "out" : "in");
    toml.Number("md_m", Tidy(stop.md, 1e2));
    toml.Number("stop_s", Tidy(stop.seconds));
    if (stop.toolface) toml.Number("toolface_deg", Tidy(ToDegrees(*stop.toolface), 1e1));
    toml.Number("ellipse_without_m", Tidy(plan.worth[i].ellipse_without, 1e3));
    toml.Number("hidden_without_m", Tidy(plan.worth[i].hidden_without, 1e3));
  }
}

void WriteHidden(TomlWriter& toml, const ExpectedEnd& end) {
  for (const RunReliability& fault : end.reliability) {
    toml.Element("hidden");
    toml.Text("cause", fault.code);
    if (fault.smallest) toml.Number("noticed_from", Tidy(*fault.smallest, 1e9));
    toml.Text("unit", fault.unit);
    if (fault.md) toml.Number("md_m", Tidy(*fault.md, 1e2));
    toml.Number("shift_north_m", Tidy(fault.shift_W.x(), 1e3));
    toml.Number("shift_east_m", Tidy(fault.shift_W.y(), 1e3));
  }
}

PlannedWay ReadWay(TomlTable table) {
  PlannedWay way;
  way.begin_md = table.Need("begin_md_m", table.FindNumber("begin_md_m", kDepth));
  way.end_md = table.Need("end_md_m", table.FindNumber("end_md_m", kDepth));
  if (!(way.end_md > way.begin_md)) table.Refuse("end_md_m", "must be below begin_md_m");
  table.Read("speed_in_mps", way.speed_in, 1, kSpeed);
  if (const auto out = table.FindNumber("speed_out_mps", kNotNegative)) {
    if (*out != 0 && (*out < kSpeed.min || *out > kSpeed.max)) {
      table.Refuse("speed_out_mps",
                   fmt::format("must be {:g} to {:g}, or 0 where the way up is not surveyed",
                               kSpeed.min, kSpeed.max));
    }
    way.speed_out = *out;
  }
  table.Read("roll_rpm", way.roll_rate, kRpm,
             {.min = -range::kRollMostRpm, .max = range::kRollMostRpm});
  table.Read("swing_deg", way.swing, units::kDeg,
             {.min = -range::kSwingMostDeg, .max = range::kSwingMostDeg});
  table.Read("swing_period_s", way.swing_period, 1, {.min = range::kSwingPeriodLeast, .max = 1e6});
  table.Read("start_toolface_deg", way.toolface, units::kDeg, kAzimuthDeg);
  return way;
}

PlanLimits ReadLimits(TomlTable table) {
  constexpr TomlRange kStop{.min = range::kStopLeast, .max = range::kStopMost};  // [s]
  PlanLimits limits{.ellipse = 0};
  table.Read("ellipse_m", limits.ellipse, 1, {.min = 1e-3, .max = 1e4});
  limits.hidden = table.FindNumber("hidden_m", {.min = 1e-3, .max = 1e5});
  table.Read("least_stop_s", limits.least_stop, 1, kStop);
  table.Read("longest_stop_s", limits.longest_stop, 1, kStop);
  table.Read("overhead_s", limits.overhead, 1, {.min = 0, .max = range::kStopMost});
  table.Read("toolfaces", limits.turns);
  if (limits.longest_stop < limits.least_stop) {
    table.Refuse("longest_stop_s", "must not be below least_stop_s");
  }
  return limits;
}

std::vector<WellPoint> ReadPath(TomlTable table, const PlannedWay& way) {
  std::vector<WellPoint> path;
  for (const auto& row : table.Need("stations", table.FindRows("stations", 3))) {
    path.push_back({row[0], row[1] * units::kDeg, row[2] * units::kDeg});
    const bool follows = path.size() < 2 || path[path.size() - 2].md < row[0];
    const bool inclined = row[1] >= 0 && row[1] <= 180;
    if (!follows || !inclined || !std::isfinite(row[0] + row[1] + row[2])) {
      table.Refuse("stations", "must be MD that increases, inclination of 0 to 180, azimuth");
    }
  }
  const bool holds = path.size() >= 2 && path.front().md <= way.begin_md + 0.01 &&
                     path.back().md >= way.end_md - 0.01;
  if (!holds) table.Refuse("stations", "must reach from begin_md_m to end_md_m of [run]");
  return path;
}

PlannedStop ReadStop(TomlTable& table, const PlannedWay& way, const PlannedStop* before) {
  PlannedStop stop;
  stop.out = table.Need("pass", table.FindWord<bool>("pass", {{"in", false}, {"out", true}}));
  stop.md = table.Need("md_m", table.FindNumber("md_m", kDepth));
  stop.seconds =
      table.Need("stop_s", table.FindNumber("stop_s", {.min = 1, .max = range::kStandMost}));
  if (const auto toolface = table.FindNumber("toolface_deg", kAzimuthDeg)) {
    stop.toolface = *toolface * units::kDeg;
  }
  table.FindNumber("ellipse_without_m", kNotNegative);
  table.FindNumber("hidden_without_m", kNotNegative);
  if (stop.md < way.begin_md - 0.01 || stop.md > way.end_md + 0.01) {
    table.Refuse("md_m", "is not on the way of [run]");
  }
  if (stop.out && way.speed_out == 0) table.Refuse("pass", "is out, and speed_out_mps is 0");
  const bool follows =
      before == nullptr || (stop.out && !before->out) ||
      (stop.out == before->out && (stop.out ? stop.md < before->md : stop.md > before->md));
  if (!follows) table.Refuse("md_m", "does not follow the stop before it on the way");
  return stop;
}

PlanFile ReadPlan(TomlTable& root) {
  PlanFile file;
  file.limits.ellipse = 0;
  if (const auto table = root.FindTable("limits")) file.limits = ReadLimits(*table);
  file.way = ReadWay(root.Need("run", root.FindTable("run")));
  if (const auto table = root.FindTable("path")) file.path = ReadPath(*table, file.way);
  for (TomlTable& table : root.FindTables("stop")) {
    file.stops.push_back(
        ReadStop(table, file.way, file.stops.empty() ? nullptr : &file.stops.back()));
  }
  // What the plan promises is not what a run is made by.
  root.FindBool("feasible");
  root.FindString("why_not");
  root.FindString("well");
  root.FindNumber("latitude_deg", kLatitudeDeg);
  for (const char* name :
       {"time", "expected", "without_stops", "best_possible", "practice", "worse_tool"}) {
    if (auto table = root.FindTable(name)) table->Verbatim();
  }
  for (const char* name : {"hidden", "warning", "input"}) {
    for (TomlTable& table : root.FindTables(name)) table.Verbatim();
  }
  return file;
}

}  // namespace

std::string PlanToml(const PlanReport& report) {
  const StopPlan& plan = report.plan;
  TomlWriter toml;
  toml.Text("format", formats::kPlan);
  toml.Flag("feasible", plan.feasible);
  if (!plan.feasible) toml.Text("why_not", plan.why_not);
  toml.Text("well", report.well);
  toml.Number("latitude_deg", Tidy(ToDegrees(report.c.site.latitude)));
  WriteLimits(toml, report.limits);
  WriteWay(toml, report.c.way);
  WritePath(toml, report.c.well);
  toml.Table("time");
  toml.Number("at_rest_s", Tidy(plan.at_rest));
  toml.Number("with_overhead_s", Tidy(plan.cost));
  if (plan.least_at_rest) toml.Number("bound_at_rest_s", Tidy(*plan.least_at_rest, 1e1));
  if (plan.least_cost) toml.Number("bound_with_overhead_s", Tidy(*plan.least_cost, 1e1));
  WriteStops(toml, plan);
  if (!plan.stops.empty()) WriteEnd(toml, "expected", plan.expected);
  WriteEnd(toml, "without_stops", plan.without);
  toml.Table("best_possible");
  toml.Number("ellipse_major_m", Tidy(plan.best_possible.ellipse, 1e3));
  if (report.practice) WriteEnd(toml, "practice", *report.practice);
  if (report.worse) WriteEnd(toml, "worse_tool", *report.worse);
  WriteHidden(toml, plan.stops.empty() ? plan.without : plan.expected);
  for (const std::string& text : report.warnings) {
    toml.Element("warning");
    toml.Text("text", text);
  }
  WriteInputs(toml, report.inputs);
  return toml.text();
}

Result<PlanFile> ParsePlanFile(std::string_view text, const std::string& source) {
  return ReadTomlText<PlanFile>(text, source, formats::kPlan,
                                [](TomlTable& root) { return ReadPlan(root); });
}

Result<PlanFile> ReadPlanFile(const std::filesystem::path& path) {
  const Result<std::string> text = ReadTextFile(path);
  if (!text) return text.fault();
  return ParsePlanFile(*text, path.string());
}

}  // namespace wellgyro

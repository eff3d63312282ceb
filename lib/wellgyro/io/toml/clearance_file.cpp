#include "wellgyro/io/toml/clearance_file.h"

#include <algorithm>
#include <limits>

#include "wellgyro/io/formats.h"
#include "wellgyro/io/text_file.h"
#include "wellgyro/io/toml/toml_internal.h"

namespace wellgyro {
namespace {

constexpr TomlRange kRadius{.min = 0, .max = 10};  // [m]: conductors have half a metre
constexpr double kAllTheWay = std::numeric_limits<double>::max();

std::vector<HoleSection> ReadHole(TomlTable& table, std::string_view key) {
  std::vector<HoleSection> sections;
  if (!table.Has(key)) return sections;
  if (table.Depth(key) == 0) {
    sections.push_back({kAllTheWay, *table.FindNumber(key, kRadius)});
    return sections;
  }
  const auto rows = table.FindRows(key, 2);
  for (const std::vector<double>& row : *rows) {
    if (!(row[1] >= kRadius.min && row[1] <= kRadius.max) ||
        (!sections.empty() && row[0] <= sections.back().end_md)) {
      table.Refuse(key, "must be rows of [MD in m, radius in m], MD increasing, radii up to 10");
    }
    sections.push_back({row[0], row[1]});
  }
  if (sections.empty()) table.Refuse(key, "has no row");
  return sections;
}

void ReadRule(TomlTable& table, ClearancePolicy& policy) {
  SeparationRule& rule = policy.rule;
  table.Read("k", rule.k, 1, kPositive);
  table.Read("sigma_pa_m", rule.sigma_ahead, 1, kNotNegative);
  table.Read("surface_margin_m", rule.surface_margin, 1, kNotNegative);
  if (const auto word =
          table.FindWord<Correlation>("correlation", {{"none", Correlation::kNone},
                                                      {"global", Correlation::kGlobal},
                                                      {"full", Correlation::kFull}})) {
    rule.correlation = *word;
  }
  if (const auto word = table.FindWord<ErrorSurface>(
          "surface", {{"pedal", ErrorSurface::kPedal}, {"ellipsoid", ErrorSurface::kEllipsoid}})) {
    rule.surface = *word;
  }
  if (const auto word =
          table.FindWord<Scan>("scan", {{"nearest", Scan::kNearest},
                                        {"horizontal", Scan::kHorizontal},
                                        {"travelling-cylinder", Scan::kTravellingCylinder}})) {
    rule.scan = *word;
  }
  if (const auto word = table.FindWord<TieOn>(
          "tie_on", {{"model", TieOn::kModel}, {"half", TieOn::kHalf}, {"whole", TieOn::kWhole}})) {
    policy.tie_on = *word;
  }
}

void ReadLimits(TomlTable& table, ClearancePolicy& policy) {
  table.Read("stop", policy.stop, 1, kPositive);
  table.Read("alert", policy.alert, 1, kPositive);
  table.Read("report", policy.report, 1, kPositive);
  if (policy.alert < policy.stop) table.Refuse("alert", "must not be below stop");
  if (policy.report < policy.alert) table.Refuse("report", "must not be below alert");
}

ClearanceWell ReadWell(TomlTable& table, bool reference) {
  ClearanceWell well;
  table.Read("survey", well.survey);
  table.Read("model", well.model);
  table.Read("program", well.program);
  if (well.survey.empty() == well.program.empty()) {
    table.Refuse("", "needs a survey or a program, and not both");
  }
  if (!well.program.empty() && !well.model.empty()) {
    table.Refuse("model", "a program names its models itself");
  }
  const std::filesystem::path file(well.survey.empty() ? well.program : well.survey);
  well.name = table.FindString("name").value_or(file.stem().string());
  const auto north = table.FindNumber("north_m", kAnyNumber);
  const auto east = table.FindNumber("east_m", kAnyNumber);
  const auto tvd = table.FindNumber("tvd_m", kAnyNumber);
  if (north || east || tvd) {
    if (!north || !east || !tvd) table.Refuse("", "a place needs north_m, east_m and tvd_m");
    well.start_W = Eigen::Vector3d(*north, *east, *tvd);
  }
  if (!reference) {
    well.kick_off = table.FindNumber("kick_off_md_m", kNotNegative);
    well.judged_from = table.FindNumber("judged_from_md_m", kNotNegative);
    if (well.judged_from && (!well.kick_off || *well.judged_from < *well.kick_off)) {
      table.Refuse("judged_from_md_m", "belongs to a kick_off_md_m, and not above it");
    }
  }
  well.hole = ReadHole(table, "hole_radius_m");
  return well;
}

ClearancePolicy TakeClearance(TomlTable& root) {
  ClearancePolicy policy;
  if (auto table = root.FindTable("rule")) ReadRule(*table, policy);
  if (auto table = root.FindTable("limits")) ReadLimits(*table, policy);
  if (auto table = root.FindTable("hole")) {
    policy.reference_hole = ReadHole(*table, "reference_radius_m");
    policy.offset_hole = ReadHole(*table, "offset_radius_m");
  }
  if (auto table = root.FindTable("reference")) policy.reference = ReadWell(*table, true);
  for (TomlTable& table : root.FindTables("offset")) {
    ClearanceWell well = ReadWell(table, false);
    if (std::ranges::find(policy.offsets, well.name, &ClearanceWell::name) !=
        policy.offsets.end()) {
      table.Refuse("name", "stands twice");
    }
    policy.offsets.push_back(std::move(well));
  }
  return policy;
}

}  // namespace

Result<ClearancePolicy> ReadClearancePolicy(const std::filesystem::path& path) {
  const Result<std::string> text = ReadTextFile(path);
  if (!text) return text.fault();
  return ReadTomlText<ClearancePolicy>(*text, path.string(), formats::kClearance, TakeClearance);
}

}  // namespace wellgyro

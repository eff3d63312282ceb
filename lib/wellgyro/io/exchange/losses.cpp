#include "wellgyro/io/exchange/losses.h"

#include <algorithm>
#include <array>
#include <span>
#include <string_view>

#include <fmt/core.h>

#include "wellgyro/io/exchange/las_internal.h"
#include "wellgyro/io/exchange/p717_internal.h"
#include "wellgyro/io/exchange/table_build_internal.h"
#include "wellgyro/io/exchange/witsml_text_internal.h"
#include "wellgyro/io/text_internal.h"

namespace wellgyro {
namespace {

using C = Column;

constexpr std::array kReportColumns{C::kMd,       C::kInclination, C::kAzimuth,         C::kTvd,
                                    C::kNorth,    C::kEast,        C::kVerticalSection, C::kDogleg,
                                    C::kBuild,    C::kTurn,        C::kNorthing,        C::kEasting,
                                    C::kTvdSubSea};
constexpr std::array kPetrelColumns{C::kMd,   C::kInclination, C::kAzimuth,  C::kTvd,     C::kNorth,
                                    C::kEast, C::kDogleg,      C::kNorthing, C::kEasting, C::kDown};
constexpr std::array kOsduColumns{C::kMd,    C::kInclination, C::kAzimuth, C::kTvd,
                                  C::kNorth, C::kEast,        C::kDogleg};

constexpr std::array kMapColumns{C::kMd,    C::kInclination, C::kAzimuth,  C::kTvd,
                                 C::kNorth, C::kEast,        C::kLatitude, C::kLongitude,
                                 C::kVarNN, C::kCovNE,       C::kVarEE};

constexpr std::array<std::string_view, 20> kReportKeys{"well",
                                                       "wellbore",
                                                       "field",
                                                       "structure",
                                                       "survey",
                                                       "rig",
                                                       "operator",
                                                       "contractor",
                                                       "begin",
                                                       "created",
                                                       "north_reference",
                                                       "grid_convergence_deg",
                                                       "declination_deg",
                                                       "datum",
                                                       "datum_elevation_m",
                                                       "vertical_reference",
                                                       "crs",
                                                       "method",
                                                       "section_azimuth_deg",
                                                       "tool"};
constexpr std::array<std::string_view, 6> kPetrelKeys{
    "well", "survey", "north_reference", "datum", "datum_elevation_m", "crs"};
constexpr std::array<std::string_view, 9> kOsduKeys{
    "survey",     "wellbore",          "north_reference", "grid_convergence_deg",
    "datum",      "datum_elevation_m", "grid_scale",      "method",
    "error_model"};
constexpr std::array<std::string_view, 25> kP717Keys{"well",
                                                     "uwi",
                                                     "wellbore",
                                                     "uwi_wellbore",
                                                     "field",
                                                     "region",
                                                     "country",
                                                     "structure",
                                                     "rig",
                                                     "survey",
                                                     "operator",
                                                     "contractor",
                                                     "job",
                                                     "begin",
                                                     "end",
                                                     "north_reference",
                                                     "grid_convergence_deg",
                                                     "declination_deg",
                                                     "declination_source",
                                                     "declination_date",
                                                     "datum",
                                                     "vertical_reference",
                                                     "crs",
                                                     "datum_elevation_m",
                                                     "grid_scale"};

template <class Range, class Value>
bool Holds(const Range& range, const Value& value) {
  return std::find(std::begin(range), std::end(range), value) != std::end(range);
}

bool IsWitsml(SurveyFormat format) {
  return format == SurveyFormat::kWitsml1411 || format == SurveyFormat::kWitsml21;
}

bool IsMap(SurveyFormat format) {
  return format == SurveyFormat::kGeoJson || format == SurveyFormat::kKml ||
         format == SurveyFormat::kGeoPackage;
}

bool HoldsColumn(SurveyFormat format, Column column) {
  switch (format) {
    case SurveyFormat::kCompass:
      return Holds(kReportColumns, column);
    case SurveyFormat::kPetrel:
      return Holds(kPetrelColumns, column);
    case SurveyFormat::kOsdu:
      return Holds(kOsduColumns, column) || (column >= C::kVarNN && column <= C::kVarVV);
    case SurveyFormat::kGeoJson:
    case SurveyFormat::kKml:
    case SurveyFormat::kGeoPackage:
      return Holds(kMapColumns, column);
    case SurveyFormat::kP717: {
      const bool own = column <= C::kLongitude || column == C::kSurvey || column == C::kObject;
      return own || std::any_of(p717::Extensions().begin(), p717::Extensions().end(),
                                [&](const auto& e) { return e.column == column; });
    }
    default:
      return true;
  }
}

bool HoldsText(SurveyFormat format, TextColumn column) {
  if (format == SurveyFormat::kCsv || IsWitsml(format)) return true;
  if (IsMap(format)) return column == TextColumn::kQuality;
  if (format != SurveyFormat::kP717) return false;
  return column == TextColumn::kPoint || column == TextColumn::kErrorModel ||
         std::any_of(p717::Extensions().begin(), p717::Extensions().end(),
                     [&](const auto& e) { return e.text == column; });
}

bool HoldsKey(SurveyFormat format, std::string_view key, const WriteOptions& options) {
  switch (format) {
    case SurveyFormat::kCsv:
      return options.preamble || key == "north_reference";
    case SurveyFormat::kLas:
      return key == "remark" ||
             std::any_of(las::kParameters.begin(), las::kParameters.end(),
                         [&](const auto& p) { return p.key == key; }) ||
             Holds(
                 std::array<std::string_view, 9>{"operator", "well", "field", "structure", "region",
                                                 "country", "contractor", "begin", "uwi"},
                 key);
    case SurveyFormat::kCompass:
      return Holds(kReportKeys, key) || key == "error_model" || key == "remark";
    case SurveyFormat::kPetrel:
      return Holds(kPetrelKeys, key) || key == "vertical_reference" || key == "remark";
    case SurveyFormat::kOsdu:
      return Holds(kOsduKeys, key) || key == "section_azimuth_deg";
    case SurveyFormat::kP717:
      return Holds(kP717Keys, key) || key == "remark" || key == "method" || key == "error_model" ||
             key == "depth_kind" || key == "created";
    default:
      return true;
  }
}

bool HoldsStatus(SurveyFormat format, RowStatus status) {
  if (status == RowStatus::kSurveyed) return true;
  return format == SurveyFormat::kCsv || format == SurveyFormat::kP717 || IsWitsml(format);
}

void Add(std::vector<std::string>& losses, std::string_view what, const std::string& names) {
  if (!names.empty()) losses.push_back(fmt::format("{}: {}", what, names));
}

// Names longer than WITSML's, which stay whole in extensions.
void AddCuts(const SurveyTable& table, SurveyFormat format, std::vector<std::string>& losses) {
  const SurveyIdentity& names = table.head.names;
  if (format != SurveyFormat::kWitsml1411) return;
  for (const auto& [name, text] :
       {std::pair<std::string_view, const std::string&>{"well", names.well},
        {"wellbore", names.wellbore},
        {"survey", names.survey},
        {"contractor", names.contractor}}) {
    if (witsml::Cut(text, witsml::kNameLength) != text) {
      losses.push_back(
          fmt::format("the {}'s name is cut to {} characters in its element, whole in "
                      "an extension",
                      name, witsml::kNameLength));
    }
  }
}

std::string ColumnsLost(const SurveyTable& table, SurveyFormat format) {
  std::string names;
  for (const ColumnInfo& info : AllColumns()) {
    if (!table.Has(info.column) || HoldsColumn(format, info.column)) continue;
    names += (names.empty() ? "" : ", ") + std::string(info.csv);
  }
  for (const TextColumnInfo& info : AllTextColumns()) {
    if (!table.Has(info.column) || HoldsText(format, info.column)) continue;
    names += (names.empty() ? "" : ", ") + std::string(info.csv);
  }
  return names;
}

}  // namespace

std::vector<std::string> LossesOf(const SurveyTable& table, SurveyFormat format,
                                  const WriteOptions& options) {
  std::vector<std::string> losses;
  Add(losses, "columns not held", ColumnsLost(table, format));
  std::string keys, last;
  for (const auto& [key, value] : PairsOf(table.head)) {
    if (HoldsKey(format, key, options) || key == last) continue;
    keys += (keys.empty() ? "" : ", ") + key;
    last = key;
  }
  Add(losses, "facts not held", keys);
  std::size_t statuses = 0;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    statuses += HoldsStatus(format, table.status(row)) ? 0 : 1;
  }
  if (statuses > 0) losses.push_back(fmt::format("the status of {} stations", statuses));
  const SurveyHead& head = table.head;
  if (format != SurveyFormat::kP717) {
    if (!head.gyro_raw.empty()) {
      losses.push_back(fmt::format("{} records of raw gyro data", head.gyro_raw.size()));
    }
    if (head.runs.size() > 1) losses.push_back(fmt::format("{} surveys as one", head.runs.size()));
    if (!head.objects.empty()) {
      losses.push_back(fmt::format("{} positions of structures and wells", head.objects.size()));
    }
  }
  AddCuts(table, format, losses);
  return losses;
}

}  // namespace wellgyro

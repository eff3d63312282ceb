// Text reports in the manner of Landmark Compass: a head of "Key: value" lines, a table under two
// lines of names and units. There is no published specification; reading goes by the table reader.
#include <algorithm>
#include <array>

#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/exchange/survey_words_internal.h"
#include "wellgyro/io/exchange/table_build_internal.h"
#include "wellgyro/io/text_internal.h"

namespace wellgyro {
namespace {

struct NameKey {
  std::string_view key;
  std::string SurveyIdentity::*member;
};
constexpr std::array kNames{
    NameKey{"Company", &SurveyIdentity::operator_name},
    NameKey{"Project", &SurveyIdentity::field},
    NameKey{"Site", &SurveyIdentity::structure},
    NameKey{"Well", &SurveyIdentity::well},
    NameKey{"Wellbore", &SurveyIdentity::wellbore},
    NameKey{"Survey", &SurveyIdentity::survey},
    NameKey{"Rig", &SurveyIdentity::rig},
    NameKey{"Survey Company", &SurveyIdentity::contractor},
    NameKey{"Survey Date", &SurveyIdentity::begin},
    NameKey{"Date", &SurveyIdentity::created},
};

constexpr std::array kTable{
    NamedColumn{"MD", Column::kMd},
    NamedColumn{"Inc", Column::kInclination},
    NamedColumn{"Azi", Column::kAzimuth},
    NamedColumn{"TVD", Column::kTvd},
    NamedColumn{"+N/-S", Column::kNorth},
    NamedColumn{"+E/-W", Column::kEast},
    NamedColumn{"V.Sec", Column::kVerticalSection},
    NamedColumn{"DLeg", Column::kDogleg},
    NamedColumn{"Build", Column::kBuild},
    NamedColumn{"Turn", Column::kTurn},
    NamedColumn{"Northing", Column::kNorthing},
    NamedColumn{"Easting", Column::kEasting},
    NamedColumn{"TVDSS", Column::kTvdSubSea},
};

std::optional<double> Degrees(std::string_view value) {
  const auto number = NumberOf(value.substr(0, value.find(' ')));
  if (!number) return std::nullopt;
  return *number * units::kDeg;
}

// "RT @ 25m above MSL".
void TakeDatum(SurveyHead& head, std::string_view value) {
  const std::size_t at = value.find(" @ ");
  head.datum = Trim(value.substr(0, at));
  if (at == std::string_view::npos) return;
  std::string_view rest = value.substr(at + 3);
  const std::size_t letters = std::min(rest.find_first_not_of("+-0123456789.e"), rest.size());
  const auto number = NumberOf(rest.substr(0, letters));
  std::string_view unit = rest.substr(letters);
  const std::size_t above = unit.find(" above ");
  if (above != std::string_view::npos) head.vertical_reference = Trim(unit.substr(above + 7));
  const auto length = LengthUnitOf(unit.substr(0, std::min(unit.find(' '), unit.size())));
  if (number && length) head.datum_elevation = *number * FactorOf(*length);
}

// What TakeDatum takes.
std::string DatumText(const SurveyHead& head) {
  std::string datum = head.datum.empty() ? "Unknown" : head.datum;
  if (head.datum_elevation) {
    datum += fmt::format(" @ {}{} above {}", Exact(*head.datum_elevation, FactorOf(head.md_unit)),
                         WordOf(head.md_unit),
                         head.vertical_reference.empty() ? "MSL" : head.vertical_reference);
  }
  return datum;
}

std::string HeadText(const SurveyHead& head) {
  std::string text = "Survey Report\n\n";
  const auto line = [&](std::string_view key, std::string_view value) {
    if (!value.empty()) text += fmt::format("{:<28}{}\n", fmt::format("{}:", key), value);
  };
  const auto degrees = [&](std::string_view key, const std::optional<double>& value) {
    if (value) line(key, Exact(*value, units::kDeg) + " deg");
  };
  for (const NameKey& n : kNames) line(n.key, head.names.*n.member);
  line("North Reference", Capital(WordOf(head.azimuth.north)));
  if (head.offsets != North::kUnknown) line("Offset Reference", Capital(WordOf(head.offsets)));
  line("MD Reference", DatumText(head));
  line("TVD Reference", DatumText(head));
  line("Survey Calculation Method", head.method);
  degrees("Grid Convergence", head.azimuth.convergence);
  degrees("Magnetic Declination", head.azimuth.declination);
  degrees("Vertical Section Azimuth", head.section_azimuth);
  line("Map System", head.crs);
  line("Survey Tool", WordOf(head.tool));
  line("Error Model", head.error_model);
  for (const std::string& remark : head.remarks) line("Remark", OneLine(remark));
  return text;
}

}  // namespace

void TakeReportLine(SurveyHead& head, std::string_view line) {
  const std::size_t colon = line.find(':');
  if (colon == std::string_view::npos) return;
  const std::string_view key = Trim(line.substr(0, colon)), value = Trim(line.substr(colon + 1));
  for (const NameKey& n : kNames) {
    if (EqualNoCase(key, n.key)) head.names.*n.member = value;
  }
  if (EqualNoCase(key, "North Reference")) {
    if (const auto north = NorthOf(value)) head.azimuth.north = *north;
  } else if (EqualNoCase(key, "Offset Reference")) {
    if (const auto north = NorthOf(value)) head.offsets = *north;
  } else if (EqualNoCase(key, "MD Reference") || EqualNoCase(key, "TVD Reference")) {
    TakeDatum(head, value);
  } else if (EqualNoCase(key, "Survey Calculation Method")) {
    head.method = Lower(value);
  } else if (EqualNoCase(key, "Grid Convergence")) {
    head.azimuth.convergence = Degrees(value);
  } else if (EqualNoCase(key, "Magnetic Declination")) {
    head.azimuth.declination = Degrees(value);
  } else if (EqualNoCase(key, "Vertical Section Azimuth")) {
    head.section_azimuth = Degrees(value);
  } else if (EqualNoCase(key, "Map System")) {
    head.crs = value;
  } else if (EqualNoCase(key, "Survey Tool")) {
    if (const auto tool = SurveyToolOf(value)) head.tool = *tool;
  } else if (EqualNoCase(key, "Error Model")) {
    head.error_model = value;
  } else if (EqualNoCase(key, "Remark")) {
    head.remarks.emplace_back(value);
  }
}

std::string WriteCompass(const SurveyTable& table) {
  NeedNorth(table, "a Compass-style report");
  const SurveyHead& head = table.head;
  std::string text = HeadText(head) + "\n";
  std::string names, units;
  for (const NamedColumn& c : kTable) {
    if (!table.Has(c.column)) continue;
    names += fmt::format(" {:>14}", c.name);
    units += fmt::format(" {:>14}", "(" + UnitOf(InfoOf(c.column).quantity, head) + ")");
  }
  text += names + "\n" + units + "\n";
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (!OnPath(table.status(row))) continue;
    for (const NamedColumn& c : kTable) {
      if (!table.Has(c.column)) continue;
      const auto value = table.Get(c.column, row);
      text += fmt::format(" {:>14}", value ? Exact(InfoOf(c.column).quantity, *value, head) : "-");
    }
    text += '\n';
  }
  return text;
}

}  // namespace wellgyro

// Text reports in the manner of Landmark Compass: a head of "Key: value" lines, a table under two
// lines of names and units. There is no published specification; reading goes by the table reader.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/exchange/certificate_internal.h"
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
  std::string text = "\n";
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

namespace {

constexpr std::array<std::string_view, 13> kFacts{"North Reference",
                                                  "Offset Reference",
                                                  "MD Reference",
                                                  "TVD Reference",
                                                  "Survey Calculation Method",
                                                  "Grid Convergence",
                                                  "Magnetic Declination",
                                                  "Vertical Section Azimuth",
                                                  "Map System",
                                                  "Survey Tool",
                                                  "Error Model",
                                                  "Local Co-ordinate Reference",
                                                  "Remark"};

// One of the keys of a report's head, at the begin of `text` and followed by a colon.
std::string_view KeyAt(std::string_view text) {
  const auto is = [&](std::string_view key) {
    if (!EqualNoCase(text.substr(0, key.size()), key)) return false;
    const std::string_view rest = Trim(text.substr(key.size()));
    return rest.starts_with(':');
  };
  for (const NameKey& n : kNames) {
    if (is(n.key)) return n.key;
  }
  for (const std::string_view key : kFacts) {
    if (is(key)) return key;
  }
  return {};
}

void TakeTvdDatum(SurveyHead& head, std::string_view value, Claims& claims) {
  SurveyHead other;
  TakeDatum(other, value);
  if (head.datum.empty() && !head.datum_elevation) return TakeDatum(head, value);
  const bool sea = EqualNoCase(other.datum, "MSL") || EqualNoCase(other.datum, "Mean Sea Level");
  if (!other.datum_elevation && sea) other.datum_elevation = 0;
  const bool same_height = head.datum_elevation && other.datum_elevation &&
                           std::abs(*head.datum_elevation - *other.datum_elevation) < 1e-3;
  if (same_height || EqualNoCase(other.datum, head.datum)) return;
  claims.tvd_datum = other.datum.empty() ? std::string(value) : other.datum;
  claims.tvd_elevation = other.datum_elevation;
}

void TakeFact(SurveyHead& head, std::string_view key, std::string_view value, Claims& claims) {
  for (const NameKey& n : kNames) {
    if (key == n.key) head.names.*n.member = value;
  }
  if (key == "North Reference") {
    if (const auto north = NorthOf(value)) head.azimuth.north = *north;
  } else if (key == "Offset Reference") {
    if (const auto north = NorthOf(value)) {
      head.offsets = *north;
      claims.offsets_north = true;
    }
  } else if (key == "MD Reference") {
    TakeDatum(head, value);
  } else if (key == "TVD Reference") {
    TakeTvdDatum(head, value, claims);
  } else if (key == "Survey Calculation Method") {
    head.method = Lower(value);
  } else if (key == "Grid Convergence") {
    head.azimuth.convergence = Degrees(value);
  } else if (key == "Magnetic Declination") {
    head.azimuth.declination = Degrees(value);
  } else if (key == "Vertical Section Azimuth") {
    head.section_azimuth = Degrees(value);
  } else if (key == "Map System") {
    head.crs = value;
  } else if (key == "Survey Tool") {
    if (const auto tool = SurveyToolOf(value)) head.tool = *tool;
  } else if (key == "Error Model") {
    head.error_model = value;
  } else if (key == "Remark") {
    AddRemark(head, std::string(value));
  }
}

}  // namespace

// Heads stand in one column or in two, side by side: a key begins the line or follows two blanks.
void TakeReportLine(SurveyHead& head, std::string_view line, Claims& claims) {
  std::string_view key = KeyAt(line);
  std::size_t from = 0;
  while (!key.empty()) {
    const std::size_t begin = line.find(':', from + key.size()) + 1;
    std::size_t next = begin;
    std::string_view next_key;
    while (next_key.empty() && next < line.size()) {
      next = line.find_first_of(" \t", next);
      if (next == std::string_view::npos) break;
      const std::size_t word = line.find_first_not_of(" \t", next);
      if (word == std::string_view::npos) break;
      if (word - next > 1 || line[next] == '\t') next_key = KeyAt(line.substr(word));
      next = word;
    }
    const std::size_t end = next_key.empty() ? line.size() : next;
    TakeFact(head, key, Trim(line.substr(begin, end - begin)), claims);
    from = end;
    key = next_key;
  }
}

std::string WriteCompass(const SurveyTable& table) {
  NeedNorth(table, "a Compass-style report");
  const SurveyHead& head = table.head;
  std::string text = HeadText(head) + "\n";
  std::string names, units;
  for (const NamedColumn& c : kTable) {
    if (!table.Has(c.column)) continue;
    names += fmt::format(" {:>18}", c.name);
    units += fmt::format(" {:>18}", "(" + UnitOf(InfoOf(c.column).quantity, head) + ")");
  }
  text += names + "\n" + units + "\n";
  std::size_t stations = 0;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (!OnPath(table.status(row))) continue;
    ++stations;
    for (const NamedColumn& c : kTable) {
      if (!table.Has(c.column)) continue;
      const auto value = table.Get(c.column, row);
      text += fmt::format(" {:>18}", value ? Exact(InfoOf(c.column).quantity, *value, head) : "-");
    }
    text += '\n';
  }
  return "Survey Report\n" + CertificateText(stations, text) + "\n" + text;
}

}  // namespace wellgyro

#include "wellgyro/io/exchange/las_curves_internal.h"

#include <algorithm>

#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/exchange/csv_columns_internal.h"
#include "wellgyro/io/exchange/las_internal.h"
#include "wellgyro/io/exchange/survey_words_internal.h"
#include "wellgyro/io/text_internal.h"

namespace wellgyro::las {
namespace {

void TakeUnits(Column column, const std::string& unit, SurveyHead& head) {
  const auto length = LengthUnitOf(unit);
  if (column == Column::kMd && length) head.md_unit = *length;
  if ((column == Column::kNorthing || column == Column::kDown) && length) {
    head.grid_unit = *length;
  }
  const auto curvature = column == Column::kDogleg ? CurvatureUnitOf(unit) : std::nullopt;
  if (curvature) head.curvature_unit = *curvature;
}

}  // namespace

std::optional<Line> LineOf(std::string_view line) {
  const std::size_t dot = line.find('.');
  if (dot == std::string_view::npos) return std::nullopt;
  // Some writers leave the colon out where there is no description.
  std::size_t colon = line.rfind(':');
  if (colon == std::string_view::npos || colon < dot) colon = line.size();
  std::string_view rest = line.substr(dot + 1, colon - dot - 1);
  const std::size_t unit_end = std::min(rest.find_first_of(" \t"), rest.size());
  std::string_view unit = rest.substr(0, unit_end);
  if (unit.starts_with('[') && unit.ends_with(']')) unit = unit.substr(1, unit.size() - 2);
  return Line{std::string(Trim(line.substr(0, dot))), std::string(unit),
              FromDataText(Trim(rest.substr(unit_end)))};
}

void Curves::Add(const Line& line, const std::string& index_unit, bool its_own, SurveyHead& head) {
  const Index index{index_unit, its_own};
  Curve curve;
  Heading heading = HeadingOf(line.mnemonic);
  for (const ColumnInfo& info : AllColumns()) {
    if (!heading.column && EqualNoCase(info.las, line.mnemonic)) heading.column = info.column;
  }
  // The first curve is the index, which need not say so.
  if (curves_.empty() && EqualNoCase(line.mnemonic, "INDEX")) heading.column = Column::kMd;
  TakeOption(heading, line);
  headings_.push_back(heading);
  if (heading.column == Column::kAzimuth) heading.column = AzimuthColumn(heading.north, head);
  const bool twice =
      heading.column && std::any_of(curves_.begin(), curves_.end(),
                                    [&](const Curve& c) { return c.column == heading.column; });
  if (heading.column && !twice) {
    TakeCurve(curve, *heading.column, line.unit, index, head);
  } else if (twice) {
    head.notes.push_back(fmt::format("{} gives {} once more: it is left out", line.mnemonic,
                                     InfoOf(*heading.column).text));
  }
  curves_.push_back(curve);
}

// An option names a curve by its mnemonic or its number, and wins over what others are called.
void Curves::TakeOption(Heading& heading, const Line& line) const {
  for (const auto& [canonical, name] : options_.columns) {
    Heading want = HeadingOf(canonical);
    const bool here =
        EqualNoCase(name, line.mnemonic) || IntegerOf(name) == static_cast<int>(curves_.size()) + 1;
    if (here) {
      heading = want;
      heading.told = true;
    } else if (heading.column == want.column && heading.north == want.north && !heading.told) {
      heading.column.reset();
    }
  }
}

void Curves::TakeCurve(Curve& curve, Column column, std::string unit, const Index& index,
                       SurveyHead& head) {
  curve.quantity = InfoOf(column).quantity;
  if (unit.empty()) return WithoutUnit(curve, column, index, head);
  auto factor = FactorOf(curve.quantity, unit);
  if (!factor) {
    if (column > Column::kAzimuth) return;
    lines_.Complain(FaultCode::kSyntax, NoUnit(curve.quantity, unit, InfoOf(column).text));
  }
  // An option for the unit of depth wins for what stands in the file's unit of depth.
  const auto length = LengthUnitOf(unit);
  if (column == Column::kMd) TakeIndexUnit(length, index);
  if (options_.depth_unit && curve.quantity == Quantity::kLength && length == md_unit_) {
    if (column == Column::kMd && length && *length != *options_.depth_unit) {
      head.notes.push_back(fmt::format("depths are taken in {} as told, though the file says {}",
                                       WordOf(*options_.depth_unit), WordOf(*length)));
    }
    factor = FactorOf(*options_.depth_unit);
    unit = WordOf(*options_.depth_unit);
  }
  curve.column = column;
  curve.factor = *factor;
  TakeUnits(column, unit, head);
}

// STRT, STOP and STEP stand in the unit of the index; where they do not, one of both is wrong. In
// LAS 3.0 they are the log's, not those of a survey beside it.
void Curves::TakeIndexUnit(std::optional<LengthUnit> unit, const Index& index) {
  md_unit_ = unit;
  const auto start = LengthUnitOf(index.unit);
  if (!index.its_own || options_.depth_unit || !unit || !start || *unit == *start) return;
  lines_.Complain(FaultCode::kConflict,
                  fmt::format("its depths are in {}, but STRT and STOP in {}: say --depth-unit",
                              WordOf(*unit), WordOf(*start)));
}

// Angles are degrees; lengths are in the unit of the index, which may be told.
void Curves::WithoutUnit(Curve& curve, Column column, const Index& index, SurveyHead& head) const {
  curve.column = column;
  switch (curve.quantity) {
    case Quantity::kAngle:
    case Quantity::kDirection:
      curve.factor = units::kDeg;
      return;
    case Quantity::kCurvature:
      if (column != Column::kDogleg) return curve.column.reset();
      claims_.curvature_unit = false;
      curve.factor = units::kDegPer30m;
      return;
    case Quantity::kLength:
    case Quantity::kGridLength:
      if (column == Column::kMd) {
        const auto unit = options_.depth_unit ? options_.depth_unit : LengthUnitOf(index.unit);
        claims_.md_unit = unit.has_value();
        if (unit) head.md_unit = head.grid_unit = *unit;
      } else {
        claims_.open.push_back(column);
      }
      curve.factor = claims_.md_unit ? FactorOf(head.md_unit) : 1;
      return;
    default:
      if (!FactorOf(curve.quantity, "")) curve.column.reset();
  }
}

// The north that an option or a curve's name gives, which the parameter I_AT may contradict.
void Curves::TakeNorth(North north, bool told, SurveyHead& head) const {
  North& said = head.azimuth.north;
  if (north == North::kUnknown || north == said) return;
  if (said != North::kUnknown) {
    head.notes.push_back(
        fmt::format("azimuths are taken from {} north {}, though the file "
                    "says {}",
                    WordOf(north), told ? "as told" : "as their curve is called", WordOf(said)));
  }
  said = north;
}

std::optional<Column> Curves::AzimuthColumn(North north, SurveyHead& head) {
  if (!azimuth_seen_) {
    azimuth_seen_ = true;
    TakeNorth(north, headings_.back().told, head);
    return Column::kAzimuth;
  }
  return SecondAzimuth(north);
}

void Curves::Check(SurveyHead& head) {
  const std::string unused = UnusedColumn(headings_, options_);
  if (!unused.empty()) lines_.Complain(FaultCode::kConflict, unused);
  for (const Heading& h : headings_) {
    if (h.told && h.column == Column::kAzimuth) TakeNorth(h.north, true, head);
  }
  for (const Column column : {Column::kMd, Column::kInclination, Column::kAzimuth}) {
    if (!Has(column)) {
      lines_.Complain(FaultCode::kForeign, fmt::format("no curve of {}", InfoOf(column).text));
    }
  }
  if (curves_.front().column != Column::kMd) {
    lines_.Complain(FaultCode::kSyntax, "the first curve is not measured depth");
  }
  if (head.offsets == North::kUnknown) head.offsets = head.azimuth.north;
}

void Curves::Clear() {
  curves_.clear();
  headings_.clear();
  azimuth_seen_ = false;
}

bool Curves::Has(Column column) const {
  return std::any_of(curves_.begin(), curves_.end(),
                     [&](const Curve& c) { return c.column == column; });
}

bool Curves::MakeSurvey() const {
  return Has(Column::kMd) && Has(Column::kInclination) && Has(Column::kAzimuth);
}

}  // namespace wellgyro::las

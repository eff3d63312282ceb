#include "wellgyro/io/exchange/csv_columns_internal.h"

#include <algorithm>
#include <cstdint>
#include <set>

#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/text_internal.h"

namespace wellgyro {
namespace {

std::optional<std::size_t> Wanted(const std::string& name, const std::vector<std::string>& fields) {
  if (const auto number = IntegerOf(name)) {
    if (*number >= 1 && static_cast<std::size_t>(*number) <= fields.size()) {
      return static_cast<std::size_t>(*number) - 1;
    }
    return std::nullopt;
  }
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const std::string_view plain = fields[i];
    if (EqualNoCase(plain, name) ||
        EqualNoCase(Trim(plain.substr(0, plain.find_first_of("[("))), name)) {
      return i;
    }
  }
  return std::nullopt;
}

class ColumnMaker {
 public:
  ColumnMaker(const ReadOptions& options, SurveyHead& head, Claims& claims, const LineReader& lines)
      : options_(options), head_(head), claims_(claims), lines_(lines) {}

  CsvColumns Make(const std::vector<Heading>& headings) {
    TakeDepthUnit(headings);
    CsvColumns columns;
    for (const Heading& h : headings) columns.all.push_back(ColumnOf(h, headings, columns.all));
    for (std::size_t i = 0; i < columns.all.size(); ++i) {
      const auto column = columns.all[i].column;
      if (column == Column::kMd) columns.md = i;
      if (column == Column::kInclination) columns.inclination = i;
      if (column == Column::kAzimuth) columns.azimuth = i;
    }
    return columns;
  }

 private:
  // The unit of MD first: others take it over, wherever it stands.
  void TakeDepthUnit(const std::vector<Heading>& headings) {
    claims_.md_unit = false;
    for (const Heading& h : headings) {
      if (h.column != Column::kMd) continue;
      md_unit_ = LengthUnitOf(h.unit);
      if (!h.unit.empty() && !md_unit_) {
        lines_.Complain(FaultCode::kSyntax, NoUnitOfDepth(h.unit));
      }
      break;
    }
    const auto unit = options_.depth_unit ? options_.depth_unit : md_unit_;
    if (md_unit_ && *unit != *md_unit_) {
      head_.notes.push_back(fmt::format("depths are taken in {} as told, though the file says {}",
                                        WordOf(*unit), WordOf(*md_unit_)));
    }
    if (unit) head_.md_unit = head_.grid_unit = *unit;
    claims_.md_unit = unit.has_value();
  }

  CsvColumn ColumnOf(const Heading& h, const std::vector<Heading>& headings,
                     const std::vector<CsvColumn>& before) {
    CsvColumn c{.column = h.column, .text = h.text, .status = h.status, .well = h.well};
    if (c.column) TakeNorth(c, h, before.size() + 1);
    const auto first = std::find_if(before.begin(), before.end(), [&](const CsvColumn& o) {
      return c.column && o.column == c.column;
    });
    if (first != before.end()) {
      const auto at = static_cast<std::size_t>(first - before.begin());
      Twice(*c.column, at, before.size(), headings[at].unit == h.unit);
      c.column.reset();
    }
    if (c.column && h.unit.empty()) WithoutUnit(c);
    if (c.column && !h.unit.empty()) WithUnit(c, h.unit);
    if (c.column && h.either_axis) claims_.axes_named = false;
    return c;
  }

  // The same in another unit is common; which of two alike holds is not ours to say.
  void Twice(Column column, std::size_t first, std::size_t second, bool alike) {
    const std::string_view name = InfoOf(column).text;
    if (alike && column <= Column::kAzimuth) {
      lines_.Complain(FaultCode::kConflict,
                      fmt::format("columns {} and {} are both {}: say which by --columns {}={}",
                                  first + 1, second + 1, name, InfoOf(column).csv, first + 1));
    }
    head_.notes.push_back(fmt::format("columns {} and {} are both {}: the first is used", first + 1,
                                      second + 1, name));
  }

  // The first azimuth is the table's own; others stand beside it.
  void TakeNorth(CsvColumn& c, const Heading& h, std::size_t number) {
    if (c.column == Column::kAzimuth) {
      if (azimuth_seen_) {
        if (h.north == head_.azimuth.north) return;
        c.column = SecondAzimuth(h.north);
        if (!c.column) {
          head_.notes.push_back(fmt::format(
              "column {} is another azimuth, from no stated north: it is left out", number));
        }
        return;
      }
      azimuth_seen_ = true;
      if (h.north != North::kUnknown) head_.azimuth.north = h.north;
    }
    if (c.column == Column::kNorth && h.north != North::kUnknown) {
      head_.offsets = h.north;
      claims_.offsets_north = true;
    }
  }

  void WithUnit(CsvColumn& c, const std::string& unit) {
    c.quantity = InfoOf(*c.column).quantity;
    auto factor = FactorOf(c.quantity, unit);
    if (!factor) {
      const std::string text = NoUnit(c.quantity, unit, InfoOf(*c.column).text);
      if (*c.column <= Column::kAzimuth) lines_.Complain(FaultCode::kSyntax, text);
      head_.notes.push_back(text + ": the column is left out");
      return c.column.reset();
    }
    const auto length = LengthUnitOf(unit);
    // What stands in the unit that the file gives to depths follows an option for that.
    if (options_.depth_unit && c.quantity == Quantity::kLength && md_unit_ && length == md_unit_) {
      factor = FactorOf(*options_.depth_unit);
    }
    c.factor = *factor;
    if ((c.column == Column::kNorthing || c.column == Column::kDown) && length) {
      head_.grid_unit = *length;
    }
    if (c.column == Column::kDogleg) {
      if (const auto curvature = CurvatureUnitOf(unit)) head_.curvature_unit = *curvature;
    }
  }

  // Angles are degrees, lengths as MD until their witness says otherwise.
  void WithoutUnit(CsvColumn& c) {
    c.quantity = InfoOf(*c.column).quantity;
    switch (c.quantity) {
      case Quantity::kAngle:
      case Quantity::kDirection:
        c.factor = units::kDeg;
        break;
      case Quantity::kCurvature:
        if (c.column != Column::kDogleg) return c.column.reset();
        claims_.curvature_unit = false;
        c.factor = units::kDegPer30m;
        break;
      case Quantity::kLength:
      case Quantity::kGridLength:
        c.factor = claims_.md_unit ? FactorOf(head_.md_unit) : 1;
        if (c.column != Column::kMd) claims_.open.push_back(*c.column);
        break;
      case Quantity::kArea:
        if (!claims_.md_unit) return c.column.reset();
        c.factor = FactorOf(head_.md_unit) * FactorOf(head_.md_unit);
        break;
      default:
        break;
    }
  }

  const ReadOptions& options_;
  SurveyHead& head_;
  Claims& claims_;
  const LineReader& lines_;
  std::optional<LengthUnit> md_unit_;
  bool azimuth_seen_ = false;
};

struct Token {
  std::size_t begin, end;
};

std::vector<Token> TokensOf(std::string_view line) {
  std::vector<Token> tokens;
  for (std::size_t at = 0;;) {
    const std::size_t begin = line.find_first_not_of(" \t", at);
    if (begin == std::string_view::npos) return tokens;
    at = std::min(line.find_first_of(" \t", begin), line.size());
    tokens.push_back({begin, at});
  }
}

// The column of numbers over which a word stands: the one whose middle is nearest.
std::size_t Under(const Token& word, const std::vector<Token>& columns) {
  const auto distance = [&](const Token& c) {
    const auto twice = static_cast<std::int64_t>(word.begin + word.end);
    return std::abs(twice - static_cast<std::int64_t>(c.begin + c.end));
  };
  return static_cast<std::size_t>(
      std::min_element(columns.begin(), columns.end(),
                       [&](const Token& a, const Token& b) { return distance(a) < distance(b); }) -
      columns.begin());
}

}  // namespace

std::vector<Heading> CsvHeadingsOf(const std::vector<std::string>& fields,
                                   const ReadOptions& options) {
  std::vector<Heading> headings;
  headings.reserve(fields.size());
  for (const std::string& field : fields) headings.push_back(HeadingOf(TrimCell(field)));
  for (const auto& [canonical, name] : options.columns) {
    const Heading want = HeadingOf(canonical);
    if (!want.column) continue;
    const auto at = Wanted(name, fields);
    for (Heading& other : headings) {
      const bool same = other.column == want.column && other.north == want.north;
      if (same && (at || name == "0")) other.column.reset();
    }
    if (!at) continue;
    headings[*at].column = want.column;
    headings[*at].north = want.north;
    headings[*at].either_axis = false;
    headings[*at].told = true;
    if (!want.unit.empty()) headings[*at].unit = want.unit;
  }
  return headings;
}

std::string UnusedColumn(const std::vector<Heading>& headings, const ReadOptions& options) {
  std::set<std::string> named;
  for (const auto& [canonical, name] : options.columns) {
    if (name == "0" || named.insert(name).second) continue;
    return fmt::format("--columns {}={}: column {} is named twice", canonical, name, name);
  }
  for (const auto& [canonical, name] : options.columns) {
    const Heading want = HeadingOf(canonical);
    const auto is = [&](const Heading& h) { return h.told && h.column == want.column; };
    if (name == "0" || std::any_of(headings.begin(), headings.end(), is)) continue;
    return fmt::format("--columns {}={}: no column is called so, and there are {} of them",
                       canonical, name, headings.size());
  }
  return {};
}

bool NamePositions(const std::vector<Heading>& headings) {
  const auto has = [&](Column column) {
    return std::any_of(headings.begin(), headings.end(),
                       [&](const Heading& h) { return h.column == column; });
  };
  const bool plane = (has(Column::kNorth) && has(Column::kEast)) ||
                     (has(Column::kNorthing) && has(Column::kEasting));
  const bool depth = has(Column::kTvd) || has(Column::kDown) || has(Column::kTvdSubSea);
  return has(Column::kMd) && plane && depth && !has(Column::kInclination) && !has(Column::kAzimuth);
}

bool NameStations(const std::vector<Heading>& headings) {
  bool md = false, inclination = false, azimuth = false;
  for (const Heading& h : headings) {
    md = md || h.column == Column::kMd;
    inclination = inclination || h.column == Column::kInclination;
    azimuth = azimuth || h.column == Column::kAzimuth;
  }
  return md && inclination && azimuth;
}

bool IsCsvUnit(const std::string& cell) {
  const Heading h = HeadingOf("x" + cell);
  const std::string& unit = h.unit.empty() ? cell : h.unit;
  return LengthUnitOf(unit) || FactorOf(Quantity::kAngle, unit).has_value();
}

CsvColumns CsvColumnsOf(const std::vector<Heading>& headings, const ReadOptions& options,
                        SurveyHead& head, Claims& claims, const LineReader& lines) {
  return ColumnMaker(options, head, claims, lines).Make(headings);
}

std::vector<Heading> MergedHeadings(const std::vector<std::string>& lines,
                                    const std::string& numbers, char delimiter,
                                    const ReadOptions& options) {
  std::vector<std::string> names, units;
  if (delimiter == ' ') {
    const std::vector<Token> columns = TokensOf(numbers);
    names.resize(columns.size());
    units.resize(columns.size());
    for (const std::string& line : lines) {
      for (const Token& word : TokensOf(line)) {
        const std::string text = line.substr(word.begin, word.end - word.begin);
        const std::size_t column = Under(word, columns);
        const bool unit = text.front() == '(' || text.front() == '[';
        (unit ? units : names)[column] += (unit || names[column].empty() ? "" : " ") + text;
      }
    }
  } else {
    for (const std::string& line : lines) {
      const auto fields = SplitQuoted(line, delimiter);
      if (!fields) return {};
      names.resize(std::max(names.size(), fields->size()));
      units.resize(names.size());
      for (std::size_t i = 0; i < fields->size(); ++i) {
        const std::string& text = (*fields)[i];
        if (text.empty()) continue;
        const bool unit = text.front() == '(' || text.front() == '[';
        (unit ? units : names)[i] += (unit || names[i].empty() ? "" : " ") + text;
      }
    }
  }
  for (std::size_t i = 0; i < names.size(); ++i) names[i] += units[i];
  return CsvHeadingsOf(names, options);
}

}  // namespace wellgyro

// Surveys as delimited tables: our own survey.csv and whatever importers are fed with.
#include <algorithm>
#include <array>

#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/exchange/headings_internal.h"
#include "wellgyro/io/exchange/survey_words_internal.h"
#include "wellgyro/io/exchange/table_build_internal.h"
#include "wellgyro/io/text_internal.h"

namespace wellgyro {
namespace {

constexpr int kMostHeaderLines = 200;

struct CsvColumn {
  std::optional<Column> column;
  std::optional<TextColumn> text;
  bool status = false;
  Quantity quantity = Quantity::kNumber;
  double factor = 1;
  std::string heading;
};

bool IsBlank(const std::vector<std::string>& fields) {
  return std::all_of(fields.begin(), fields.end(), [](const auto& f) { return f.empty(); });
}

std::optional<double> CellNumber(const std::string& cell, char delimiter) {
  const auto number = NumberOf(cell);
  if (number || delimiter == ',') return number;
  return NumberWithComma(cell);
}

// Turns lines into a table: preamble, header line, a line of units perhaps, rows, footnotes.
class CsvReader {
 public:
  CsvReader(LineReader& lines, const ReadOptions& options) : lines_(lines), options_(options) {}

  SurveyTable Read() {
    FindHeader();
    CheckColumns();
    std::vector<std::string> fields;
    while (NextRecord(fields)) {
      if (IsBlank(fields)) {
        ended_ = true;
      } else if (ended_) {
        TakeFootnote(fields);
      } else {
        TakeRow(fields);
      }
    }
    if (build_.table.rows() == 0) {
      lines_.Complain(FaultCode::kForeign, "a header without a single station");
    }
    return std::move(build_.table);
  }

 private:
  SurveyHead& head() { return build_.table.head; }

  // One record, which quotes may carry over several lines.
  bool NextRecord(std::vector<std::string>& fields) {
    std::string_view line;
    if (!lines_.Next(line)) return false;
    if (const auto split = SplitQuoted(line, delimiter_)) {
      fields = *split;
      return true;
    }
    std::string joined(line);
    for (int more = 0; more < 100 && lines_.Next(line); ++more) {
      joined += '\n';
      joined += line;
      if (const auto split = SplitQuoted(joined, delimiter_)) {
        fields = *split;
        return true;
      }
    }
    lines_.Complain(FaultCode::kSyntax, "a quotation mark without its end");
  }

  // Delimiters by which the line falls apart best.
  void FindHeader() {
    std::string_view line;
    while (lines_.number() < kMostHeaderLines && lines_.Next(line)) {
      const std::string_view text = Trim(line);
      if (text.empty()) continue;
      if (text.front() == '#') {
        TakePreamble(text.substr(1));
        continue;
      }
      for (const char delimiter : {',', ';', '\t', ' '}) {
        const auto fields = SplitQuoted(text.data() == line.data() ? line : text, delimiter);
        if (fields && IsHeader(*fields)) {
          delimiter_ = delimiter;
          TakeHeader(*fields);
          return;
        }
      }
      if (!options_.columns.empty() && TakeHeaderless(line)) return;
      TakeReportLine(head(), text);
    }
    if (lines_.number() == 0) lines_.Complain(FaultCode::kForeign, "this file is empty");
    lines_.Complain(FaultCode::kForeign,
                    "no line names columns for depth, inclination and azimuth: name them with "
                    "--columns MD=1,INC=2,AZI=3");
  }

  void TakePreamble(std::string_view line) {
    const std::size_t colon = line.find(':');
    if (colon != std::string_view::npos) {
      TakePair(head(), line.substr(0, colon), line.substr(colon + 1));
    }
  }

  std::optional<std::size_t> Wanted(const std::string& name,
                                    const std::vector<std::string>& fields) const {
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

  std::vector<Heading> HeadingsOf(const std::vector<std::string>& fields) const {
    std::vector<Heading> headings;
    headings.reserve(fields.size());
    for (const std::string& field : fields) headings.push_back(HeadingOf(field));
    for (const auto& [canonical, name] : options_.columns) {
      const Heading want = HeadingOf(canonical);
      const auto at = Wanted(name, fields);
      if (!want.column || !at) continue;
      for (Heading& other : headings) {
        if (other.column == want.column && other.north == want.north) other.column.reset();
      }
      headings[*at].column = want.column;
      headings[*at].north = want.north;
      if (!want.unit.empty()) headings[*at].unit = want.unit;
    }
    return headings;
  }

  bool IsHeader(const std::vector<std::string>& fields) const {
    if (std::any_of(fields.begin(), fields.end(),
                    [](const auto& f) { return NumberOf(f).has_value(); })) {
      return false;
    }
    bool md = false, inclination = false, azimuth = false;
    for (const Heading& h : HeadingsOf(fields)) {
      md = md || h.column == Column::kMd;
      inclination = inclination || h.column == Column::kInclination;
      azimuth = azimuth || h.column == Column::kAzimuth;
    }
    return md && inclination && azimuth;
  }

  // No header line at all: columns by number, and the line is the first station.
  bool TakeHeaderless(std::string_view line) {
    for (const char delimiter : {'\t', ';', ',', ' '}) {
      const auto fields = SplitQuoted(line, delimiter);
      if (!fields || fields->size() < 3) continue;
      const bool numbers = std::all_of(fields->begin(), fields->end(), [&](const auto& f) {
        return f.empty() || CellNumber(f, delimiter).has_value();
      });
      if (!numbers) continue;
      for (const auto& [canonical, name] : options_.columns) {
        if (!IntegerOf(name)) return false;
      }
      delimiter_ = delimiter;
      MakeColumns(HeadingsOf(std::vector<std::string>(fields->size())), *fields);
      lines_.Back();
      return true;
    }
    return false;
  }

  void TakeHeader(const std::vector<std::string>& fields) {
    std::vector<Heading> headings = HeadingsOf(fields);
    // A second line may hold the units.
    std::vector<std::string> next;
    if (NextRecord(next)) {
      const bool units =
          !IsBlank(next) && next.size() <= fields.size() &&
          std::all_of(next.begin(), next.end(), [](const auto& f) { return !NumberOf(f); }) &&
          std::any_of(next.begin(), next.end(), [](const auto& f) { return IsUnit(f); });
      if (units) {
        for (std::size_t i = 0; i < next.size(); ++i) {
          const Heading cell = HeadingOf("x" + next[i]);
          if (headings[i].unit.empty()) headings[i].unit = cell.unit.empty() ? next[i] : cell.unit;
        }
      } else {
        lines_.Back();
      }
    }
    MakeColumns(headings, fields);
  }

  static bool IsUnit(const std::string& cell) {
    const Heading h = HeadingOf("x" + cell);
    const std::string& unit = h.unit.empty() ? cell : h.unit;
    return LengthUnitOf(unit) || FactorOf(Quantity::kAngle, unit).has_value();
  }

  void MakeColumns(const std::vector<Heading>& headings, const std::vector<std::string>& names) {
    // The unit of MD first: others take it over, wherever it stands.
    for (const Heading& h : headings) {
      if (h.column != Column::kMd) continue;
      const auto unit = LengthUnitOf(h.unit);
      if (!h.unit.empty() && !unit) continue;
      if (unit || options_.depth_unit) {
        head().md_unit = unit ? *unit : *options_.depth_unit;
        md_unit_known_ = true;
      }
      break;
    }
    for (std::size_t i = 0; i < headings.size(); ++i) {
      const Heading& h = headings[i];
      CsvColumn c{.column = h.column, .text = h.text, .status = h.status};
      c.heading = i < names.size() ? names[i] : std::string();
      if (c.column) TakeNorth(c, h.north);
      const bool twice =
          c.column && std::any_of(columns_.begin(), columns_.end(),
                                  [&](const auto& o) { return o.column == c.column; });
      if (twice) c.column.reset();
      if (c.column) TakeUnit(c, h.unit);
      columns_.push_back(std::move(c));
    }
  }

  // The first azimuth is the table's own; others stand beside it.
  void TakeNorth(CsvColumn& c, North north) {
    if (c.column == Column::kAzimuth) {
      if (!azimuth_seen_) {
        azimuth_seen_ = true;
        if (north != North::kUnknown) head().azimuth.north = north;
        return;
      }
      c.column = north == North::kTrue       ? Column::kAzimuthTrue
                 : north == North::kGrid     ? Column::kAzimuthGrid
                 : north == North::kMagnetic ? Column::kAzimuthMagnetic
                                             : std::optional<Column>();
    }
    if (c.column == Column::kNorth && north != North::kUnknown) head().offsets = north;
  }

  void TakeUnit(CsvColumn& c, const std::string& unit) {
    c.quantity = InfoOf(*c.column).quantity;
    if (!unit.empty()) {
      const auto factor = FactorOf(c.quantity, unit);
      if (!factor) {
        if (*c.column > Column::kAzimuth) return c.column.reset();
        lines_.Complain(FaultCode::kSyntax,
                        fmt::format("'{}' is no unit of {}", unit, InfoOf(*c.column).text));
      }
      c.factor = *factor;
      if (c.column == Column::kNorthing || c.column == Column::kDown) {
        if (const auto length = LengthUnitOf(unit)) head().grid_unit = *length;
      }
      if (c.column == Column::kDogleg) {
        if (const auto curvature = CurvatureUnitOf(unit)) head().curvature_unit = *curvature;
      }
      return;
    }
    // Without a unit: angles are degrees, lengths as MD, and curvature could be anything.
    if (c.quantity == Quantity::kCurvature) c.column.reset();
    if (c.quantity == Quantity::kAngle || c.quantity == Quantity::kDirection) {
      c.factor = units::kDeg;
    }
    if (c.quantity == Quantity::kLength || c.quantity == Quantity::kGridLength ||
        c.quantity == Quantity::kArea) {
      if (c.column != Column::kMd && !md_unit_known_) return c.column.reset();
      if (c.column == Column::kMd && !md_unit_known_) {
        lines_.Complain(FaultCode::kSyntax,
                        "the unit of measured depth is not stated: say --depth-unit m or ft");
      }
      c.factor = FactorOf(head().md_unit);
      if (c.quantity == Quantity::kArea) c.factor *= c.factor;
    }
  }

  void CheckColumns() {
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      if (columns_[i].column == Column::kMd) md_ = i;
      if (columns_[i].column == Column::kInclination) inclination_ = i;
      if (columns_[i].column == Column::kAzimuth) azimuth_ = i;
    }
    if (!md_ || !inclination_ || !azimuth_) {
      lines_.Complain(FaultCode::kForeign, "depth, inclination and azimuth must each be a column");
    }
    if (head().offsets == North::kUnknown) head().offsets = head().azimuth.north;
  }

  void TakeFootnote(const std::vector<std::string>& fields) {
    std::string text;
    for (const std::string& field : fields) {
      if (NumberOf(field) && text.empty()) {
        lines_.Complain(FaultCode::kSyntax, "numbers after the blank line that ended the table");
      }
      if (!field.empty()) text += (text.empty() ? "" : " ") + field;
    }
    head().remarks.push_back(text);
  }

  double Needed(const std::vector<std::string>& fields, std::size_t i) {
    const std::string cell = i < fields.size() ? fields[i] : std::string();
    const auto number = CellNumber(cell, delimiter_);
    if (!number) {
      lines_.Complain(FaultCode::kSyntax, fmt::format("'{}' is not a number", cell.substr(0, 40)),
                      static_cast<int>(i) + 1);
    }
    return ValueOf(columns_[i].quantity, *number, columns_[i].factor);
  }

  void TakeRow(const std::vector<std::string>& fields) {
    if (fields.size() > columns_.size() &&
        std::any_of(fields.begin() + static_cast<std::ptrdiff_t>(columns_.size()), fields.end(),
                    [](const auto& f) { return !f.empty(); })) {
      lines_.Complain(FaultCode::kSyntax, fmt::format("{} fields where the header has {}",
                                                      fields.size(), columns_.size()));
    }
    RowStatus status = RowStatus::kSurveyed;
    for (std::size_t i = 0; i < std::min(fields.size(), columns_.size()); ++i) {
      if (!columns_[i].status || fields[i].empty()) continue;
      const auto word = RowStatusOf(fields[i]);
      if (!word) lines_.Complain(FaultCode::kSyntax, "'" + fields[i] + "' is no status");
      status = *word;
    }
    const auto problem = build_.Add(Needed(fields, *md_), Needed(fields, *inclination_),
                                    Needed(fields, *azimuth_), status);
    if (problem) lines_.Complain(problem->code, problem->text);
    for (std::size_t i = 0; i < std::min(fields.size(), columns_.size()); ++i) {
      const CsvColumn& c = columns_[i];
      if (fields[i].empty() || i == *md_ || i == *inclination_ || i == *azimuth_) continue;
      if (c.text) build_.Set(*c.text, fields[i]);
      if (c.column && !IsNothing(fields[i])) build_.Set(*c.column, Needed(fields, i));
    }
  }

  static bool IsNothing(const std::string& cell) {
    constexpr std::array<std::string_view, 6> kNothing{"-", "--", "n/a", "na", "nan", "null"};
    return std::find(kNothing.begin(), kNothing.end(), Lower(cell)) != kNothing.end();
  }

  LineReader& lines_;
  const ReadOptions& options_;
  TableBuilder build_;
  std::vector<CsvColumn> columns_;
  std::optional<std::size_t> md_, inclination_, azimuth_;
  char delimiter_ = ',';
  bool azimuth_seen_ = false, md_unit_known_ = false, ended_ = false;
};

}  // namespace

SurveyTable ReadCsv(LineReader& lines, const ReadOptions& options) {
  return CsvReader(lines, options).Read();
}

}  // namespace wellgyro

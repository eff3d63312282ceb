// Surveys as delimited tables: our own survey.csv and whatever importers are fed with.
#include <algorithm>
#include <array>
#include <set>

#include <fmt/core.h>

#include "wellgyro/io/exchange/csv_columns_internal.h"
#include "wellgyro/io/exchange/number_marks_internal.h"
#include "wellgyro/io/exchange/petra_internal.h"
#include "wellgyro/io/exchange/position_log_internal.h"
#include "wellgyro/io/exchange/spaced_names_internal.h"
#include "wellgyro/io/exchange/survey_words_internal.h"
#include "wellgyro/io/exchange/table_build_internal.h"
#include "wellgyro/io/text_internal.h"

namespace wellgyro {
namespace {

constexpr int kMostHeaderLines = 200;  // before the names; a text without names is given up there
constexpr int kMostLinesBelow = 20;    // between names and the first numbers

bool IsBlank(const std::vector<std::string>& fields) {
  return std::all_of(fields.begin(), fields.end(), [](const auto& f) { return f.empty(); });
}

bool IsNothing(std::string_view cell) {
  constexpr std::array<std::string_view, 7> kNothing{"-", "--", "n/a", "na", "nan", "null", "none"};
  return cell.empty() || std::find(kNothing.begin(), kNothing.end(), Lower(cell)) != kNothing.end();
}

// Turns lines into a table: preamble, header lines, a line of units perhaps, rows, footnotes.
class CsvReader {
 public:
  CsvReader(LineReader& lines, const ReadOptions& options, Claims& claims)
      : lines_(lines), options_(options), claims_(claims) {}

  SurveyTable Read() {
    FindHeader();
    if (!claims_.position_log && (!columns_.md || !columns_.inclination || !columns_.azimuth)) {
      lines_.Complain(FaultCode::kForeign, "depth, inclination and azimuth must each be a column");
    }
    std::vector<std::string> fields;
    while (NextRecord(fields)) {
      if (IsBlank(fields)) {
        ended_ = build_.table.rows() > 0;  // one between the heading and its rows ends nothing
      } else if (IsPetra() && fields.front().starts_with('*')) {
        TakeKeywords(fields);
      } else if (ended_) {
        TakeFootnote(fields);
      } else if (!OfAnotherWell(fields)) {
        TakeRow(fields);
      }
    }
    Conclude();
    return std::move(build_.table);
  }

 private:
  SurveyHead& head() { return build_.table.head; }

  void Conclude() {
    const bool named = well_column_ || IsPetra();
    if (!options_.well.empty() && named && build_.table.rows() == 0) {
      lines_.Complain(FaultCode::kForeign, "no row is of well " + options_.well + WellsText());
    }
    if (build_.table.rows() == 0) {
      lines_.Complain(FaultCode::kForeign, "a header without a single station");
    }
    if (const auto problem = build_.Finish()) lines_.Complain(problem->code, problem->text);
    if (claims_.position_log) {
      if (!claims_.md_unit) {
        lines_.Complain(FaultCode::kConflict,
                        "the unit of measured depth is not stated: say "
                        "--depth-unit m or ft");
      }
      const auto problem = BackCalculate(build_.table);
      if (problem) lines_.Complain(FaultCode::kConflict, *problem);
    }
    if (!ended_ && !lines_.certified()) {
      head().notes.emplace_back("nothing in it says where the table ends: a cut could not be seen");
    }
    if (named && !wells_.empty() && !wells_.front().empty()) {
      head().names.well = options_.well.empty() ? wells_.front() : options_.well;
    }
  }

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
      if (first_line_.empty()) first_line_ = text.substr(0, 200);
      if (text.empty()) {
        if (!above_.empty()) before_blank_ = std::move(above_);
        above_.clear();
        continue;
      }
      if (text.front() == '#') {
        TakePreamble(text.substr(1));
        continue;
      }
      if (petra_.Take(text, lines_)) continue;
      if (petra_.any()) return BeginPetra();
      if (TakeHeader(line)) return;
      if (!options_.columns.empty() && TakeHeaderless(line)) return;
      if (TakeHeadingsAbove(line)) return;
      TakeReportLine(head(), text, claims_);
      before_blank_.clear();
      above_.emplace_back(line);
      if (above_.size() > 3) above_.erase(above_.begin());
    }
    if (lines_.number() == 0) lines_.Complain(FaultCode::kForeign, "this file is empty");
    lines_.Complain(FaultCode::kForeign,
                    "no line names columns for depth, inclination and azimuth, as MD[m], INC[deg], "
                    "AZI_TRUE[deg], or DEPTH, DEVI and HAZ: name them with --columns "
                    "MD=1,INC=2,AZI=3" +
                        SensorHint());
  }

  void BeginPetra() {
    delimiter_ = ' ';
    lines_.Back();
    const std::vector<Heading> headings = CsvHeadingsOf(petra_.Headings(), options_);
    claims_.position_log = NamePositions(headings);
    MakeColumns(headings);
    petra_headings_ = petra_.Headings();
    BeginPetraWell();
  }

  // `petra_` itself has no columns yet while those of a further well are being named.
  bool IsPetra() const { return !petra_headings_.empty(); }

  // Another well begins; its columns and units must be those of the first.
  void TakeKeywords(const std::vector<std::string>& fields) {
    std::string line;
    for (const std::string& field : fields) line += (line.empty() ? "" : " ") + field;
    petra_.Take(line, lines_);
    if (EqualNoCase(fields.front(), "*WELL")) {
      ended_ = false;  // a blank line ended the well above
      BeginPetraWell();
    }
    keywords_again_ = true;
  }

  void BeginPetraWell() {
    wells_.push_back(petra_.well());
    other_well_ = !options_.well.empty() && petra_.well() != options_.well;
    if (wells_.size() > 1 && options_.well.empty()) {
      lines_.Complain(FaultCode::kConflict, "several wells in one file" + WellsText().substr(14) +
                                                "; say which by --well");
    }
  }

  // What samples of sensors should be called, where the first line seems to name some.
  std::string SensorHint() const {
    const std::string first = Lower(first_line_);
    const bool sensors =
        first.find("gyro") != std::string::npos || first.find("acc") != std::string::npos ||
        (first.find("time") != std::string::npos && first.find("gx") != first.npos);
    if (!sensors) return {};
    return "; a table of samples is for survey --from, with headings TOOL[s] or UTC[us], "
           "GX[deg/h], "
           "GY[deg/h], AX[m/s2], AY[m/s2], AZ[m/s2]; units deg/s, rad/s, g and mg serve too";
  }

  void TakePreamble(std::string_view line) {
    const std::size_t colon = line.find(':');
    if (colon != std::string_view::npos) {
      TakePair(head(), line.substr(0, colon), line.substr(colon + 1));
    }
  }

  // The whole line: a tab at its begin stands behind an empty first column, as in the rows.
  bool TakeHeader(std::string_view line) {
    for (const char delimiter : {',', ';', '\t', ' '}) {
      const auto fields =
          delimiter == ' ' ? SpacedNames(line, WidthBelow()) : SplitQuoted(line, delimiter);
      if (!fields || std::any_of(fields->begin(), fields->end(),
                                 [](const auto& f) { return NumberOf(f).has_value(); })) {
        continue;
      }
      std::vector<Heading> headings = CsvHeadingsOf(*fields, options_);
      // "Depth" twice is the lower half of "Measured Depth" and "Vertical Depth".
      const auto depths = std::count_if(headings.begin(), headings.end(),
                                        [](const Heading& h) { return h.column == Column::kMd; });
      if (depths > 1 && !above_.empty()) continue;
      claims_.position_log = NamePositions(headings);
      if (!NameStations(headings) && !claims_.position_log) continue;
      delimiter_ = delimiter;
      TakeUnitLine(headings);
      MakeColumns(headings);
      return true;
    }
    return false;
  }

  // Fields of the first row of numbers below the line last read, if there is one near it.
  std::optional<std::size_t> WidthBelow() {
    const std::string ahead = lines_.Ahead();
    std::size_t at = 0;
    for (int below = 0; below < kMostLinesBelow && at < ahead.size(); ++below) {
      const std::size_t end = std::min(ahead.find('\n', at), ahead.size());
      const std::string line(Trim(std::string_view(ahead).substr(at, end - at)));
      at = end + 1;
      const auto fields = SplitQuoted(line, ' ');
      if (fields && AreNumbers(*fields, line, ' ')) return fields->size();
    }
    return std::nullopt;
  }

  // A second line may hold the units.
  void TakeUnitLine(std::vector<Heading>& headings) {
    std::vector<std::string> next;
    if (!NextRecord(next)) return;
    const bool units =
        !IsBlank(next) && next.size() <= headings.size() &&
        std::all_of(next.begin(), next.end(), [](const auto& f) { return !NumberOf(f); }) &&
        std::any_of(next.begin(), next.end(), IsCsvUnit);
    if (!units) return lines_.Back();
    for (std::size_t i = 0; i < next.size(); ++i) {
      const Heading cell = HeadingOf("x" + next[i]);
      if (!headings[i].unit.empty() || LettersAndDigits(next[i]).empty()) continue;
      headings[i].unit = cell.unit.empty() ? next[i] : cell.unit;
    }
  }

  bool AreNumbers(const std::vector<std::string>& fields, std::string_view line, char delimiter) {
    const CommaUse use = CommaUseOf(line, delimiter);
    std::size_t numbers = 0;
    for (const std::string& field : fields) {
      if (IsNothing(TrimCell(field))) continue;
      if (!NumberIn(field, use == CommaUse::kUnclear ? CommaUse::kDecimal : use)) return false;
      ++numbers;
    }
    return numbers >= 3;
  }

  // No header line at all: columns by number, and the line is the first station.
  bool TakeHeaderless(std::string_view line) {
    for (const auto& [canonical, name] : options_.columns) {
      if (!IntegerOf(name)) return false;
    }
    for (const char delimiter : {'\t', ';', ',', ' '}) {
      const auto fields = SplitQuoted(line, delimiter);
      if (!fields || fields->size() < 3 || !AreNumbers(*fields, line, delimiter)) continue;
      delimiter_ = delimiter;
      lines_.Back();
      MakeColumns(CsvHeadingsOf(std::vector<std::string>(fields->size()), options_));
      return true;
    }
    return false;
  }

  // Headings in several lines, known by the numbers that follow.
  bool TakeHeadingsAbove(std::string_view line) {
    if (above_.empty()) above_ = before_blank_;  // a blank line between heading and numbers
    if (above_.empty()) return false;
    for (const char delimiter : {'\t', ';', ',', ' '}) {
      const auto fields = SplitQuoted(line, delimiter);
      if (!fields || fields->size() < 3 || !AreNumbers(*fields, line, delimiter)) continue;
      const std::vector<Heading> headings = BestHeadings(std::string(line), delimiter);
      if (headings.empty()) continue;
      delimiter_ = delimiter;
      lines_.Back();
      MakeColumns(headings);
      return true;
    }
    return false;
  }

  // By as many of the lines above as name the most different columns: more of them may be the end
  // of a head.
  std::vector<Heading> BestHeadings(const std::string& line, char delimiter) const {
    std::vector<Heading> best;
    std::size_t most = 0;
    for (std::size_t from = above_.size(); from-- > 0;) {
      const std::vector<std::string> lines(above_.begin() + static_cast<std::ptrdiff_t>(from),
                                           above_.end());
      std::vector<Heading> headings = MergedHeadings(lines, line, delimiter, options_);
      std::set<Column> named;
      for (const Heading& h : headings) {
        if (h.column) named.insert(*h.column);
      }
      if (!NameStations(headings) || named.size() <= most) continue;
      most = named.size();
      best = std::move(headings);
    }
    return best;
  }

  void MakeColumns(const std::vector<Heading>& headings) {
    const std::string unused = UnusedColumn(headings, options_);
    if (!unused.empty()) lines_.Complain(FaultCode::kConflict, unused);
    columns_ = CsvColumnsOf(headings, options_, head(), claims_, lines_);
    for (std::size_t i = 0; i < columns_.all.size(); ++i) {
      const CsvColumn& c = columns_.all[i];
      if (c.well && !well_column_) well_column_ = i;
      if (c.column || c.text || c.status || c.well) least_fields_ = i + 1;
    }
    if (options_.decimal_comma) {
      commas_ = *options_.decimal_comma ? CommaUse::kDecimal : CommaUse::kThousands;
    } else {
      commas_ = CommaUseOf(lines_.Ahead(), delimiter_);
    }
    if (head().offsets == North::kUnknown) head().offsets = head().azimuth.north;
  }

  void TakeFootnote(const std::vector<std::string>& fields) {
    std::string text;
    for (const std::string& field : fields) {
      if (NumberOf(field) && text.empty()) {
        lines_.Complain(FaultCode::kSyntax,
                        "numbers after the blank line that ended the table: take that line out, or "
                        "what follows it");
      }
      if (!field.empty()) text += (text.empty() ? "" : " ") + field;
    }
    AddRemark(head(), text);
  }

  std::string WellsText() const {
    std::string text = ": the file has";
    for (const std::string& well : wells_) {
      text += (well == wells_.front() ? " " : ", ") + well;
    }
    return text;
  }

  // Rows of wells other than the one asked for.
  bool OfAnotherWell(const std::vector<std::string>& fields) {
    if (other_well_) return true;
    if (keywords_again_ && petra_.Headings() != petra_headings_) {
      lines_.Complain(FaultCode::kConflict, "columns or units that differ from the first well's");
    }
    keywords_again_ = false;
    if (!well_column_ || *well_column_ >= fields.size()) return false;
    const std::string well(TrimCell(fields[*well_column_]));
    const bool known = std::find(wells_.begin(), wells_.end(), well) != wells_.end();
    if (!known && wells_.size() < 20) wells_.push_back(well);
    if (!options_.well.empty()) return well != options_.well;
    if (wells_.size() > 1) {
      std::vector<std::string> more;
      while (wells_.size() < 20 && NextRecord(more)) {
        if (*well_column_ >= more.size()) continue;
        const std::string next(TrimCell(more[*well_column_]));
        if (next.empty() || std::find(wells_.begin(), wells_.end(), next) != wells_.end()) continue;
        wells_.push_back(next);
      }
      lines_.Complain(FaultCode::kConflict, "several wells in one file" + WellsText().substr(14) +
                                                "; say which by --well");
    }
    return false;
  }

  std::optional<double> Number(const std::vector<std::string>& fields, std::size_t i) {
    if (i >= fields.size()) {
      lines_.Complain(FaultCode::kSyntax,
                      fmt::format("{} fields, and column {} is needed", fields.size(), i + 1));
    }
    const std::string_view cell = TrimCell(fields[i]);
    const auto number = NumberIn(cell, commas_);
    if (number) return number;
    if (commas_ == CommaUse::kUnclear && NumberIn(cell, CommaUse::kDecimal)) {
      lines_.Complain(FaultCode::kSyntax,
                      fmt::format("the comma in '{}' may be a decimal one or part thousands: say "
                                  "--decimal comma or --decimal point",
                                  cell),
                      static_cast<int>(i) + 1);
    }
    lines_.Complain(FaultCode::kSyntax, fmt::format("'{}' is not a number", cell.substr(0, 40)),
                    static_cast<int>(i) + 1);
  }

  // A number, or nothing where the cell says so; `i` may lie behind a row that is cut.
  std::optional<double> Maybe(const std::vector<std::string>& fields, std::size_t i) {
    const std::string_view cell = i < fields.size() ? TrimCell(fields[i]) : "?";
    if (IsNothing(cell) && !EqualNoCase(cell, "nan")) return std::nullopt;
    return Number(fields, i);
  }

  RowStatus StatusIn(const std::vector<std::string>& fields) {
    RowStatus status = RowStatus::kSurveyed;
    for (std::size_t i = 0; i < std::min(fields.size(), columns_.all.size()); ++i) {
      if (!columns_.all[i].status || fields[i].empty()) continue;
      const auto word = RowStatusOf(fields[i]);
      if (!word) lines_.Complain(FaultCode::kSyntax, "'" + fields[i] + "' is no status");
      status = *word;
    }
    return status;
  }

  // Fields beyond the header's must be empty. Fewer are a row that is cut, whose last number may
  // lack digits; between blanks an empty cell leaves nothing that could be counted.
  void CheckWidth(const std::vector<std::string>& fields) {
    const std::size_t wanted = columns_.all.size();
    const bool more = fields.size() > wanted &&
                      std::any_of(fields.begin() + static_cast<std::ptrdiff_t>(wanted),
                                  fields.end(), [](const auto& f) { return !f.empty(); });
    const bool fewer = delimiter_ != ' ' && fields.size() < least_fields_;
    if (more || fewer) {
      lines_.Complain(FaultCode::kSyntax,
                      fmt::format("{} fields where the header has {}", fields.size(), wanted));
    }
  }

  void TakeRow(const std::vector<std::string>& fields) {
    CheckWidth(fields);
    const std::vector<CsvColumn>& all = columns_.all;
    std::optional<double> inclination, azimuth;
    if (claims_.position_log) {
      inclination = azimuth = 0;  // until they are computed
    } else {
      inclination = Maybe(fields, *columns_.inclination);
      azimuth = Maybe(fields, *columns_.azimuth);
      if (inclination) inclination = InclinationOf(*inclination, all[*columns_.inclination].factor);
      if (azimuth) azimuth = AzimuthOf(*azimuth, all[*columns_.azimuth].factor);
    }
    const auto problem = build_.Add(*Number(fields, *columns_.md) * all[*columns_.md].factor,
                                    inclination, azimuth, StatusIn(fields));
    if (problem) lines_.Complain(problem->code, problem->text);
    for (std::size_t i = 0; i < std::min(fields.size(), all.size()); ++i) {
      const CsvColumn& c = all[i];
      const bool attitude = c.column && *c.column <= Column::kAzimuth;
      if (fields[i].empty() || attitude) continue;
      if (c.text) build_.Set(*c.text, fields[i]);
      if (!c.column || IsNothing(TrimCell(fields[i]))) continue;
      const double number = *Number(fields, i);
      // What stands for nothing among positions, the positions' own witness tells.
      if (*c.column > Column::kTvdSubSea && StandsForNothing(number)) continue;
      build_.Set(*c.column, ValueOf(c.quantity, number, c.factor));
    }
  }

  LineReader& lines_;
  const ReadOptions& options_;
  Claims& claims_;
  TableBuilder build_;
  CsvColumns columns_;
  std::vector<std::string> above_, before_blank_, wells_, petra_headings_;
  PetraHead petra_;
  std::string first_line_;
  std::optional<std::size_t> well_column_;
  std::size_t least_fields_ = 0;  // up to the last column of a known meaning
  char delimiter_ = ',';
  CommaUse commas_ = CommaUse::kNone;
  bool ended_ = false, other_well_ = false, keywords_again_ = false;
};

}  // namespace

SurveyTable ReadCsv(LineReader& lines, const ReadOptions& options, Claims& claims) {
  return CsvReader(lines, options, claims).Read();
}

}  // namespace wellgyro

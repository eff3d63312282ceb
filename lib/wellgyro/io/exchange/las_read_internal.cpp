#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/exchange/csv_columns_internal.h"
#include "wellgyro/io/exchange/headings_internal.h"
#include "wellgyro/io/exchange/las_internal.h"
#include "wellgyro/io/exchange/survey_words_internal.h"
#include "wellgyro/io/exchange/table_build_internal.h"
#include "wellgyro/io/text_internal.h"

namespace wellgyro {
namespace {

// A header line: MNEM.UNIT DATA : DESCRIPTION, parted at the first dot, the first blank after it
// and the last colon.
struct LasLine {
  std::string mnemonic, unit, data;
};

std::optional<LasLine> HeaderLine(std::string_view line) {
  const std::size_t dot = line.find('.');
  if (dot == std::string_view::npos) return std::nullopt;
  // Some writers leave the colon out where there is no description.
  std::size_t colon = line.rfind(':');
  if (colon == std::string_view::npos || colon < dot) colon = line.size();
  std::string_view rest = line.substr(dot + 1, colon - dot - 1);
  const std::size_t unit_end = std::min(rest.find_first_of(" \t"), rest.size());
  std::string_view unit = rest.substr(0, unit_end);
  if (unit.starts_with('[') && unit.ends_with(']')) unit = unit.substr(1, unit.size() - 2);
  return LasLine{std::string(Trim(line.substr(0, dot))), std::string(unit),
                 las::FromDataText(Trim(rest.substr(unit_end)))};
}

struct Curve {
  std::optional<Column> column;
  Quantity quantity = Quantity::kNumber;
  double factor = 1;
};

class LasReader {
 public:
  LasReader(LineReader& lines, const ReadOptions& options, Claims& claims)
      : lines_(lines), options_(options), claims_(claims) {}

  SurveyTable Read() {
    std::string_view line;
    while (lines_.Next(line)) {
      const std::string_view text = Trim(line);
      if (text.empty() || text.front() == '#') continue;
      if (text.front() == '~') {
        Section(text);
      } else if (section_ == 'A') {
        Data(text);
      } else {
        Header(text);
      }
    }
    if (section_ != 'A' && !data_seen_) {
      lines_.Complain(FaultCode::kForeign,
                      lines_.number() == 0 ? "this file is empty"
                      : third_             ? "no section of a survey's data: no ~Inclinometry_Data"
                                           : "no section ~A: no data");
    }
    if (!pending_.empty()) lines_.Complain(FaultCode::kSyntax, "the last row is cut short");
    if (build_.table.rows() == 0) lines_.Complain(FaultCode::kForeign, "not a single station");
    if (!third_ || !inclinometry_) CheckEnds();
    if (third_ && inclinometry_ && !lines_.certified()) {
      head().notes.emplace_back(
          "nothing in it says where the survey ends: a cut could not be seen");
    }
    if (const auto problem = build_.Finish()) lines_.Complain(problem->code, problem->text);
    return std::move(build_.table);
  }

 private:
  SurveyHead& head() { return build_.table.head; }

  void Section(std::string_view text) {
    if (third_) return ThirdSection(text);
    if (section_ == 'A') lines_.Complain(FaultCode::kSyntax, "a section after ~A, the last one");
    section_ = text.size() > 1 ? static_cast<char>(text[1] & ~0x20) : ' ';
    if (section_ == 'A') CheckCurves();
  }

  // LAS 3.0: groups of a section of parameters, one that defines columns and one of data each, in
  // any order. The survey is the group Inclinometry; without it, the log, where that has a survey's
  // curves. All others are passed over.
  void ThirdSection(std::string_view text) {
    const std::string name = Lower(text.substr(1, text.find_first_of(" |[", 1) - 1));
    const bool survey = name.starts_with("inclinometry");
    section_ = 'X';
    if (name.starts_with("v")) section_ = 'V';
    if (name.starts_with("w")) section_ = 'W';
    if (survey && !inclinometry_) StartAgain();
    inclinometry_ = inclinometry_ || survey;
    const bool log = name == "curve" || name == "ascii" || name == "a" || name == "c" ||
                     name.starts_with("log_");
    if (name.starts_with("o")) section_ = 'O';
    if (name == "parameter" || name == "p" || name.ends_with("_parameter")) section_ = 'P';
    if (!survey && (!log || inclinometry_)) return;
    if (name == "curve" || name == "c" || name.ends_with("_definition")) section_ = 'C';
    if (name == "ascii" || name == "a" || name.ends_with("_data")) section_ = 'A';
    if (section_ != 'A') return;
    data_seen_ = survey || HasCurves();
    if (survey) CheckCurves();
    if (survey && build_.table.rows() > 0) {
      lines_.Complain(FaultCode::kConflict, "several surveys in one file, which are not parted");
    }
    if (!data_seen_) section_ = 'X';
    if (head().offsets == North::kUnknown) head().offsets = head().azimuth.north;
  }

  // What the log's curves brought gives way to the survey's own.
  void StartAgain() {
    SurveyHead kept = std::move(head());
    build_ = TableBuilder();
    head() = std::move(kept);
    curves_.clear();
    headings_.clear();
    pending_.clear();
    azimuth_seen_ = false;
    first_index_.reset();
  }

  bool HasCurve(Column column) const {
    return std::any_of(curves_.begin(), curves_.end(),
                       [&](const Curve& c) { return c.column == column; });
  }
  bool HasCurves() const {
    return HasCurve(Column::kMd) && HasCurve(Column::kInclination) && HasCurve(Column::kAzimuth);
  }

  void Header(std::string_view text) {
    if (section_ == 'X') return;
    const auto line = HeaderLine(text);
    if (section_ == 'O') {
      if (head().remarks.size() < 1000) head().remarks.push_back(las::FromDataText(text));
      return;
    }
    if (!line) lines_.Complain(FaultCode::kSyntax, "no line of the form MNEM.UNIT DATA : TEXT");
    if (section_ == 'V') return Version(*line);
    if (section_ == 'W') return Well(*line);
    if (section_ == 'C') return AddCurve(*line);
    if (section_ == 'P') return Parameter(*line);
  }

  void Version(const LasLine& line) {
    if (line.mnemonic == "VERS") {
      const auto version = NumberOf(line.data);
      third_ = version && *version >= 3 && *version < 3.1;
      if (!third_ && (!version || *version < 1.2 || *version > 2.1)) {
        lines_.Complain(FaultCode::kForeign, "LAS " + line.data + " is neither LAS 2.0 nor 3.0");
      }
    }
    if (line.mnemonic == "DLM") TakeDelimiter(line.data);
    if (line.mnemonic == "WRAP") wrap_ = EqualNoCase(line.data, "YES");
  }

  void TakeDelimiter(std::string_view word) {
    if (word.empty() || EqualNoCase(word, "SPACE")) {
      delimiter_ = ' ';
    } else if (EqualNoCase(word, "COMMA")) {
      delimiter_ = ',';
    } else if (EqualNoCase(word, "TAB")) {
      delimiter_ = '\t';
    } else {
      lines_.Complain(FaultCode::kSyntax, "a delimiter that is none of SPACE, COMMA and TAB");
    }
  }

  void Well(const LasLine& line) {
    if (line.mnemonic == "NULL") {
      null_ = NumberOf(line.data);
    } else if (line.mnemonic == "STRT") {
      start_ = NumberOf(line.data);
      start_unit_ = line.unit;
    } else if (line.mnemonic == "STOP") {
      stop_ = NumberOf(line.data);
    } else if (line.mnemonic == "STEP") {
      step_ = NumberOf(line.data);
    }
    for (const las::WellKey& key : las::kWellKeys) {
      if (key.mnemonic == line.mnemonic) head().names.*key.member = line.data;
    }
  }

  void Parameter(const LasLine& line) {
    for (const las::ParameterKey& p : las::kParameters) {
      if (p.mnemonic != line.mnemonic || line.data.empty()) continue;
      if (!TakePair(head(), p.key, InItsUnit(p, line))) {
        lines_.Complain(FaultCode::kSyntax, fmt::format("{}: '{}' is none", p.text, line.data));
      }
    }
  }

  // Elevations may stand in feet.
  static std::string InItsUnit(const las::ParameterKey& p, const LasLine& line) {
    const LengthUnit unit = LengthUnitOf(line.unit).value_or(LengthUnit::kMetre);
    const auto number = NumberOf(line.data);
    if (p.unit != "M" || unit == LengthUnit::kMetre || !number) return line.data;
    return Exact(*number * FactorOf(unit));
  }

  void AddCurve(const LasLine& line) {
    Curve curve;
    Heading heading = HeadingOf(line.mnemonic);
    for (const ColumnInfo& info : AllColumns()) {
      if (!heading.column && EqualNoCase(info.las, line.mnemonic)) heading.column = info.column;
    }
    // The first curve is the index, which need not say so.
    if (curves_.empty() && EqualNoCase(line.mnemonic, "INDEX")) heading.column = Column::kMd;
    TakeOption(heading, line);
    headings_.push_back(heading);
    if (heading.column == Column::kAzimuth) heading.column = AzimuthColumn(heading.north);
    const bool twice =
        heading.column && std::any_of(curves_.begin(), curves_.end(),
                                      [&](const Curve& c) { return c.column == heading.column; });
    if (heading.column && !twice) {
      TakeCurve(curve, *heading.column, line.unit);
    } else if (twice) {
      head().notes.push_back(fmt::format("{} gives {} once more: it is left out", line.mnemonic,
                                         InfoOf(*heading.column).text));
    }
    curves_.push_back(curve);
  }

  // An option names a curve by its mnemonic or its number, and wins over what others are called.
  void TakeOption(Heading& heading, const LasLine& line) const {
    for (const auto& [canonical, name] : options_.columns) {
      Heading want = HeadingOf(canonical);
      const bool here = EqualNoCase(name, line.mnemonic) ||
                        IntegerOf(name) == static_cast<int>(curves_.size()) + 1;
      if (here) {
        heading = want;
        heading.told = true;
      } else if (heading.column == want.column && heading.north == want.north && !heading.told) {
        heading.column.reset();
      }
    }
  }

  void TakeCurve(Curve& curve, Column column, std::string unit) {
    curve.quantity = InfoOf(column).quantity;
    if (unit.empty()) return WithoutUnit(curve, column);
    auto factor = FactorOf(curve.quantity, unit);
    if (!factor) {
      if (column > Column::kAzimuth) return;
      lines_.Complain(FaultCode::kSyntax, NoUnit(curve.quantity, unit, InfoOf(column).text));
    }
    // An option for the unit of depth wins for what stands in the file's unit of depth.
    const auto length = LengthUnitOf(unit);
    if (column == Column::kMd) TakeIndexUnit(length);
    if (options_.depth_unit && curve.quantity == Quantity::kLength && length == md_unit_) {
      if (column == Column::kMd && length && *length != *options_.depth_unit) {
        head().notes.push_back(
            fmt::format("depths are taken in {} as told, though the file says {}",
                        WordOf(*options_.depth_unit), WordOf(*length)));
      }
      factor = FactorOf(*options_.depth_unit);
      unit = WordOf(*options_.depth_unit);
    }
    curve.column = column;
    curve.factor = *factor;
    TakeUnits(column, unit);
  }

  // STRT, STOP and STEP stand in the unit of the index; where they do not, one of both is wrong. In
  // LAS 3.0 they are the log's, not those of a survey beside it.
  void TakeIndexUnit(std::optional<LengthUnit> unit) {
    md_unit_ = unit;
    const auto start = LengthUnitOf(start_unit_);
    if (third_ || options_.depth_unit || !unit || !start || *unit == *start) return;
    lines_.Complain(FaultCode::kConflict,
                    fmt::format("its depths are in {}, but STRT and STOP in {}: say --depth-unit",
                                WordOf(*unit), WordOf(*start)));
  }

  // Angles are degrees; lengths are in the unit of the index, which may be told.
  void WithoutUnit(Curve& curve, Column column) {
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
          const auto unit = options_.depth_unit ? options_.depth_unit : LengthUnitOf(start_unit_);
          claims_.md_unit = unit.has_value();
          if (unit) head().md_unit = head().grid_unit = *unit;
        } else {
          claims_.open.push_back(column);
        }
        curve.factor = claims_.md_unit ? FactorOf(head().md_unit) : 1;
        return;
      default:
        if (!FactorOf(curve.quantity, "")) curve.column.reset();
    }
  }

  // The north that an option or a curve's name gives, which the parameter I_AT may contradict.
  void TakeNorth(North north, bool told) {
    North& said = head().azimuth.north;
    if (north == North::kUnknown || north == said) return;
    if (said != North::kUnknown) {
      head().notes.push_back(
          fmt::format("azimuths are taken from {} north {}, though the file "
                      "says {}",
                      WordOf(north), told ? "as told" : "as their curve is called", WordOf(said)));
    }
    said = north;
  }

  std::optional<Column> AzimuthColumn(North north) {
    if (!azimuth_seen_) {
      azimuth_seen_ = true;
      TakeNorth(north, headings_.back().told);
      return Column::kAzimuth;
    }
    return SecondAzimuth(north);
  }

  void TakeUnits(Column column, const std::string& unit) {
    const auto length = LengthUnitOf(unit);
    if (column == Column::kMd && length) head().md_unit = *length;
    if ((column == Column::kNorthing || column == Column::kDown) && length) {
      head().grid_unit = *length;
    }
    const auto curvature = column == Column::kDogleg ? CurvatureUnitOf(unit) : std::nullopt;
    if (curvature) head().curvature_unit = *curvature;
  }

  void CheckCurves() {
    const std::string unused = UnusedColumn(headings_, options_);
    if (!unused.empty()) lines_.Complain(FaultCode::kConflict, unused);
    for (const Heading& h : headings_) {
      if (h.told && h.column == Column::kAzimuth) TakeNorth(h.north, true);
    }
    for (const Column column : {Column::kMd, Column::kInclination, Column::kAzimuth}) {
      if (!HasCurve(column)) {
        lines_.Complain(FaultCode::kForeign, fmt::format("no curve of {}", InfoOf(column).text));
      }
    }
    if (curves_.front().column != Column::kMd) {
      lines_.Complain(FaultCode::kSyntax, "the first curve is not measured depth");
    }
    if (head().offsets == North::kUnknown) head().offsets = head().azimuth.north;
  }

  void Data(std::string_view text) {
    std::vector<std::string_view> fields;
    Split(text, delimiter_, fields);
    for (const std::string_view field : fields) {
      const auto number = third_ ? NumberOrNothing(field) : NumberOf(field);
      if (!number) {
        lines_.Complain(FaultCode::kSyntax,
                        fmt::format("'{}' is not a number", field.substr(0, 40)));
      }
      pending_.push_back(*number);
    }
    if (!wrap_ && pending_.size() != curves_.size()) {
      lines_.Complain(FaultCode::kSyntax, fmt::format("{} numbers where ~C names {} curves",
                                                      pending_.size(), curves_.size()));
    }
    if (pending_.size() > curves_.size()) {
      lines_.Complain(FaultCode::kSyntax, "a wrapped row has more numbers than there are curves");
    }
    if (pending_.size() == curves_.size()) Row();
  }

  // In LAS 3.0 a value may be left out, or be text in a column that is none of a survey's.
  std::optional<double> NumberOrNothing(std::string_view field) const {
    constexpr double kNothing = -999.25;
    if (Trim(field).empty()) return null_.value_or(kNothing);
    const std::size_t column = pending_.size();
    const bool other = column < curves_.size() && !curves_[column].column;
    const auto number = NumberOf(field);
    return number || !other ? number : null_.value_or(kNothing);
  }

  void Row() {
    last_index_ = pending_.front();
    if (!first_index_) first_index_ = last_index_;
    std::optional<double> md, inclination, azimuth;
    for (std::size_t i = 0; i < curves_.size(); ++i) {
      const Curve& c = curves_[i];
      if (!c.column || *c.column > Column::kAzimuth || (null_ && pending_[i] == *null_)) continue;
      if (c.column == Column::kMd) md = pending_[i] * c.factor;
      if (c.column == Column::kInclination) inclination = InclinationOf(pending_[i], c.factor);
      if (c.column == Column::kAzimuth) azimuth = AzimuthOf(pending_[i], c.factor);
    }
    // A log has rows where there was no survey: they are left out, and counted.
    if (md) {
      const auto problem = build_.Add(*md, inclination, azimuth);
      if (problem) lines_.Complain(problem->code, problem->text);
      for (std::size_t i = 0; i < curves_.size(); ++i) Keep(curves_[i], pending_[i]);
    }
    pending_.clear();
  }

  void Keep(const Curve& c, double number) {
    if (!c.column || *c.column <= Column::kAzimuth || (null_ && number == *null_)) return;
    if (!null_ && *c.column > Column::kTvdSubSea && StandsForNothing(number)) return;
    build_.Set(*c.column, ValueOf(c.quantity, number, c.factor));
  }

  // A file cut short says so by its own header.
  void CheckEnds() {
    if (!stop_ || !start_ || !step_) {
      lines_.Complain(FaultCode::kSyntax, "~W lacks STRT, STOP or STEP");
    }
    const double reach = 1e-6 * std::max(std::abs(*stop_), 1.0) + 0.5 * std::abs(*step_);
    if (std::abs(last_index_ - *stop_) > std::max(reach, 1e-3)) {
      lines_.Complain(FaultCode::kSize, fmt::format("ends at {} where its header says {}",
                                                    Exact(last_index_), Exact(*stop_)));
    }
  }

  LineReader& lines_;
  const ReadOptions& options_;
  Claims& claims_;
  TableBuilder build_;
  std::vector<Curve> curves_;
  std::vector<Heading> headings_;
  std::vector<double> pending_;
  std::optional<double> null_, start_, stop_, step_, first_index_;
  std::optional<LengthUnit> md_unit_;
  std::string start_unit_;
  double last_index_ = 0;
  char section_ = ' ', delimiter_ = ' ';
  bool wrap_ = false, azimuth_seen_ = false;
  bool third_ = false, inclinometry_ = false, data_seen_ = false;
};

}  // namespace

SurveyTable ReadLas(LineReader& lines, const ReadOptions& options, Claims& claims) {
  return LasReader(lines, options, claims).Read();
}

}  // namespace wellgyro

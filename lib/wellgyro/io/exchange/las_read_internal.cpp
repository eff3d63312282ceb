#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/core.h>

#include "wellgyro/io/exchange/las_curves_internal.h"
#include "wellgyro/io/exchange/las_internal.h"
#include "wellgyro/io/exchange/survey_words_internal.h"
#include "wellgyro/io/exchange/table_build_internal.h"
#include "wellgyro/io/text_internal.h"

namespace wellgyro {
namespace {

class LasReader {
 public:
  LasReader(LineReader& lines, const ReadOptions& options, Claims& claims)
      : lines_(lines), curves_(lines, options, claims) {}

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
    if (section_ == 'A') curves_.Check(head());
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
    data_seen_ = survey || curves_.MakeSurvey();
    if (survey) curves_.Check(head());
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
    curves_.Clear();
    pending_.clear();
    first_index_.reset();
  }

  void Header(std::string_view text) {
    if (section_ == 'X') return;
    const auto line = las::LineOf(text);
    if (section_ == 'O') {
      AddRemark(head(), las::FromDataText(text));
      return;
    }
    if (!line) lines_.Complain(FaultCode::kSyntax, "no line of the form MNEM.UNIT DATA : TEXT");
    if (section_ == 'V') return Version(*line);
    if (section_ == 'W') return Well(*line);
    if (section_ == 'C') return curves_.Add(*line, start_unit_, !third_, head());
    if (section_ == 'P') return Parameter(*line);
  }

  void Version(const las::Line& line) {
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

  void Well(const las::Line& line) {
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

  void Parameter(const las::Line& line) {
    for (const las::ParameterKey& p : las::kParameters) {
      if (p.mnemonic != line.mnemonic || line.data.empty()) continue;
      if (!TakePair(head(), p.key, InItsUnit(p, line))) {
        lines_.Complain(FaultCode::kSyntax, fmt::format("{}: '{}' is none", p.text, line.data));
      }
    }
  }

  // Elevations may stand in feet.
  static std::string InItsUnit(const las::ParameterKey& p, const las::Line& line) {
    const LengthUnit unit = LengthUnitOf(line.unit).value_or(LengthUnit::kMetre);
    const auto number = NumberOf(line.data);
    if (p.unit != "M" || unit == LengthUnit::kMetre || !number) return line.data;
    return Exact(*number * FactorOf(unit));
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
    if (!wrap_ && pending_.size() != curves_.all().size()) {
      lines_.Complain(FaultCode::kSyntax, fmt::format("{} numbers where ~C names {} curves",
                                                      pending_.size(), curves_.all().size()));
    }
    if (pending_.size() > curves_.all().size()) {
      lines_.Complain(FaultCode::kSyntax, "a wrapped row has more numbers than there are curves");
    }
    if (pending_.size() == curves_.all().size()) Row();
  }

  // In LAS 3.0 a value may be left out, or be text in a column that is none of a survey's.
  std::optional<double> NumberOrNothing(std::string_view field) const {
    constexpr double kNothing = -999.25;  // NULL of the examples of LAS 2.0
    if (Trim(field).empty()) return null_.value_or(kNothing);
    const std::size_t column = pending_.size();
    const bool other = column < curves_.all().size() && !curves_.all()[column].column;
    const auto number = NumberOf(field);
    return number || !other ? number : null_.value_or(kNothing);
  }

  void Row() {
    last_index_ = pending_.front();
    if (!first_index_) first_index_ = last_index_;
    std::optional<double> md, inclination, azimuth;
    for (std::size_t i = 0; i < curves_.all().size(); ++i) {
      const las::Curve& c = curves_.all()[i];
      if (!c.column || *c.column > Column::kAzimuth || (null_ && pending_[i] == *null_)) continue;
      if (c.column == Column::kMd) md = pending_[i] * c.factor;
      if (c.column == Column::kInclination) inclination = InclinationOf(pending_[i], c.factor);
      if (c.column == Column::kAzimuth) azimuth = AzimuthOf(pending_[i], c.factor);
    }
    // A log has rows where there was no survey: they are left out, and counted.
    if (md) {
      const auto problem = build_.Add(*md, inclination, azimuth);
      if (problem) lines_.Complain(problem->code, problem->text);
      for (std::size_t i = 0; i < curves_.all().size(); ++i) Keep(curves_.all()[i], pending_[i]);
    }
    pending_.clear();
  }

  void Keep(const las::Curve& c, double number) {
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
  TableBuilder build_;
  las::Curves curves_;
  std::vector<double> pending_;
  std::optional<double> null_, start_, stop_, step_, first_index_;
  std::string start_unit_;
  double last_index_ = 0;
  char section_ = ' ', delimiter_ = ' ';
  bool wrap_ = false;
  bool third_ = false, inclinometry_ = false, data_seen_ = false;
};

}  // namespace

SurveyTable ReadLas(LineReader& lines, const ReadOptions& options, Claims& claims) {
  return LasReader(lines, options, claims).Read();
}

}  // namespace wellgyro

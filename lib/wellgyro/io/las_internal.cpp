// CWLS LAS 2.0 (1992, with the updates of 2014 and 2017).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/io/headings_internal.h"
#include "wellgyro/io/survey_words_internal.h"
#include "wellgyro/io/table_build_internal.h"
#include "wellgyro/io/text_internal.h"

namespace wellgyro {
namespace {

// Well-information mnemonics and the names they carry.
struct WellKey {
  std::string_view mnemonic, text;
  std::string SurveyIdentity::*member;
};
constexpr std::array kWellKeys{
    WellKey{"COMP", "COMPANY", &SurveyIdentity::operator_name},
    WellKey{"WELL", "WELL", &SurveyIdentity::well},
    WellKey{"FLD", "FIELD", &SurveyIdentity::field},
    WellKey{"LOC", "LOCATION", &SurveyIdentity::structure},
    WellKey{"PROV", "PROVINCE", &SurveyIdentity::region},
    WellKey{"CTRY", "COUNTRY", &SurveyIdentity::country},
    WellKey{"SRVC", "SERVICE COMPANY", &SurveyIdentity::contractor},
    WellKey{"DATE", "SURVEY DATE", &SurveyIdentity::begin},
    WellKey{"UWI", "UNIQUE WELL ID", &SurveyIdentity::uwi},
};

// Parameters after the Inclinometry set of LAS 3.0.
struct ParameterKey {
  std::string_view mnemonic, unit, key, text;
};
constexpr std::array kParameters{
    ParameterKey{"I_AT", "", "north_reference", "AZIMUTH NORTH TYPE"},
    ParameterKey{"I_DC", "DEG", "declination_deg", "MAGNETIC DECLINATION"},
    ParameterKey{"I_DCSRC", "", "declination_source", "DECLINATION MODEL"},
    ParameterKey{"I_DCDATE", "", "declination_date", "DECLINATION DATE"},
    ParameterKey{"I_GC", "DEG", "grid_convergence_deg", "GRID CONVERGENCE"},
    ParameterKey{"I_GSF", "", "grid_scale", "GRID SCALE FACTOR"},
    ParameterKey{"I_GD", "", "datum", "DEPTH DATUM"},
    ParameterKey{"I_RF", "M", "datum_elevation_m", "DATUM ELEVATION"},
    ParameterKey{"I_VR", "", "vertical_reference", "VERTICAL REFERENCE"},
    ParameterKey{"I_CP", "", "method", "COMPUTE METHOD"},
    ParameterKey{"I_CS", "", "crs", "COORDINATE SYSTEM"},
    ParameterKey{"I_VSAZ", "DEG", "section_azimuth_deg", "VERTICAL SECTION AZIMUTH"},
    ParameterKey{"I_TOOL", "", "tool", "SURVEY TOOL CLASS"},
    ParameterKey{"I_EM", "", "error_model", "TOOL ERROR MODEL"},
    ParameterKey{"I_DK", "", "depth_kind", "DEPTH KIND"},
    ParameterKey{"I_SURV", "", "survey", "SURVEY"},
    ParameterKey{"I_WB", "", "wellbore", "WELLBORE"},
    ParameterKey{"I_RIG", "", "rig", "RIG"},
    ParameterKey{"I_JOB", "", "job", "JOB"},
    ParameterKey{"I_END", "", "end", "END OF SURVEY"},
};

// A header line: MNEM.UNIT DATA : DESCRIPTION, parted at the first dot, the first blank after it
// and the last colon.
struct LasLine {
  std::string mnemonic, unit, data;
};

std::optional<LasLine> HeaderLine(std::string_view line) {
  const std::size_t dot = line.find('.');
  const std::size_t colon = line.rfind(':');
  if (dot == std::string_view::npos || colon == std::string_view::npos || colon < dot) {
    return std::nullopt;
  }
  std::string_view rest = line.substr(dot + 1, colon - dot - 1);
  const std::size_t unit_end = std::min(rest.find_first_of(" \t"), rest.size());
  return LasLine{std::string(Trim(line.substr(0, dot))), std::string(rest.substr(0, unit_end)),
                 std::string(Trim(rest.substr(unit_end)))};
}

struct Curve {
  std::optional<Column> column;
  Quantity quantity = Quantity::kNumber;
  double factor = 1;
};

class LasReader {
 public:
  LasReader(LineReader& lines, const ReadOptions& options) : lines_(lines), options_(options) {}

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
    if (section_ != 'A') {
      lines_.Complain(FaultCode::kForeign,
                      lines_.number() == 0 ? "this file is empty" : "no section ~A: no data");
    }
    if (!pending_.empty()) lines_.Complain(FaultCode::kSyntax, "the last row is cut short");
    if (build_.table.rows() == 0) lines_.Complain(FaultCode::kForeign, "not a single station");
    CheckEnds();
    return std::move(build_.table);
  }

 private:
  SurveyHead& head() { return build_.table.head; }

  void Section(std::string_view text) {
    if (section_ == 'A') lines_.Complain(FaultCode::kSyntax, "a section after ~A, the last one");
    section_ = text.size() > 1 ? static_cast<char>(text[1] & ~0x20) : ' ';
    if (section_ == 'A') CheckCurves();
  }

  void Header(std::string_view text) {
    const auto line = HeaderLine(text);
    if (section_ == 'O') {
      head().remarks.emplace_back(text);
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
      if (!version || *version < 1.2 || *version > 2.1) {
        lines_.Complain(FaultCode::kForeign, "LAS " + line.data + " is not LAS 2.0");
      }
    }
    if (line.mnemonic == "WRAP") wrap_ = EqualNoCase(line.data, "YES");
  }

  void Well(const LasLine& line) {
    if (line.mnemonic == "NULL") {
      null_ = NumberOf(line.data);
    } else if (line.mnemonic == "STRT") {
      start_ = NumberOf(line.data);
    } else if (line.mnemonic == "STOP") {
      stop_ = NumberOf(line.data);
    } else if (line.mnemonic == "STEP") {
      step_ = NumberOf(line.data);
    }
    for (const WellKey& key : kWellKeys) {
      if (key.mnemonic == line.mnemonic) head().names.*key.member = line.data;
    }
  }

  void Parameter(const LasLine& line) {
    for (const ParameterKey& p : kParameters) {
      if (p.mnemonic != line.mnemonic || line.data.empty()) continue;
      if (!TakePair(head(), p.key, line.data)) {
        lines_.Complain(FaultCode::kSyntax, fmt::format("{}: '{}' is none", p.text, line.data));
      }
    }
  }

  void AddCurve(const LasLine& line) {
    Curve curve;
    Heading heading = HeadingOf(line.mnemonic);
    for (const auto& [canonical, name] : options_.columns) {
      if (EqualNoCase(name, line.mnemonic)) heading = HeadingOf(canonical);
    }
    for (const ColumnInfo& info : AllColumns()) {
      if (!heading.column && EqualNoCase(info.las, line.mnemonic)) heading.column = info.column;
    }
    // The first curve is the index, which need not say so.
    if (curves_.empty() && EqualNoCase(line.mnemonic, "INDEX")) heading.column = Column::kMd;
    if (heading.column == Column::kAzimuth) heading.column = AzimuthColumn(heading.north);
    const bool twice =
        heading.column && std::any_of(curves_.begin(), curves_.end(),
                                      [&](const Curve& c) { return c.column == heading.column; });
    if (heading.column && !twice) {
      curve.quantity = InfoOf(*heading.column).quantity;
      const auto factor = FactorOf(curve.quantity, line.unit);
      if (factor) {
        curve.column = heading.column;
        curve.factor = *factor;
        TakeUnits(*heading.column, line.unit);
      } else if (*heading.column <= Column::kAzimuth) {
        lines_.Complain(FaultCode::kSyntax, fmt::format("'{}' is no unit of {}", line.unit,
                                                        InfoOf(*heading.column).text));
      }
    }
    curves_.push_back(curve);
  }

  std::optional<Column> AzimuthColumn(North north) {
    if (!azimuth_seen_) {
      azimuth_seen_ = true;
      if (north != North::kUnknown) head().azimuth.north = north;
      return Column::kAzimuth;
    }
    switch (north) {
      case North::kTrue:
        return Column::kAzimuthTrue;
      case North::kGrid:
        return Column::kAzimuthGrid;
      case North::kMagnetic:
        return Column::kAzimuthMagnetic;
      default:
        return std::nullopt;
    }
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
    for (const Column column : {Column::kMd, Column::kInclination, Column::kAzimuth}) {
      const bool there = std::any_of(curves_.begin(), curves_.end(),
                                     [&](const Curve& c) { return c.column == column; });
      if (!there) {
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
    Split(text, ' ', fields);
    for (const std::string_view field : fields) {
      const auto number = NumberOf(field);
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

  void Row() {
    last_index_ = pending_.front();
    if (!first_index_) first_index_ = last_index_;
    std::array<double, 3> station{};
    bool whole = true;
    for (std::size_t i = 0; i < curves_.size(); ++i) {
      const Curve& c = curves_[i];
      if (!c.column || *c.column > Column::kAzimuth) continue;
      whole = whole && !(null_ && pending_[i] == *null_);
      station[static_cast<std::size_t>(*c.column)] = ValueOf(c.quantity, pending_[i], c.factor);
    }
    // A log has rows where there was no survey.
    if (whole) {
      const auto problem = build_.Add(station[0], station[1], station[2]);
      if (problem) lines_.Complain(problem->code, problem->text);
      for (std::size_t i = 0; i < curves_.size(); ++i) {
        const Curve& c = curves_[i];
        if (!c.column || *c.column <= Column::kAzimuth || (null_ && pending_[i] == *null_)) {
          continue;
        }
        build_.Set(*c.column, ValueOf(c.quantity, pending_[i], c.factor));
      }
    }
    pending_.clear();
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
  TableBuilder build_;
  std::vector<Curve> curves_;
  std::vector<double> pending_;
  std::optional<double> null_, start_, stop_, step_, first_index_;
  double last_index_ = 0;
  char section_ = ' ';
  bool wrap_ = false, azimuth_seen_ = false;
};

// LAS 2.0 of 1992 forbids colons in data, and a line break would end the line.
std::string LasData(std::string_view text) {
  std::string clean(text);
  for (char& c : clean) {
    if (c == ':' || c == '\n' || c == '\r') c = ' ';
  }
  return clean;
}

std::string LasUnit(Quantity quantity, const SurveyHead& head) {
  std::string unit = UnitOf(quantity, head);
  for (char& c : unit) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 32) : c;
  return unit;
}

void Entry(std::string& text, std::string_view mnemonic, std::string_view unit,
           std::string_view data, std::string_view description) {
  const std::string start = fmt::format(" {:<9}.{:<9}", mnemonic, unit);
  text += fmt::format("{} {:>20} : {}\n", start, LasData(data), LasData(description));
}

// A number that no column holds, to stand for nothing.
double NullFor(const SurveyTable& table, const std::vector<Column>& columns) {
  for (double null : {-999.25, -9999.25, -99999.25, -999999.25}) {
    bool free = true;
    for (const Column column : columns) {
      const double factor = FactorOf(InfoOf(column).quantity, table.head);
      for (std::size_t row = 0; row < table.rows() && free; ++row) {
        const auto value = table.Get(column, row);
        free = !value || std::abs(*value / factor - null) > 1e-6;
      }
    }
    if (free) return null;
  }
  return -1e30;
}

// The common step of depths in the file's unit, or 0.
double StepOf(const SurveyTable& table, const std::vector<std::size_t>& rows) {
  if (rows.size() < 2) return 0;
  const double factor = FactorOf(table.head.md_unit);
  const auto depth = [&](std::size_t i) { return table.md(rows[i]) / factor; };
  const double n = static_cast<double>(rows.size() - 1);
  const double step = std::round((depth(rows.size() - 1) - depth(0)) / n * 1e6) / 1e6;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double expected = depth(0) + static_cast<double>(i) * step;
    if (std::abs(depth(i) - expected) > 1e-9 * std::max(1.0, std::abs(expected))) return 0;
  }
  return step;
}

}  // namespace

SurveyTable ReadLas(LineReader& lines, const ReadOptions& options) {
  return LasReader(lines, options).Read();
}

std::string WriteLas(const SurveyTable& table, const WriteOptions& options) {
  NeedNorth(table, "LAS");
  const SurveyHead& head = table.head;
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (OnPath(table.status(row))) rows.push_back(row);
  }
  if (rows.empty()) Lacks("LAS", "a station");
  std::vector<Column> columns;
  for (const ColumnInfo& info : AllColumns()) {
    if (table.Has(info.column)) columns.push_back(info.column);
  }
  const double null = NullFor(table, columns);
  const std::string unit = LasUnit(Quantity::kLength, head);
  const double factor = FactorOf(head.md_unit);
  const double step = options.variable_step ? 0 : StepOf(table, rows);

  std::string text = "~VERSION INFORMATION\n";
  Entry(text, "VERS", "", "2.0", "CWLS LOG ASCII STANDARD - VERSION 2.0");
  Entry(text, "WRAP", "", "NO", "ONE LINE PER DEPTH STEP");
  text += "~WELL INFORMATION\n";
  Entry(text, "STRT", unit, Exact(table.md(rows.front()), factor), "START DEPTH");
  Entry(text, "STOP", unit, Exact(table.md(rows.back()), factor), "STOP DEPTH");
  Entry(text, "STEP", unit, Exact(step), "STEP, 0 IF VARIABLE");
  Entry(text, "NULL", "", Exact(null), "NULL VALUE");
  for (const WellKey& key : kWellKeys) {
    Entry(text, key.mnemonic, "", head.names.*key.member, key.text);
  }
  text += "~CURVE INFORMATION\n";
  for (const Column column : columns) {
    const ColumnInfo& info = InfoOf(column);
    std::string description(info.text);
    if (column == Column::kAzimuth) {
      description += fmt::format(" from {} north", WordOf(head.azimuth.north));
    }
    Entry(text, info.las, LasUnit(info.quantity, head), "", description);
  }
  text += "~PARAMETER INFORMATION\n";
  const Pairs pairs = PairsOf(head);
  for (const ParameterKey& p : kParameters) {
    for (const auto& [key, value] : pairs) {
      if (key == p.key) Entry(text, p.mnemonic, p.unit, value, p.text);
    }
  }
  if (!head.remarks.empty()) text += "~OTHER INFORMATION\n";
  for (const std::string& remark : head.remarks) {
    const std::string line = LasData(remark);
    text += (line.starts_with('~') || line.starts_with('#') ? " " : "") + line + "\n";
  }
  text += "~A\n";
  for (const std::size_t row : rows) {
    std::string line;
    for (const Column column : columns) {
      const auto value = table.Get(column, row);
      line += fmt::format(" {:>14}",
                          value ? Exact(InfoOf(column).quantity, *value, head) : Exact(null));
    }
    text += line.substr(1) + "\n";
  }
  return text;
}

}  // namespace wellgyro

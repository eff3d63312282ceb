#include <algorithm>
#include <cmath>
#include <cstddef>

#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/exchange/certificate_internal.h"
#include "wellgyro/io/exchange/p717_internal.h"
#include "wellgyro/io/exchange/p717_record_internal.h"
#include "wellgyro/io/exchange/table_build_internal.h"
#include "wellgyro/io/text_internal.h"

namespace wellgyro {
namespace {

using p717::IsoDate;

constexpr std::size_t kG7Fields = 29;  // of a G7 record, IOGP P7/17

North NorthOfType(std::string_view name) {
  const std::string lower = Lower(name);
  if (lower.find("grid") != std::string::npos) return North::kGrid;
  if (lower.find("true") != std::string::npos) return North::kTrue;
  if (lower.find("magn") != std::string::npos) return North::kMagnetic;
  return North::kUnknown;
}

SurveyTool ToolOfType(std::string_view type) {
  const std::string lower = Lower(type);
  if (lower == "gyro" || lower == "inertial") return SurveyTool::kGyroContinuous;
  if (lower == "magnetic") return SurveyTool::kMagneticMwd;
  if (lower.starts_with("inclination")) return SurveyTool::kInclinationOnly;
  return SurveyTool::kUnknown;
}

class P717Reader {
 public:
  explicit P717Reader(LineReader& lines) : lines_(lines) {}

  SurveyTable Read() {
    std::string_view line;
    while (lines_.Next(line)) Take(line);
    if (!identified_) {
      lines_.Complain(FaultCode::kForeign,
                      lines_.number() == 0 ? "this file is empty" : "does not begin with IOGP,");
    }
    if (build_.table.rows() == 0 && head().gyro_raw.empty()) {
      lines_.Complain(FaultCode::kForeign, "holds neither a P7 nor a G7 record");
    }
    if (const auto problem = build_.Finish()) lines_.Complain(problem->code, problem->text);
    Conclude();
    return std::move(build_.table);
  }

 private:
  SurveyHead& head() { return build_.table.head; }

  void Take(std::string_view line) {
    const std::string_view text = Trim(line);
    if (text.empty()) return;
    record_.Take(text);
    const std::string_view id = record_.At(0);
    if (!identified_ && id != "IOGP") {
      lines_.Complain(FaultCode::kForeign, "the first record is not IOGP,: this is no P7/17 file");
    }
    if (id == "IOGP") return Identification();
    if (id == "P7") return Station();
    if (id == "G7") return GyroRaw();
    if (id == "O7") return Object();
    if (id == "HC") return CommonHeader();
    if (id == "H7") return Header();
    if (id == "CC" || id == "C7") return Comment(line);
    if (id == "M7") return;
    // Decoration, as the user guide's example B has it, but never a record that is not known.
    const bool record = record_.size() > 2 && id.size() == 2 && id[0] >= 'A' && id[0] <= 'Z';
    if (record) lines_.Complain(FaultCode::kSyntax, fmt::format("no record is called {}", id));
  }

  void Identification() {
    if (record_.At(2) != "7") lines_.Complain(FaultCode::kForeign, "an IOGP file, but not of P7");
    identified_ = true;
    head().names.created =
        IsoDate(record_.At(5)) + (record_.At(6).empty() ? "" : "T" + record_.Text(6) + "Z");
    if (record_.At(5).empty()) head().names.created.clear();
    head().names.author = record_.Text(8);
  }

  void Comment(std::string_view line) {
    std::size_t comma = 0;
    for (int i = 0; i < 4 && comma != std::string_view::npos; ++i) {
      comma = line.find(',', comma + 1);
    }
    if (comma == std::string_view::npos) return;
    const std::string_view text = Trim(line.substr(comma + 1));
    // Rules and column headings are layout.
    const bool words = std::any_of(text.begin(), text.end(), [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    });
    if (words && !CertificateIn(text) && std::count(text.begin(), text.end(), ',') < 5) {
      head().remarks.emplace_back(text);
    }
  }

  void CommonHeader() {
    const std::string key = record_.Text(1) + record_.Text(2) + record_.Text(3);
    if (key == "130" || key == "170") {
      CrsEntry entry{.number = record_.Integer(5, 0),
                     .code = record_.Text(6),
                     .name = record_.Text(7),
                     .version = record_.Text(8),
                     .date = IsoDate(record_.At(9)),
                     .source = record_.Text(10),
                     .text = record_.Text(11)};
      (key == "130" ? head().crs_entries : head().transformations).push_back(std::move(entry));
    } else if (key == "161") {
      const auto unit = LengthUnitOf(record_.At(12));
      if (!unit) return;
      const std::string direction = Lower(record_.At(9));
      if (direction == "down" || direction == "up") vertical_ = FactorOf(*unit);
      if (direction == "north" || direction == "east") head().grid_unit = *unit;
    }
  }

  void Header() {
    const std::string key = record_.Text(1) + record_.Text(2) + record_.Text(3);
    SurveyIdentity& names = head().names;
    if (key == "100") {
      names.field = record_.Text(6);
      names.region = record_.Text(7);
      names.country = record_.Text(8);
      names.country_code = record_.Text(9);
    } else if (key == "110") {
      names.structure = record_.Text(6);
      for (std::size_t i = 9; i < record_.size(); ++i) {
        const std::string lower = Lower(record_.At(i));
        if (lower == "onshore" || lower == "offshore") names.structure_kind = record_.Text(i);
      }
    } else if (key == "120") {
      names.uwi = record_.Text(9);
      names.well = record_.Text(10);
    } else if (key == "130") {
      names.uwi_wellbore = record_.Text(7);
      names.wellbore = record_.Text(8);
    } else if (key == "140") {
      names.rig = record_.Text(6);
      head().datum = record_.At(7) == "ZDP" ? record_.Text(10) : record_.Text(7);
      if (record_.At(7) != "ZDP") head().datum_elevation = record_.Maybe(8, vertical_);
    } else if (key == "150") {
      Survey();
    } else if (key == "151") {
      SurveyDetails();
    } else if (key == "152") {
      SurveyRun& run = Run(record_.Integer(5, 1));
      run.operator_name = record_.Text(6);
      run.contractor = record_.Text(7);
      run.job = record_.Text(8);
    } else if (key == "300") {
      geomagnetic_ = record_.Text(7);
    } else if (key == "400") {
      ObjectDefinition();
    } else if (key == "500") {
      TableDefinition();
    } else if (key == "600") {
      error_models_.emplace_back(record_.Integer(5, 0), record_.Text(6));
    }
  }

  SurveyRun& Run(int number) {
    for (SurveyRun& run : head().runs) {
      if (run.number == number) return run;
    }
    head().runs.push_back({.number = number});
    return head().runs.back();
  }

  void Survey() {
    SurveyRun& run = Run(record_.Integer(5, 1));
    run.name = record_.Text(8);
    run.tool = ToolOfType(record_.At(9));
    run.begin = IsoDate(record_.At(17));
    run.end = IsoDate(record_.At(18));
    TakeMdUnit(record_.At(16));
    if (md_unit_known_) ends_.emplace_back(run.number, record_.Maybe(15, Md()).value_or(-1));
  }

  // A survey that ends above the depth that its own definition gives.
  void CheckEnds() {
    for (const auto& [number, end] : ends_) {
      double last = -1;
      for (std::size_t row = 0; row < build_.table.rows(); ++row) {
        if (build_.table.Get(Column::kSurvey, row) == number) {
          last = std::max(last, build_.table.md(row));
        }
      }
      if (end < 0 || last >= end - 0.02) continue;
      head().notes.push_back(fmt::format(
          "survey {} ends at MD {:.2f} m, its definition says {:.2f} m", number, last, end));
    }
  }

  void TakeMdUnit(std::string_view name) {
    const auto unit = LengthUnitOf(name);
    if (!unit) return;
    if (md_unit_known_ && *unit != head().md_unit) {
      lines_.Complain(FaultCode::kConflict, "surveys with depths in different units");
    }
    head().md_unit = *unit;
    md_unit_known_ = true;
  }

  void RequireMdUnit() {
    if (md_unit_known_) return;
    lines_.Complain(
        FaultCode::kSyntax,
        fmt::format("a {} record before its survey's definition, H7,1,5,0", record_.At(0)));
  }

  void SurveyDetails() {
    SurveyRun& run = Run(record_.Integer(5, 1));
    const int unit = record_.Integer(6, 0);
    if (md_unit_known_) {
      // The number tells which draft's table the file follows.
      draft_2018_ = draft_2018_ || (p717::UnitName(unit, false) != WordOf(head().md_unit) &&
                                    p717::UnitName(unit, true) == WordOf(head().md_unit));
    } else {
      TakeMdUnit(p717::UnitName(unit, false));
    }
    const std::string kind = Lower(record_.At(8));
    for (std::size_t i = 0; i < p717::kDepthKinds.size(); ++i) {
      if (kind == Lower(p717::kDepthKinds[i])) {
        constexpr std::array kKinds{DepthKind::kDrillPipe, DepthKind::kWireline, DepthKind::kTubing,
                                    DepthKind::kOther};
        run.md_kind = kKinds[i];
      }
    }
    run.md_status = std::clamp(record_.Integer(9, 1), 0, 4);
    run.azimuth.north = NorthOfType(record_.At(13));
    // Examples apply convergence with flag 1; a value without it is there all the same.
    run.azimuth.convergence = record_.Maybe(17, units::kDeg);
    run.azimuth.declination = record_.Maybe(19, units::kDeg);
    run.azimuth.declination_date = IsoDate(record_.At(20));
  }

  PositionObject& ObjectOf(int number) {
    for (PositionObject& object : head().objects) {
      if (object.number == number) return object;
    }
    head().objects.push_back({.number = number});
    return head().objects.back();
  }

  double Md() { return FactorOf(head().md_unit); }
  double Grid() { return FactorOf(head().grid_unit); }

  void ObjectDefinition() {
    PositionObject& object = ObjectOf(record_.Integer(5, 0));
    object.name = record_.Text(6);
    if (const auto* type = p717::TypeOfNumber(record_.Integer(7, 0))) object.kind = type->code;
    object.text = record_.Text(9);
    object.md = record_.Maybe(11, Md());
  }

  void Object() {
    PositionObject& object = ObjectOf(record_.Integer(2, 0));
    object.kind = record_.Text(3);
    object.name = record_.Text(4);
    object.northing = record_.Maybe(5, Grid());
    object.easting = record_.Maybe(6, Grid());
    object.down = record_.Maybe(7, vertical_);
    object.latitude = record_.Maybe(8, units::kDeg);
    object.longitude = record_.Maybe(9, units::kDeg);
    object.latitude_wgs84 = record_.Maybe(10, units::kDeg);
    object.longitude_wgs84 = record_.Maybe(11, units::kDeg);
    object.sigma_horizontal = record_.Maybe(12, Grid());
    object.sigma_vertical = record_.Maybe(13, vertical_);
  }

  void TableDefinition() {
    if (tables_++ > 0) {
      lines_.Complain(FaultCode::kForeign, "a second P7 table: split the file");
    }
    head().method = Lower(record_.At(8));
    head().names.survey = record_.Text(6);
    head().scale = record_.Maybe(12, 1);
    const int count = record_.Integer(14, 0);
    for (int i = 0; i < count; ++i) AddExtension(15 + static_cast<std::size_t>(i));
  }

  struct Field {
    std::optional<Column> column;
    std::optional<TextColumn> text;
    Quantity quantity = Quantity::kNumber;
    double factor = 1;
  };

  void AddExtension(std::size_t i) {
    std::vector<std::string_view> parts;
    Split(record_.At(i), ';', parts);
    if (parts.size() < 3) record_.Odd(i, "is no extension field id;parameter;name;unit");
    Field field;
    for (const p717::Extension& known : p717::Extensions()) {
      if (!EqualNoCase(known.name, parts[2])) continue;
      field.text = known.text;
      field.column = known.column;
    }
    const auto number = parts.size() > 3 ? IntegerOf(parts[3]) : std::nullopt;
    const std::string_view unit = number ? p717::UnitName(*number, draft_2018_) : "";
    if (field.column) {
      field.quantity = InfoOf(*field.column).quantity;
      auto factor = FactorOf(field.quantity, unit);
      if (!factor &&
          (field.quantity == Quantity::kTemperature || field.quantity == Quantity::kTime)) {
        factor = 1;
      }
      // Convergence is listed without unit, and is in degrees.
      if (!factor && field.quantity == Quantity::kAngle) factor = units::kDeg;
      if (!factor) field.column.reset();
      field.factor = factor.value_or(1);
      if (field.column == Column::kDogleg) {
        if (const auto curvature = CurvatureUnitOf(unit)) head().curvature_unit = *curvature;
      }
    }
    extensions_.push_back(field);
  }

  void Station() {
    if (record_.size() < 13) {
      lines_.Complain(FaultCode::kSyntax, fmt::format("{} fields in a P7 record", record_.size()));
    }
    RequireMdUnit();
    const std::string point = record_.Text(7);
    const RowStatus status = p717::StatusOf(record_.Integer(8, 1), point);
    const auto degrees = record_.Maybe(12, 1);
    const auto problem =
        build_.Add(record_.Needed(10, Md()), record_.Maybe(11, units::kDeg),
                   degrees ? AzimuthOf(*degrees, units::kDeg) : std::nullopt, status);
    if (problem) lines_.Complain(problem->code, problem->text);
    build_.Set(Column::kSurvey, record_.Integer(3, 1));
    if (!record_.At(6).empty()) build_.Set(Column::kObject, record_.Integer(6, 0));
    if (point != "D") build_.Set(TextColumn::kPoint, point);
    Keep(Column::kNorth, 13, Md());
    Keep(Column::kEast, 14, Md());
    Keep(Column::kTvd, 15, Md());
    Keep(Column::kNorthing, 16, Grid());
    Keep(Column::kEasting, 17, Grid());
    Keep(Column::kDown, 18, vertical_);
    Keep(Column::kLatitude, 19, units::kDeg);
    Keep(Column::kLongitude, 20, units::kDeg);
    ErrorModel();
    Extended();
  }

  void Keep(Column column, std::size_t i, double factor) {
    if (const auto value = record_.Maybe(i, factor)) build_.Set(column, *value);
  }

  void ErrorModel() {
    std::string name = record_.Text(5);
    if (name.empty() && !record_.At(4).empty()) {
      for (const auto& [number, model] : error_models_) {
        if (number == record_.Integer(4, 0)) name = model;
      }
    }
    if (name.empty()) return;
    if (head().error_model.empty()) head().error_model = name;
    if (name != head().error_model) build_.Set(TextColumn::kErrorModel, name);
  }

  void Extended() {
    if (extensions_.empty()) return;
    std::vector<std::string_view> parts;
    Split(record_.At(21), ';', parts);
    for (std::size_t i = 0; i < std::min(parts.size(), extensions_.size()); ++i) {
      const Field& field = extensions_[i];
      if (parts[i].empty()) continue;
      if (field.text) build_.Set(*field.text, std::string(parts[i]));
      if (!field.column) continue;
      if (field.quantity == Quantity::kTime) {
        if (const auto utc = p717::TimeOf(parts[i])) build_.Set(*field.column, *utc);
        continue;
      }
      const auto number = NumberOf(parts[i]);
      if (!number) record_.Odd(21, "has an extension that is not a number");
      build_.Set(*field.column, ValueOf(field.quantity, *number, field.factor));
    }
  }

  void GyroRaw() {
    if (record_.size() < kG7Fields - 1) {
      lines_.Complain(FaultCode::kSyntax, fmt::format("{} fields in a G7 record, which has {}",
                                                      record_.size(), kG7Fields));
    }
    RequireMdUnit();
    head().gyro_raw.push_back(p717::GyroRawOf(record_, Md()));
  }

  // The head takes over what its first survey says.
  void Conclude() {
    CheckEnds();
    SurveyHead& h = head();
    h.vertical_reference = "MSL";
    for (const CrsEntry& crs : h.crs_entries) {
      if (crs.number == 2 && !crs.code.empty()) h.crs = "EPSG:" + crs.code;
      if (crs.number == 3) h.vertical_reference = crs.name;
    }
    for (const PositionObject& object : h.objects) {
      if (object.kind == "ZDP" && object.down && !h.datum_elevation) {
        h.datum_elevation = -*object.down;
      }
    }
    if (!h.runs.empty()) {
      SurveyRun& first = h.runs.front();
      for (SurveyRun& run : h.runs) {
        if (run.azimuth.declination) run.azimuth.declination_source = geomagnetic_;
        if (run.azimuth.north != first.azimuth.north) {
          lines_.Complain(FaultCode::kConflict,
                          "surveys whose azimuths count from different norths");
        }
      }
      h.azimuth = first.azimuth;
      h.tool = first.tool;
      h.md_kind = first.md_kind;
      h.names.begin = first.begin;
      h.names.end = first.end;
      h.names.operator_name = first.operator_name;
      h.names.contractor = first.contractor;
      h.names.job = first.job;
    }
    h.offsets = h.azimuth.north;
  }

  LineReader& lines_;
  TableBuilder build_;
  p717::Record record_{lines_};
  std::vector<Field> extensions_;
  std::vector<std::pair<int, std::string>> error_models_;
  std::string geomagnetic_;
  std::vector<std::pair<int, double>> ends_;  // [m]
  double vertical_ = 1;                       // unit of the vertical axis [m]
  int tables_ = 0;
  bool identified_ = false, md_unit_known_ = false, draft_2018_ = false;
};

}  // namespace

SurveyTable ReadP717(LineReader& lines) { return P717Reader(lines).Read(); }

}  // namespace wellgyro

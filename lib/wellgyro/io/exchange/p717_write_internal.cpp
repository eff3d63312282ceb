#include <algorithm>
#include <cmath>
#include <cstddef>

#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/exchange/certificate_internal.h"
#include "wellgyro/io/exchange/p717_internal.h"
#include "wellgyro/io/exchange/table_build_internal.h"

namespace wellgyro {
namespace {

using p717::ColonDate;

// The format parts fields by commas and extension fields by semicolons, and knows no quotes.
std::string PlainField(std::string_view text) {
  std::string plain(text);
  for (char& c : plain) c = c == ',' || c == ';' || c == '\n' || c == '\r' ? ' ' : c;
  return plain;
}

std::string Number(const std::optional<double>& value, double factor) {
  return value ? Exact(*value, factor) : std::string();
}

// A real number as the format's readers tell it from a whole one.
std::string Real(double value, double factor = 1) {
  std::string text = Exact(value, factor);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}
std::string Real(const std::optional<double>& value, double factor = 1) {
  return value ? Real(*value, factor) : std::string();
}

std::string ToolType(SurveyTool tool) {
  switch (tool) {
    case SurveyTool::kGyroContinuous:
    case SurveyTool::kGyroNorthSeeking:
    case SurveyTool::kGyroMwd:
      return "Gyro";
    case SurveyTool::kInclinationOnly:
      return "Inclination-only";
    case SurveyTool::kUnknown:
      return "Utility";
    default:
      return "Magnetic";
  }
}

class P717Writer {
 public:
  explicit P717Writer(const SurveyTable& table) : table_(table), head_(table.head) {
    runs_ = head_.runs;
    if (runs_.empty()) runs_.push_back(OwnRun());
    objects_ = head_.objects;
    if (objects_.empty()) OwnObjects();
    for (const p717::Extension& e : p717::Extensions()) {
      if (e.column ? table.Has(*e.column) : table.Has(*e.text)) extensions_.push_back(&e);
    }
  }

  std::string Write() {
    Systems();
    Names();
    for (const SurveyRun& run : runs_) Survey(run);
    if (!head_.azimuth.declination_source.empty()) {
      Record("H7,3,0,0", "Geomagnetic Model Definition",
             {"1", "", PlainField(head_.azimuth.declination_source), "", ""});
    }
    Objects();
    TableDefinition();
    for (const std::string& remark : head_.remarks)
      text_ += "CC,0,0,0," + PlainField(remark) + "\n";
    for (std::size_t row = 0; row < table_.rows(); ++row) Station(row);
    for (const GyroRawRecord& g : head_.gyro_raw) GyroRaw(g);
    return Identification() + "CC,0,0,0," + CertificateText(table_.rows(), text_) + "\n" + text_;
  }

 private:
  void Record(std::string_view id, std::string_view name, const std::vector<std::string>& fields) {
    text_ += fmt::format("{},{:<54}", id, name);
    for (const std::string& field : fields) text_ += "," + field;
    text_ += '\n';
  }

  SurveyRun OwnRun() const {
    return {.number = 1,
            .name = head_.names.survey.empty() ? "survey" : head_.names.survey,
            .begin = head_.names.begin,
            .end = head_.names.end,
            .contractor = head_.names.contractor,
            .job = head_.names.job,
            .operator_name = head_.names.operator_name,
            .tool = head_.tool,
            .md_kind = head_.md_kind,
            .azimuth = head_.azimuth};
  }

  void OwnObjects() {
    objects_.push_back(
        {.number = 1, .kind = "SRP", .name = Or(head_.names.structure, "structure")});
    objects_.push_back({.number = 2, .kind = "WRP", .name = Or(head_.names.well, "well")});
    objects_.push_back({.number = 3, .kind = "ZDP", .name = Or(head_.datum, "datum")});
    if (head_.datum_elevation) objects_.back().down = -*head_.datum_elevation;
    // The first row lies at the well head where its offsets are zero.
    if (table_.rows() == 0 || std::abs(table_.Get(Column::kNorth, 0).value_or(1)) > 1e-3 ||
        std::abs(table_.Get(Column::kEast, 0).value_or(1)) > 1e-3) {
      return;
    }
    for (PositionObject* o : {&objects_[1], &objects_[2]}) {
      o->northing = table_.Get(Column::kNorthing, 0);
      o->easting = table_.Get(Column::kEasting, 0);
      o->latitude = table_.Get(Column::kLatitude, 0);
      o->longitude = table_.Get(Column::kLongitude, 0);
    }
  }

  static std::string Or(const std::string& text, std::string_view otherwise) {
    return PlainField(text.empty() ? otherwise : std::string_view{text});
  }

  double Md() const { return FactorOf(head_.md_unit); }
  double Grid() const { return FactorOf(head_.grid_unit); }

  std::string Identification() const {
    const std::string& created = head_.names.created;
    const std::size_t t = created.find('T');
    std::string time = t == std::string::npos ? "" : created.substr(t + 1);
    if (time.ends_with('Z')) time.pop_back();
    return fmt::format("IOGP,{},7,1.0,1,{},{},,{}\n", Or(head_.names.well, "survey"),
                       ColonDate(created), time, Or(head_.names.author, "wellgyro"));
  }

  void Systems() {
    std::vector<CrsEntry> entries = head_.crs_entries;
    if (entries.empty()) {
      const std::string code = head_.crs.starts_with("EPSG:") ? head_.crs.substr(5) : std::string();
      entries = {{.number = 1, .code = "", .name = "geographic CRS not stated"},
                 {.number = 2, .code = code, .name = Or(head_.crs, "projected CRS not stated")},
                 {.number = 3, .code = "", .name = Or(head_.vertical_reference, "MSL")},
                 {.number = 4, .code = "4326", .name = "WGS 84"}};
    }
    const auto write = [&](std::string_view id, std::string_view name,
                           const std::vector<CrsEntry>& list) {
      for (const CrsEntry& e : list) {
        Record(
            id, name,
            {std::to_string(e.number), PlainField(e.code), PlainField(e.name),
             PlainField(e.version), ColonDate(e.date), PlainField(e.source), PlainField(e.text)});
      }
    };
    write("HC,1,3,0", "CRS Number/EPSG Code/Name/Source", entries);
    const std::string grid(WordOf(head_.grid_unit));
    const std::string grid_number = std::to_string(p717::UnitNumber(grid));
    Record("HC,1,6,1", "Coordinate System Axis 1",
           {"2", "1", "", "Northing", "north", "N", grid_number, grid});
    Record("HC,1,6,1", "Coordinate System Axis 2",
           {"2", "2", "", "Easting", "east", "E", grid_number, grid});
    Record("HC,1,6,1", "Coordinate System Axis 1",
           {"3", "1", "", "Depth", "down", "D", grid_number, grid});
    write("HC,1,7,0", "Transformation Number/EPSG Code/Name/Source", head_.transformations);
  }

  void Names() {
    const SurveyIdentity& n = head_.names;
    Record("H7,1,0,0", "Project Information",
           {Or(n.field, "project"), PlainField(n.field), PlainField(n.region),
            PlainField(n.country), PlainField(n.country_code)});
    Record("H7,1,1,0", "Structure Definition",
           {"1", Or(n.structure, "structure"), "SRP", NumberOfObject("SRP"), "",
            n.structure_kind == "offshore" ? "2" : "1", PlainField(n.structure_kind), "", "", ""});
    Record("H7,1,2,0", "Well Definition",
           {"1", "1", "WRP", NumberOfObject("WRP"), PlainField(n.uwi), PlainField(n.well), "", "",
            "", "", "As-built", "", ""});
    Record("H7,1,2,1", "Well Details", {"1", "", "", "", "", ""});
    Record("H7,1,3,0", "Wellbore Definition",
           {"1", "1", PlainField(n.uwi_wellbore), PlainField(n.wellbore), "", "", "", "", "Actual",
            "", "", ""});
    Record("H7,1,4,0", "Rig/Workover ZDP Definition",
           {"1", PlainField(n.rig), "ZDP", NumberOfObject("ZDP"), "1", Or(head_.datum, "unknown"),
            "1", "1"});
  }

  std::string NumberOfObject(std::string_view kind) const {
    for (const PositionObject& object : objects_) {
      if (object.kind == kind) return std::to_string(object.number);
    }
    return "1";
  }

  void Survey(const SurveyRun& run) {
    const std::string unit(WordOf(head_.md_unit));
    double first = 0, last = 0;
    bool any = false;
    for (std::size_t row = 0; row < table_.rows(); ++row) {
      if (static_cast<int>(table_.Get(Column::kSurvey, row).value_or(1)) != run.number) continue;
      if (!any) first = table_.md(row);
      last = table_.md(row);
      any = true;
    }
    Record("H7,1,5,0", "Survey Definition",
           {std::to_string(run.number), "1", "1", Or(run.name, "survey"), ToolType(run.tool), "",
            "", "", "", Real(first, Md()), Real(last, Md()), unit, ColonDate(run.begin),
            ColonDate(run.end), "ST=N", "", "", ""});
    Details(run, unit);
    Record("H7,1,5,2", "Operator/Survey Contractor",
           {std::to_string(run.number), PlainField(run.operator_name), PlainField(run.contractor),
            PlainField(run.job)});
  }

  void Details(const SurveyRun& run, const std::string& unit) {
    const std::size_t kind = run.md_kind == DepthKind::kDrillPipe  ? 0
                             : run.md_kind == DepthKind::kWireline ? 1
                             : run.md_kind == DepthKind::kTubing   ? 2
                                                                   : 3;
    std::string azimuth_id = "7", azimuth = "AZIM_TRUE", flag = "1", flag_text = "Surveyed";
    if (run.azimuth.north == North::kMagnetic) {
      azimuth_id = "6", azimuth = "AZIM_MAGN";
    } else if (run.azimuth.north == North::kGrid) {
      azimuth_id = "8", azimuth = "AZIM_GRID", flag = "4", flag_text = "Calculated from AZ_TRUE";
    }
    const auto status = static_cast<std::size_t>(run.md_status);
    Record("H7,1,5,1", "Survey Details",
           {std::to_string(run.number), std::to_string(p717::UnitNumber(unit)),
            std::to_string(kind + 1), std::string(p717::kDepthKinds[kind]), std::to_string(status),
            std::string(p717::kDepthStatuses[status]), "1", azimuth_id, azimuth, flag, flag_text,
            run.azimuth.convergence ? "1" : "0", Number(run.azimuth.convergence, units::kDeg),
            run.azimuth.declination ? "1" : "0", Number(run.azimuth.declination, units::kDeg),
            ColonDate(run.azimuth.declination_date), run.azimuth.declination ? "1" : "", ""});
  }

  void Objects() {
    for (const PositionObject& o : objects_) {
      const p717::ObjectType* type = p717::TypeOfCode(o.kind);
      Record("H7,4,0,0", "Position Object Definition",
             {std::to_string(o.number), PlainField(o.name), std::to_string(type ? type->number : 8),
              std::string(type ? type->name : "Surveyed Data Point"), PlainField(o.text), "1",
              Number(o.md, Md()), "", "", "", "", ""});
    }
    for (const PositionObject& o : objects_) {
      text_ += fmt::format(
          "O7,0,{},{},{},{},{},{},{},{},{},{},{},{}\n", o.number, o.kind, PlainField(o.name),
          Number(o.northing, Grid()), Number(o.easting, Grid()), Number(o.down, Grid()),
          Number(o.latitude, units::kDeg), Number(o.longitude, units::kDeg),
          Number(o.latitude_wgs84, units::kDeg), Number(o.longitude_wgs84, units::kDeg),
          Number(o.sigma_horizontal, Grid()), Number(o.sigma_vertical, Grid()));
    }
  }

  std::string UnitOfExtension(const p717::Extension& e) const {
    if (!e.column) return "-";
    if (!e.unit.empty()) return std::string(e.unit);
    const Quantity quantity = InfoOf(*e.column).quantity;
    if (quantity == Quantity::kCurvature) {
      return head_.curvature_unit == CurvatureUnit::kDegPer100ft ? "deg/100ft" : "deg/30m";
    }
    if (quantity == Quantity::kTime || quantity == Quantity::kRatio) return "-";
    return UnitOf(quantity, head_);
  }

  void TableDefinition() {
    std::vector<std::string> fields{
        "1",
        Or(head_.names.survey, "Definitive Survey"),
        head_.method == "minimum curvature" ? "1" : "",
        head_.method == "minimum curvature" ? "Minimum Curvature" : PlainField(head_.method),
        "",
        "",
        head_.scale ? "1" : "0",
        Number(head_.scale, 1),
        "0",
        std::to_string(extensions_.size())};
    for (const p717::Extension* e : extensions_) {
      fields.push_back(
          fmt::format("{};;{};{}", e->number, e->name, p717::UnitNumber(UnitOfExtension(*e))));
    }
    if (extensions_.empty()) fields.emplace_back();
    Record("H7,5,0,0", "P7 Table Definition", fields);
  }

  std::string Extended(std::size_t row) const {
    std::string text;
    for (const p717::Extension* e : extensions_) {
      if (e != extensions_.front()) text += ';';
      if (e->text) {
        text += PlainField(table_.Get(*e->text, row));
        continue;
      }
      const auto value = table_.Get(*e->column, row);
      if (!value) continue;
      const Quantity quantity = InfoOf(*e->column).quantity;
      if (quantity == Quantity::kTime) {
        text += p717::TimeText(*value);
      } else if (quantity == Quantity::kCurvature) {
        text += Exact(*value, *FactorOf(quantity, UnitOfExtension(*e)));
      } else {
        text += Exact(quantity, *value, head_);
      }
    }
    return text;
  }

  void Station(std::size_t row) {
    const RowStatus status = table_.status(row);
    const int number = p717::NumberOfStatus(status);
    const std::string& point = table_.Get(TextColumn::kPoint, row);
    const auto get = [&](Column column, double factor) {
      return Number(table_.Get(column, row), factor);
    };
    const std::string model = table_.Get(TextColumn::kErrorModel, row).empty()
                                  ? head_.error_model
                                  : table_.Get(TextColumn::kErrorModel, row);
    text_ += fmt::format(
        "P7,0,1,{},,{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n",
        get(Column::kSurvey, 1).empty() ? "1" : get(Column::kSurvey, 1), PlainField(model),
        get(Column::kObject, 1),
        point.empty() ? (status == RowStatus::kTieIn ? "TP" : "D") : PlainField(point), number,
        p717::StatusText(number), Exact(table_.md(row), Md()),
        Exact(table_.inclination(row), units::kDeg),
        Exact(Quantity::kDirection, table_.azimuth(row), head_), get(Column::kNorth, Md()),
        get(Column::kEast, Md()), get(Column::kTvd, Md()), get(Column::kNorthing, Grid()),
        get(Column::kEasting, Grid()), get(Column::kDown, Grid()),
        get(Column::kLatitude, units::kDeg), get(Column::kLongitude, units::kDeg), Extended(row));
  }

  void GyroRaw(const GyroRawRecord& g) {
    text_ += fmt::format("G7,0,{},{},{},{},{},{},{},{},{},{},{}", g.survey, g.number,
                         PlainField(g.time), g.used ? 1 : 0, Real(g.md, Md()),
                         Real(g.inclination, units::kDeg), Real(g.azimuth, units::kDeg),
                         Real(g.north, Md()), Real(g.east, Md()), Real(g.down, Md()), g.tool);
    for (int k = 0; k < 3; ++k) text_ += "," + Real(g.f[k]);
    for (int k = 0; k < 3; ++k) text_ += "," + Real(g.w[k], units::kDegPerHour);
    text_ +=
        fmt::format(",{},{},{},{},{},{},{},{},{},\n", Real(g.gravity),
                    Real(g.latitude, units::kDeg), Real(g.earth_rate, units::kDegPerHour),
                    Real(g.gyro_toolface, units::kDeg), Real(g.gravity_toolface, units::kDeg),
                    Real(g.gravity_ref), Real(g.latitude_ref, units::kDeg),
                    Real(g.earth_rate_ref, units::kDegPerHour), Real(g.convergence, units::kDeg));
  }

  const SurveyTable& table_;
  const SurveyHead& head_;
  std::vector<SurveyRun> runs_;
  std::vector<PositionObject> objects_;
  std::vector<const p717::Extension*> extensions_;
  std::string text_;
};

}  // namespace

std::string WriteP717(const SurveyTable& table) {
  NeedNorth(table, "P7/17");
  return P717Writer(table).Write();
}

}  // namespace wellgyro

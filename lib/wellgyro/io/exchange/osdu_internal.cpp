// OSDU manifest of a WellboreTrajectory, schema 1.4.0. The record holds what the survey is; its
// stations travel beside it, as CSV with the columns that it lists.
#include <vector>

#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/exchange/geo_path_internal.h"
#include "wellgyro/io/exchange/table_build_internal.h"
#include "wellgyro/io/sha256.h"
#include "wellgyro/io/text_internal.h"

namespace wellgyro {
namespace {

std::string Quoted(std::string_view text) { return JsonQuoted(text); }

// An identifier's last part: letters, digits and a few signs.
std::string Key(std::string_view text) {
  std::string key;
  for (const char c : text) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       c == '-' || c == '_' || c == '.';
    key += plain ? c : '-';
  }
  return key.empty() ? "unknown" : key;
}

std::string Id(std::string_view group, std::string_view type, std::string_view code) {
  return Quoted(fmt::format("osdu:{}--{}:{}:", group, type, code));
}
std::string Reference(std::string_view type, std::string_view code) {
  return Id("reference-data", type, code);
}

// How OSDU calls a unit of length: the symbol, and the end of an identifier.
struct UnitText {
  std::string symbol, key;
};
UnitText UnitTextOf(LengthUnit unit) {
  if (unit == LengthUnit::kUsFoot) return {"ft[US]", "ft%5BUS%5D"};
  const std::string word(WordOf(unit));
  return {word, word};
}

// A north, and azimuths from it.
struct NorthText {
  std::string_view reference, azimuth;
};
NorthText NorthTextOf(North north) {
  if (north == North::kTrue) return {"TrueNorth", "AzimuthTN"};
  if (north == North::kGrid) return {"GridNorth", "AzimuthGN"};
  return {"MagneticNorth", "AzimuthMN"};
}

// Members of the object "data", one a line.
class Members {
 public:
  void Add(std::string_view key, const std::string& value) {
    text_ += fmt::format("{}\n      {}: {}", text_.empty() ? "" : ",", Quoted(key), value);
  }
  void AddNumber(std::string_view key, const std::optional<double>& value, double unit = 1) {
    if (value) Add(key, Exact(*value, unit));
  }
  void AddFlag(std::string_view key, const std::optional<bool>& value) {
    if (value) Add(key, *value ? "true" : "false");
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

// A column of the stations, which travel beside the record.
struct Property {
  Column column;
  std::string type, unit;
};
std::vector<Property> PropertiesOf(const SurveyTable& table) {
  const std::string unit = UnitTextOf(table.head.md_unit).key;
  const std::string area = unit == "m" ? "m2" : unit == "ft" ? "ft2" : "ft%5BUS%5D2";
  const std::string dls =
      table.head.curvature_unit == CurvatureUnit::kDegPer100ft ? "dega%2F100ft" : "dega%2F30m";
  std::vector<Property> properties{
      {Column::kMd, "MD", unit},
      {Column::kInclination, "Inclination", "dega"},
      {Column::kAzimuth, std::string(NorthTextOf(table.head.azimuth.north).azimuth), "dega"},
      {Column::kTvd, "TVD", unit},
      {Column::kEast, "DX", unit},
      {Column::kNorth, "DY", unit},
      {Column::kDogleg, "DLS", dls},
      {Column::kVarNN, "CovarianceNN", area},
      {Column::kCovNE, "CovarianceNE", area},
      {Column::kCovNV, "CovarianceNV", area},
      {Column::kVarEE, "CovarianceEE", area},
      {Column::kCovEV, "CovarianceEV", area},
      {Column::kVarVV, "CovarianceVV", area},
  };
  std::erase_if(properties, [&](const Property& p) { return !table.Has(p.column); });
  return properties;
}

std::string ListOf(const std::vector<Property>& properties) {
  std::string list;
  for (const Property& p : properties) {
    list += fmt::format(
        "{}\n        {{\"TrajectoryStationPropertyTypeID\": {}, \"StationPropertyUnitID\": {}, "
        "\"Name\": {}}}",
        list.empty() ? "" : ",", Reference("TrajectoryStationPropertyType", p.type),
        Reference("UnitOfMeasure", p.unit), Quoted(p.type));
  }
  return "[" + list + "\n      ]";
}

// "A021Gc GYRO-NS-CT" as the list of tool types has it, GYRO-NS-CT_A021Gc.
std::string ToolCode(const std::string& model) {
  const std::size_t blank = model.find(' ');
  const bool code =
      blank == 6 && model[0] == 'A' && model.find(' ', blank + 1) == std::string::npos;
  return Key(code ? model.substr(blank + 1) + "_" + model.substr(0, blank) : model);
}

std::string DataOf(const SurveyTable& table, const std::string& bulk) {
  const SurveyHead& head = table.head;
  const SurveyIdentity& names = head.names;
  const double factor = FactorOf(head.md_unit);
  Members data;
  data.Add("Name", Quoted(names.survey.empty() ? "survey" : names.survey));
  data.Add("WellboreID", Id("master-data", "Wellbore",
                            Key(names.wellbore.empty() ? names.well : names.wellbore)));
  data.Add("TopDepthMeasuredDepth", Exact(table.md(0), factor));
  data.Add("BaseDepthMeasuredDepth", Exact(table.md(table.rows() - 1), factor));
  data.Add("VerticalMeasurement",
           fmt::format("{{\"VerticalMeasurement\": {}, \"VerticalMeasurementTypeID\": {}, "
                       "\"VerticalMeasurementPathID\": {}}}",
                       Exact(*head.datum_elevation, factor),
                       Reference("VerticalMeasurementType", Key(head.datum)),
                       Reference("VerticalMeasurementPath", "Elevation")));
  data.Add("AzimuthReferenceType",
           Reference("AzimuthReferenceType", NorthTextOf(head.azimuth.north).reference));
  if (head.method == "minimum curvature") {
    data.Add("CalculationMethodType", Reference("CalculationMethodType", "MinimumCurvature"));
  }
  if (!head.error_model.empty()) {
    data.Add("SurveyToolTypeID", Reference("SurveyToolType", ToolCode(head.error_model)));
  }
  if (table.status(0) == RowStatus::kTieIn) {
    data.Add("TieMeasuredDepth", Exact(table.md(0), factor));
  }
  data.AddNumber("SurfaceGridConvergence", head.azimuth.convergence, units::kDeg);
  data.AddNumber("SurfaceScaleFactor", head.scale);
  data.AddNumber("VerticalSectionAzimuth", head.section_azimuth, units::kDeg);
  data.AddFlag("IsDefinitive", head.definitive);
  data.AddFlag("IsMemory", head.memory);
  data.AddFlag("IsFinal", head.final_survey);
  std::string description;
  if (!bulk.empty()) {
    description = fmt::format("{} stations in {}, SHA-256 {}. ", table.rows(), bulk,
                              Sha256Hex(WriteOsduBulk(table)));
  }
  for (const std::string& remark : head.remarks) description += remark + ". ";
  if (!description.empty()) data.Add("Description", Quoted(Trim(description)));
  data.Add("AvailableTrajectoryStationProperties", ListOf(PropertiesOf(table)));
  return data.text();
}

}  // namespace

std::string WriteOsduBulk(const SurveyTable& table) {
  const std::vector<Property> properties = PropertiesOf(table);
  std::string text;
  for (const Property& p : properties) text += (text.empty() ? "" : ",") + p.type;
  text += '\n';
  for (std::size_t row = 0; row < table.rows(); ++row) {
    bool first = true;
    for (const Property& p : properties) {
      const auto value = table.Get(p.column, row);
      if (!first) text += ',';
      first = false;
      if (value) text += Exact(InfoOf(p.column).quantity, *value, table.head);
    }
    text += '\n';
  }
  return text + '\n';
}

std::string WriteOsdu(const SurveyTable& table, const std::string& bulk) {
  NeedNorth(table, "an OSDU manifest");
  const SurveyHead& head = table.head;
  if (table.rows() == 0) Lacks("an OSDU manifest", "a station");
  if (!head.datum_elevation) {
    Lacks("an OSDU manifest", "the elevation of the depth datum (datum_elevation_m)");
  }
  const UnitText unit = UnitTextOf(head.md_unit);
  const std::string reference = fmt::format(
      "{{\"abcd\":{{\"a\":0.0,\"b\":{},\"c\":1.0,\"d\":0.0}},\"symbol\":\"{}\","
      "\"baseMeasurement\":{{\"ancestry\":\"L\",\"type\":\"UM\"}},\"type\":\"UAD\"}}",
      Exact(FactorOf(head.md_unit)), unit.symbol);
  return fmt::format(
      "{{\n"
      "  \"kind\": \"osdu:wks:work-product-component--WellboreTrajectory:1.4.0\",\n"
      "  \"acl\": {{\"owners\": [\"data.default.owners@example.com\"], "
      "\"viewers\": [\"data.default.viewers@example.com\"]}},\n"
      "  \"legal\": {{\"legaltags\": [\"to-be-set\"], "
      "\"otherRelevantDataCountries\": [{}]}},\n"
      "  \"meta\": [{{\"kind\": \"Unit\", \"name\": \"{}\", \"persistableReference\": {}, "
      "\"unitOfMeasureID\": {}, \"propertyNames\": [\"TopDepthMeasuredDepth\", "
      "\"BaseDepthMeasuredDepth\", \"VerticalMeasurement.VerticalMeasurement\"]}}],\n"
      "  \"data\": {{{}\n    }}\n}}\n",
      head.names.country_code.empty() ? "" : Quoted(head.names.country_code), unit.symbol,
      Quoted(reference), Reference("UnitOfMeasure", unit.key), DataOf(table, bulk));
}

}  // namespace wellgyro

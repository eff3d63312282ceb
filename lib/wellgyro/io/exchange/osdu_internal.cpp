// OSDU manifest of a WellboreTrajectory, schema 1.4.0. The record holds what the survey is; its
// stations travel beside it, as CSV with the columns that it lists.
#include <array>

#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/exchange/table_build_internal.h"

namespace wellgyro {
namespace {

std::string Quoted(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      quoted += '\\';
      quoted += c;
    } else if (byte < 0x20) {
      quoted += fmt::format("\\u{:04x}", byte);
    } else {
      quoted += c;
    }
  }
  return quoted + '"';
}

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
UnitText TextOf(LengthUnit unit) {
  if (unit == LengthUnit::kUsFoot) return {"ft[US]", "ft%5BUS%5D"};
  const std::string word(WordOf(unit));
  return {word, word};
}

// A north, and azimuths from it.
struct NorthText {
  std::string_view reference, azimuth;
};
NorthText TextOf(North north) {
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

// What the columns of the stations are, which travel beside the record.
std::string PropertiesOf(const SurveyTable& table, const std::string& unit) {
  struct Property {
    Column column;
    std::string_view type, unit;
  };
  const std::string_view dls =
      table.head.curvature_unit == CurvatureUnit::kDegPer100ft ? "dega%2F100ft" : "dega%2F30m";
  const std::array properties{
      Property{Column::kMd, "MD", unit},
      Property{Column::kInclination, "Inclination", "dega"},
      Property{Column::kAzimuth, TextOf(table.head.azimuth.north).azimuth, "dega"},
      Property{Column::kTvd, "TVD", unit},
      Property{Column::kEast, "DX", unit},
      Property{Column::kNorth, "DY", unit},
      Property{Column::kDogleg, "DLS", dls},
  };
  std::string list;
  for (const Property& p : properties) {
    if (!table.Has(p.column)) continue;
    list += fmt::format(
        "{}\n        {{\"TrajectoryStationPropertyTypeID\": {}, \"StationPropertyUnitID\": {}, "
        "\"Name\": {}}}",
        list.empty() ? "" : ",", Reference("TrajectoryStationPropertyType", p.type),
        Reference("UnitOfMeasure", p.unit), Quoted(p.type));
  }
  return "[" + list + "\n      ]";
}

std::string DataOf(const SurveyTable& table) {
  const SurveyHead& head = table.head;
  const SurveyIdentity& names = head.names;
  const double factor = FactorOf(head.md_unit);
  Members data;
  data.Add("Name", Quoted(names.survey.empty() ? "survey" : names.survey));
  if (!head.remarks.empty()) data.Add("Description", Quoted(JoinedRemarks(head)));
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
           Reference("AzimuthReferenceType", TextOf(head.azimuth.north).reference));
  if (head.method == "minimum curvature") {
    data.Add("CalculationMethodType", Reference("CalculationMethodType", "MinimumCurvature"));
  }
  if (!head.error_model.empty()) {
    data.Add("SurveyToolTypeID", Reference("SurveyToolType", Key(head.error_model)));
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
  data.Add("AvailableTrajectoryStationProperties", PropertiesOf(table, TextOf(head.md_unit).key));
  return data.text();
}

}  // namespace

std::string WriteOsdu(const SurveyTable& table) {
  NeedNorth(table, "an OSDU manifest");
  const SurveyHead& head = table.head;
  if (table.rows() == 0) Lacks("an OSDU manifest", "a station");
  if (!head.datum_elevation) {
    Lacks("an OSDU manifest", "the elevation of the depth datum (datum_elevation_m)");
  }
  const UnitText unit = TextOf(head.md_unit);
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
      Quoted(reference), Reference("UnitOfMeasure", unit.key), DataOf(table));
}

}  // namespace wellgyro

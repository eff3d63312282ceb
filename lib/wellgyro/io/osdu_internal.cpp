// OSDU manifest of a WellboreTrajectory, schema 1.4.0. The record holds what the survey is; its
// stations travel beside it, as CSV with the columns that it lists.
#include <array>

#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/table_build_internal.h"

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

struct Property {
  Column column;
  std::string_view type, unit;
};

}  // namespace

std::string WriteOsdu(const SurveyTable& table) {
  NeedNorth(table, "an OSDU manifest");
  const SurveyHead& head = table.head;
  if (table.rows() == 0) Lacks("an OSDU manifest", "a station");
  if (!head.datum_elevation)
    Lacks("an OSDU manifest", "the elevation of the depth datum (datum_elevation_m)");
  const double factor = FactorOf(head.md_unit);
  const std::string unit =
      head.md_unit == LengthUnit::kUsFoot ? "ft[US]" : std::string(WordOf(head.md_unit));
  const std::string unit_key = head.md_unit == LengthUnit::kUsFoot ? "ft%5BUS%5D" : unit;
  const std::string north = head.azimuth.north == North::kTrue   ? "TrueNorth"
                            : head.azimuth.north == North::kGrid ? "GridNorth"
                                                                 : "MagneticNorth";
  const std::string azimuth = head.azimuth.north == North::kTrue   ? "AzimuthTN"
                              : head.azimuth.north == North::kGrid ? "AzimuthGN"
                                                                   : "AzimuthMN";
  const std::string dls =
      head.curvature_unit == CurvatureUnit::kDegPer100ft ? "dega%2F100ft" : "dega%2F30m";
  std::string data;
  const auto add = [&](std::string_view key, const std::string& value) {
    data += fmt::format("{}\n      {}: {}", data.empty() ? "" : ",", Quoted(key), value);
  };
  add("Name", Quoted(head.names.survey.empty() ? "survey" : head.names.survey));
  add("WellboreID", Id("master-data", "Wellbore",
                       Key(head.names.wellbore.empty() ? head.names.well : head.names.wellbore)));
  add("TopDepthMeasuredDepth", Exact(table.md(0), factor));
  add("BaseDepthMeasuredDepth", Exact(table.md(table.rows() - 1), factor));
  add("VerticalMeasurement",
      fmt::format("{{\"VerticalMeasurement\": {}, \"VerticalMeasurementTypeID\": {}, "
                  "\"VerticalMeasurementPathID\": {}}}",
                  Exact(*head.datum_elevation, factor),
                  Reference("VerticalMeasurementType", Key(head.datum)),
                  Reference("VerticalMeasurementPath", "Elevation")));
  add("AzimuthReferenceType", Reference("AzimuthReferenceType", north));
  if (head.method == "minimum curvature") {
    add("CalculationMethodType", Reference("CalculationMethodType", "MinimumCurvature"));
  }
  if (!head.error_model.empty()) {
    add("SurveyToolTypeID", Reference("SurveyToolType", Key(head.error_model)));
  }
  if (table.status(0) == RowStatus::kTieIn) add("TieMeasuredDepth", Exact(table.md(0), factor));
  if (head.azimuth.convergence) {
    add("SurfaceGridConvergence", Exact(*head.azimuth.convergence, units::kDeg));
  }
  if (head.scale) add("SurfaceScaleFactor", Exact(*head.scale));
  if (head.section_azimuth)
    add("VerticalSectionAzimuth", Exact(*head.section_azimuth, units::kDeg));
  if (head.definitive) add("IsDefinitive", *head.definitive ? "true" : "false");
  if (head.memory) add("IsMemory", *head.memory ? "true" : "false");
  if (head.final_survey) add("IsFinal", *head.final_survey ? "true" : "false");
  const std::array properties{
      Property{Column::kMd, "MD", unit_key},
      Property{Column::kInclination, "Inclination", "dega"},
      Property{Column::kAzimuth, azimuth, "dega"},
      Property{Column::kTvd, "TVD", unit_key},
      Property{Column::kEast, "DX", unit_key},
      Property{Column::kNorth, "DY", unit_key},
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
  add("AvailableTrajectoryStationProperties", "[" + list + "\n      ]");
  const std::string reference = fmt::format(
      "{{\"abcd\":{{\"a\":0.0,\"b\":{},\"c\":1.0,\"d\":0.0}},\"symbol\":\"{}\","
      "\"baseMeasurement\":{{\"ancestry\":\"L\",\"type\":\"UM\"}},\"type\":\"UAD\"}}",
      Exact(factor), unit);
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
      head.names.country_code.empty() ? "" : Quoted(head.names.country_code), unit,
      Quoted(reference), Reference("UnitOfMeasure", unit_key), data);
}

}  // namespace wellgyro

// Paths on the map as text: GeoJSON (RFC 7946) and KML 2.2.
#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/io/exchange/geo_path_internal.h"
#include "wellgyro/io/exchange/table_build_internal.h"
#include "wellgyro/io/exchange/xml_internal.h"

namespace wellgyro {
namespace {

// To a tenth of a millimetre.
std::string Place(double longitude_deg, double latitude_deg,
                  const std::optional<double>& elevation) {
  std::string text = fmt::format("{:.9f},{:.9f}", longitude_deg, latitude_deg);
  if (elevation) text += fmt::format(",{:.3f}", *elevation);
  return text;
}

std::string StationProperties(const SurveyTable& table, const GeoStation& s) {
  std::string text = fmt::format(
      "\"md_m\":{:.4f},\"inclination_deg\":{:.6f},\"azimuth_deg\":{:.6f}", table.md(s.row),
      ToDegrees(table.inclination(s.row)), ToDegrees(table.azimuth(s.row)));
  for (const auto& [name, column] :
       {std::pair{"tvd_m", Column::kTvd}, {"north_m", Column::kNorth}, {"east_m", Column::kEast}}) {
    if (const auto value = table.Get(column, s.row)) {
      text += fmt::format(",\"{}\":{:.4f}", name, *value);
    }
  }
  const std::string& quality = table.Get(TextColumn::kQuality, s.row);
  if (!quality.empty()) text += ",\"quality\":" + JsonQuoted(quality);
  return text;
}

std::string Ring(const GeoStation& s) {
  std::string ring;
  for (const auto& [longitude, latitude] : s.ellipse) {
    ring += (ring.empty() ? "[" : ",[") + Place(longitude, latitude, std::nullopt) + "]";
  }
  return ring;
}

}  // namespace

std::string WriteGeoJson(const SurveyTable& table) {
  const std::vector<GeoStation> path = GeoPathOf(table);
  std::string line, facts;
  for (const GeoStation& s : path) {
    line += (line.empty() ? "[" : ",[") + Place(s.longitude_deg, s.latitude_deg, s.elevation) + "]";
  }
  for (const auto& [key, value] : GeoFactsOf(table)) {
    facts += "," + JsonQuoted(key) + ":" + JsonQuoted(value);
  }
  std::string text = fmt::format(
      "{{\"type\":\"FeatureCollection\",\"features\":[\n"
      "{{\"type\":\"Feature\",\"geometry\":{{\"type\":\"LineString\",\"coordinates\":[{}]}},"
      "\"properties\":{{\"kind\":\"path\"{}}}}}",
      line, facts);
  for (const GeoStation& s : path) {
    text += fmt::format(
        ",\n{{\"type\":\"Feature\",\"geometry\":{{\"type\":\"Point\",\"coordinates\":[{}]}},"
        "\"properties\":{{\"kind\":\"station\",{}}}}}",
        Place(s.longitude_deg, s.latitude_deg, s.elevation), StationProperties(table, s));
  }
  for (const GeoStation& s : path) {
    if (s.ellipse.empty()) continue;
    text += fmt::format(
        ",\n{{\"type\":\"Feature\",\"geometry\":{{\"type\":\"Polygon\",\"coordinates\":[[{}]]}},"
        "\"properties\":{{\"kind\":\"ellipse\",\"md_m\":{:.4f},\"confidence\":{}}}}}",
        Ring(s), table.md(s.row), kConfidence);
  }
  return text + "\n]}\n";
}

std::string WriteKml(const SurveyTable& table) {
  const std::vector<GeoStation> path = GeoPathOf(table);
  XmlWriter xml;
  xml.Open("kml", {{"xmlns", "http://www.opengis.net/kml/2.2"}});
  xml.Open("Document");
  xml.Leaf("name", table.head.names.well.empty() ? "well" : table.head.names.well);
  xml.Open("Placemark");
  xml.Leaf("name", "path");
  xml.Open("ExtendedData");
  for (const auto& [key, value] : GeoFactsOf(table)) {
    xml.Open("Data", {{"name", key}});
    xml.Leaf("value", value);
    xml.Close();
  }
  xml.Close();
  xml.Open("LineString");
  xml.Leaf("altitudeMode", "clampToGround");
  std::string line;
  for (const GeoStation& s : path) {
    line += (line.empty() ? "" : " ") + Place(s.longitude_deg, s.latitude_deg, s.elevation);
  }
  xml.Leaf("coordinates", line);
  xml.Close();
  xml.Close();
  xml.Open("Folder");
  xml.Leaf("name", "ellipses");
  for (const GeoStation& s : path) {
    if (s.ellipse.empty()) continue;
    xml.Open("Placemark");
    xml.Leaf("name", fmt::format("MD {:.2f} m", table.md(s.row)));
    xml.Open("Polygon");
    xml.Open("outerBoundaryIs");
    xml.Open("LinearRing");
    std::string ring;
    for (const auto& [longitude, latitude] : s.ellipse) {
      ring += (ring.empty() ? "" : " ") + Place(longitude, latitude, std::nullopt);
    }
    xml.Leaf("coordinates", ring);
    for (int k = 0; k < 4; ++k) xml.Close();
  }
  for (int k = 0; k < 3; ++k) xml.Close();
  return xml.Take();
}

}  // namespace wellgyro

#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "wellgyro/record/survey_table.h"
#include "wellgyro/uncertainty/ellipse.h"

namespace wellgyro {

/// A station on the map.
struct GeoStation {
  std::size_t row = 0;
  double latitude_deg = 0, longitude_deg = 0;
  std::optional<double> elevation;  ///< above the vertical reference [m]
  /// The horizontal error ellipse as a closed ring of longitude and latitude [deg].
  std::vector<std::array<double, 2>> ellipse;
};

/// A survey's path on WGS 84: from the file's latitudes and longitudes, else from those of the well
/// head (an object WRP or ZDP) and the offsets, turned to true north. Ellipses hold the position
/// with probability `kConfidence`. Throws std::invalid_argument saying what is missing.
std::vector<GeoStation> GeoPathOf(const SurveyTable& table);

/// What a path says of itself, in pairs of name and text.
std::vector<std::pair<std::string, std::string>> GeoFactsOf(const SurveyTable& table);

/// RFC 7946: path, stations and ellipses as features, longitude before latitude.
std::string WriteGeoJson(const SurveyTable& table);
/// KML 2.2, for globes.
std::string WriteKml(const SurveyTable& table);
/// The bytes of an SQLite database, the same for the same table.
std::string WriteGeoPackage(const SurveyTable& table);

/// A JSON string with its quotes.
std::string JsonQuoted(std::string_view text);

}  // namespace wellgyro

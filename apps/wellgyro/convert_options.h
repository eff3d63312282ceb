#pragma once

#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "wellgyro/base/angle.h"
#include "wellgyro/io/exchange/exchange.h"

namespace wellgyro::apps {

/// The command line of convert: words as they were given, empty where they were not.
struct ConvertOptions {
  std::string in, out, from, to, units, north, azimuth_reference, depth_unit, datum;
  std::string well, trajectory, decimal, crs, declination_source, declination_date;
  std::vector<std::string> columns;
  std::optional<double> convergence_deg, declination_deg, datum_elevation_m, section_azimuth_deg;
  std::optional<double> latitude_deg, longitude_deg;
  bool preamble = false, variable_step = false, derived = false, keep = false;
  bool strict = false, as_listed = false;
};

/// true, grid, magnetic; absent for any other word.
std::optional<North> NorthOf(const std::string& word);
/// m, metric; ft, field; ftUS.
std::optional<LengthUnit> LengthOf(const std::string& word);
inline std::optional<double> Radians(const std::optional<double>& degrees) {
  if (!degrees) return std::nullopt;
  return FromDegrees(*degrees);
}

/// How IN is to be read. Throws std::invalid_argument for --columns without an equals sign.
ReadOptions ReadingOf(const ConvertOptions& o);

/// What IN is and does not say.
void AddReading(CLI::App& command, ConvertOptions& o);
/// What OUT is to be.
void AddWriting(CLI::App& command, ConvertOptions& o);

}  // namespace wellgyro::apps

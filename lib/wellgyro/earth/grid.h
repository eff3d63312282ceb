#pragma once

#include <optional>
#include <string>

#include "wellgyro/base/export.h"

namespace wellgyro {

/// A map projection with explicit parameters on WGS 84 or a named ellipsoid. There is no registry
/// and no datum shift here: `epsg` is a label, and what the operator states wins.
struct GridSpec {
  enum class Projection { kTransverseMercator, kLambertConformalConic, kPolarStereographic };
  Projection projection = Projection::kTransverseMercator;
  std::string name;             ///< as the user wrote it, e.g. "UTM 31N"
  double semi_major = 6378137;  ///< of the ellipsoid [m]
  double inverse_flattening = 298.257223563;
  double latitude_origin = 0;             ///< [rad]
  double longitude_origin = 0;            ///< central meridian [rad]
  double parallel_1 = 0, parallel_2 = 0;  ///< of a Lambert cone [rad]
  bool north_pole = true;                 ///< of a polar stereographic projection
  double scale_origin = 1;            ///< scale on the central meridian, parallel or at the pole
  double false_easting = 0;           ///< [m]
  double false_northing = 0;          ///< [m]
  std::optional<double> convergence;  ///< stated by the operator: true azimuth less grid [rad]
  std::optional<double> scale;        ///< stated by the operator
  std::string epsg;                   ///< a label, never looked up
};

/// A point on the grid. Grid azimuth = true azimuth - convergence.
struct GridPoint {
  double northing = 0;     ///< [m]
  double easting = 0;      ///< [m]
  double convergence = 0;  ///< [rad]
  double scale = 1;
};

/// A UTM zone on WGS 84 such as "31N" or "60S"; the letter is the hemisphere, not a latitude band.
/// Throws std::invalid_argument for anything else.
WELLGYRO_EXPORT GridSpec UtmGrid(const std::string& zone);

/// Projects latitude and longitude [rad]; convergence and scale are the projection's own, whatever
/// the operator states. Transverse Mercator is good to 5 nm within 35 deg of its central meridian
/// and ends there. Throws std::domain_error outside the projection, std::invalid_argument when the
/// grid's parameters make no projection.
WELLGYRO_EXPORT GridPoint ProjectToGrid(const GridSpec& grid, double latitude, double longitude);

/// Latitude and longitude [rad] of the point `north`, `east` metres from a well head, along the
/// geodesic of WGS 84 with the azimuth and length of (north, east).
struct GeodeticPoint {
  double latitude = 0, longitude = 0;
};
WELLGYRO_EXPORT GeodeticPoint OffsetGeodetic(GeodeticPoint head, double north, double east);

}  // namespace wellgyro

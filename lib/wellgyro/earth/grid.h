#pragma once

#include <optional>
#include <string>

#include "wellgyro/base/export.h"

/// @file
/// Which north an azimuth counts from, and maps.
namespace wellgyro {

/// What an azimuth counts from.
enum class North { kUnknown, kTrue, kGrid, kMagnetic };

/// How the azimuths of one survey hang together.
struct AzimuthReference {
  North north = North::kUnknown;      ///< of the survey's azimuths
  std::optional<double> convergence;  ///< true azimuth less grid azimuth [rad]
  std::optional<double> declination;  ///< true azimuth less magnetic azimuth [rad]
  std::string declination_source;     ///< model, as "BGGM 2023"
  std::string declination_date;       ///< day it holds for, YYYY-MM-DD
};

/// `azimuth` [rad], given from `from`, as it counts from `to`, in [0, 2 pi); NaN of an
/// azimuth that is not finite. Throws std::invalid_argument saying what is missing or not finite:
/// convergence, declination, or which north it is.
WELLGYRO_EXPORT double AzimuthFrom(const AzimuthReference& reference, double azimuth, North from,
                                   North to);

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

/// A place on WGS 84.
struct GeodeticPoint {
  double latitude = 0;   ///< [rad]
  double longitude = 0;  ///< [rad]
};

/// The place `north`, `east` metres from a well head, along the geodesic of WGS 84 with the azimuth
/// and length of (north, east). Lengths count on the ellipsoid: depth and elevation, which change
/// them by 0.016 % per kilometre, are left out as the trade does.
WELLGYRO_EXPORT GeodeticPoint OffsetGeodetic(GeodeticPoint head, double north, double east);

/// The grid around one well, with what the operator states about it.
///
/// Where the operator states convergence or scale, both hold at the well head: grid offsets from
/// the head are turned and stretched as a whole, so that they hold there, and change along the well
/// as the projection's own do. The head's coordinates stay the projection's.
class WELLGYRO_EXPORT WellGrid {
 public:
  /// Throws as ProjectToGrid, and std::invalid_argument when the stated scale is not positive or
  /// the stated convergence not finite.
  WellGrid(const GridSpec& grid, GeodeticPoint head);

  /// The point `north`, `east` metres from the well head. Throws std::domain_error outside the
  /// projection.
  GridPoint At(double north, double east) const;

  const GridPoint& projected_head() const { return projected_head_; }  ///< nothing stated applied

 private:
  GridSpec grid_;
  GeodeticPoint head_;
  GridPoint projected_head_;
};

}  // namespace wellgyro

#pragma once

#include <optional>
#include <string>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/earth/grid.h"

namespace wellgyro {

/// Coordinates in a system of the EPSG registry, in its own unit: easting and northing of a
/// projected one, longitude and latitude [deg] of a geographic one, in this order whatever the
/// registry's axes are. `z` is the ellipsoidal height [m], where the system has one.
struct CrsPoint {
  double x = 0, y = 0, z = 0;
};

/// What became of coordinates.
struct ShiftedPoint {
  CrsPoint point;
  std::string operation;           ///< its name in the registry
  std::optional<double> accuracy;  ///< that the registry states [m]
};

/// `point` of the system `from` in the system `to`, as "EPSG:23031", by the best operation that the
/// registry has at that place. Never by a rough one: a Fault kRange names the grid file where the
/// best operation needs one that this machine lacks, and says so where the registry has no
/// operation between the two datums; kForeign where a system is not known; kRange where the point
/// is outside. Nothing is fetched from a network. Source: PROJ.
WELLGYRO_EXPORT Result<ShiftedPoint> ShiftPoint(const std::string& from, const std::string& to,
                                                const CrsPoint& point);

/// A projected system at one place of its own geographic datum.
struct CrsGridPoint {
  GridPoint point;                 ///< northing, easting in metres; convergence; scale
  double unit = 1;                 ///< metres in the system's unit
  std::string unit_name;           ///< as "US survey foot"
  std::string name;                ///< of the system
  GeodeticPoint geographic;        ///< on its own datum
  std::string operation;           ///< from WGS 84, its name in the registry
  std::optional<double> accuracy;  ///< of the operation, that the registry states [m]
  std::string
      outside;  ///< the area that the system is for, where the place is not in it; else empty
};

/// `place`, on WGS 84, in the projected system `system`: shifted to its datum as ShiftPoint does,
/// projected, with the convergence (true less grid azimuth) and the scale of the projection there.
WELLGYRO_EXPORT Result<CrsGridPoint> ProjectToCrs(const std::string& system,
                                                  const GeodeticPoint& place);

/// Back: coordinates of a projected system in its unit to WGS 84.
WELLGYRO_EXPORT Result<GeodeticPoint> GeodeticOfCrs(const std::string& system,
                                                    const CrsPoint& point);

}  // namespace wellgyro

#pragma once

#include <span>

#include <Eigen/Core>

#include "wellgyro/base/export.h"

namespace wellgyro {

/// What the trade says about one leg between two stations.
struct LegGeometry {
  double dogleg = 0;           ///< angle between its ends [rad]
  double dogleg_severity = 0;  ///< [rad/m]; in deg/30 m and deg/100 ft by base/units.h
  double build = 0;            ///< mean change of inclination [rad/m]
  double turn = 0;             ///< mean change of azimuth, the short way round [rad/m]
  /// Direction in which the hole turns as it leaves the first station, clockwise from its high
  /// side looking down-hole [rad], (-pi, pi]; zero in a straight leg. In a vertical hole the high
  /// side is where the station's azimuth points, so that azimuth + toolface is the direction.
  double toolface = 0;
};

/// Of the leg of `length` [m] between two attitudes [rad]. Throws std::invalid_argument when the
/// length is not positive, a value is not finite or the two directions are opposite.
WELLGYRO_EXPORT LegGeometry GeometryOfLeg(double length, double inclination_1, double azimuth_1,
                                          double inclination_2, double azimuth_2);

/// Horizontal distance [m] from the origin and its direction [rad] in [0, 2 pi).
struct Closure {
  double distance = 0;
  double azimuth = 0;
};
WELLGYRO_EXPORT Closure ClosureOf(double north, double east);

/// Distance [m] of (north, east) from the origin (north_0, east_0), along `azimuth` [rad].
WELLGYRO_EXPORT double VerticalSection(double north, double east, double azimuth,
                                       double north_0 = 0, double east_0 = 0);

/// True vertical depth below mean sea level: TVD less the datum's elevation above it [m].
WELLGYRO_EXPORT double TvdSubSea(double tvd, double datum_elevation);

/// Ways to sum a survey. All but minimum curvature are there to reproduce old files.
enum class SurveyMethod {
  kMinimumCurvature,
  kAverageAngle,        ///< straight legs along the mean of both angles
  kTangential,          ///< straight legs along the lower station
  kBalancedTangential,  ///< each half leg along its own station
  kRadiusOfCurvature,   ///< arcs in the vertical and in the horizontal section
};

/// MinimumCurvature of arrays, by any method: (north, east, TVD) [m] from `start_W`. Azimuth is
/// averaged the short way round. Radius of curvature is taken in a form that holds for equal
/// angles too. Source of the classic methods: API Bulletin D20.
/// Throws std::invalid_argument as MinimumCurvature does, naming the station; opposite directions
/// are refused by minimum curvature only.
WELLGYRO_EXPORT void PositionsBy(SurveyMethod method, std::span<const double> md,
                                 std::span<const double> inclination,
                                 std::span<const double> azimuth, const Eigen::Vector3d& start_W,
                                 std::span<Eigen::Vector3d> position_W);

}  // namespace wellgyro

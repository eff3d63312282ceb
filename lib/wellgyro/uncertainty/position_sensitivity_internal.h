#pragma once

#include <Eigen/Core>

#include "wellgyro/uncertainty/weight.h"

namespace wellgyro {

/// How errors of (MD, inclination, azimuth) at one station move its own position (at) and that of
/// all deeper ones (through); beside them, an error along a fixed direction in place of the angles.
struct PositionSensitivity {
  Eigen::Matrix3d at_by_md_inc_azi_W;       ///< columns by MD [1], inclination and azimuth [m/rad]
  Eigen::Matrix3d through_by_md_inc_azi_W;  ///< likewise
  double along_at = 0, along_through = 0;   ///< [m]
};

/// The hole's direction at a station (north, east, down), with its derivatives.
struct StationDirection {
  Eigen::Vector3d tangent_W;    ///< unit tangent
  Eigen::Vector3d high_side_W;  ///< by the inclination: the high side
  Eigen::Vector3d right_W;      ///< by the azimuth: to the right, sin I long
};
/// From the sines and cosines of `p`, azimuth in the survey's own frame.
StationDirection DirectionAt(const WeightPlace& p);

/// Balanced tangential: half of the course on either side goes along the station's direction.
/// `above_W` and `below_W` are the directions at the neighbours; `ahead` is the length of the
/// course to the next station, `own` what of the course behind is this station's [m].
PositionSensitivity SensitivityAt(const Eigen::Vector3d& above_W, const StationDirection& here,
                                  const Eigen::Vector3d& below_W, double own, double ahead);

/// The same where the position is taken as known: at a tie-on, a kick-off. Of the depth, counted
/// from the datum, remains what the bend of the leg makes.
PositionSensitivity SensitivityFrom(const StationDirection& here, const Eigen::Vector3d& below_W,
                                    double ahead);

}  // namespace wellgyro

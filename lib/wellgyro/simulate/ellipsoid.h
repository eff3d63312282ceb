#pragma once

#include "wellgyro/base/export.h"

namespace wellgyro {

/// Shape and pull of the simulated Earth at one place, from formulas of the simulator's own.
struct EllipsoidPlace {
  double radius_north = 0;  ///< meridian radius of curvature plus height [m]
  double radius_east = 0;   ///< prime-vertical radius of curvature plus height [m]
  double gravity = 0;       ///< along the ellipsoid's normal [m/s^2]
};

/// WGS 84 at the sine of a geodetic latitude and a height [m].
///
/// Gravity: Somigliana on the ellipsoid, above it the second-order series in height (NIMA TR8350.2,
/// eq. 4-3; good to 1e-10 m/s^2 per metre), below it growing by 0.85e-6 m/s^2 per metre of depth.
WELLGYRO_EXPORT EllipsoidPlace EllipsoidAt(double sin_latitude, double height);

}  // namespace wellgyro

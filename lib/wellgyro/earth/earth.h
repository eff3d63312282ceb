#pragma once

#include "wellgyro/base/export.h"

namespace wellgyro {

/// Rotation rate of WGS 84 [rad/s].
inline constexpr double kEarthRate = 7.292115e-5;

/// The Earth as the tool feels it at one place.
struct Site {
  double latitude = 0;      ///< geodetic, WGS 84 [rad]
  double height = 0;        ///< above mean sea level, taken for the ellipsoid [m]; negative below
  double gravity = 0;       ///< normal gravity, centrifugal part included [m/s^2]
  double radius_north = 0;  ///< meridian radius of curvature at `height` [m]
  double radius_east = 0;   ///< prime-vertical radius of curvature at `height` [m]
};

/// WGS 84 at `latitude` [rad] and `height` [m].
///
/// Above sea level gravity is the closed form of normal gravity (Somigliana, GeographicLib). Below,
/// where the rock above no longer pulls the tool down, it grows with depth by 0.85e-6 m/s^2 per
/// metre: the free-air gradient less that of a Bouguer plate of 2670 kg/m^3 counted twice. Good to
/// kSigmaGravity against true gravity outside strong anomalies; the tie to the geoid is left out.
/// Throws std::domain_error when |latitude| > pi/2 or either argument is not finite.
WELLGYRO_EXPORT Site SiteAt(double latitude, double height);

/// 1-sigma of Site::gravity against true gravity: 50 mGal [m/s^2].
inline constexpr double kSigmaGravity = 5e-4;

}  // namespace wellgyro

#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/survey/hole/hole_line.h"

namespace wellgyro {

/// Two surveys of one hole are compared at equal MD; two wells where `Scan` says.
enum class Pairing { kTwoWells, kSameHole };

/// Which point of the second well belongs to a point of the first.
enum class Scan {
  kNearest,             ///< in three dimensions
  kHorizontal,          ///< at the same TVD, the nearest of those
  kTravellingCylinder,  ///< in the plane across the first, the nearest of those
};

/// Which errors are one and the same in both surveys and so drop out of their difference: none; the
/// global ones, and in one hole the well's too; all that reach beyond a tool's run.
enum class Correlation { kNone, kGlobal, kFull };

/// What bounds a position at so many sigmas, seen from the other: the distance of the ellipsoid's
/// tangent plane, or its own surface along the way.
enum class ErrorSurface { kPedal, kEllipsoid };

/// The separation rule of the ISCWSA with its published values (S. J. Sawaryn et al.,
/// "Well-Collision-Avoidance Separation Rule", SPE-187073-PA, 2019).
struct SeparationRule {
  double k = 3.5;               ///< sigmas
  double sigma_ahead = 0.5;     ///< of the projection ahead of the bit, any direction [m]
  double surface_margin = 0.3;  ///< [m]
  Correlation correlation = Correlation::kNone;
  ErrorSurface surface = ErrorSurface::kPedal;
  Scan scan = Scan::kNearest;
  bool minima = true;  ///< between stations too
};

/// One point of the first survey against the second.
struct Separation {
  enum class Kind {
    kStation,  ///< of the first
    kNearest,  ///< between two, nearer than either
    kLowest,   ///< between two, with a lower separation factor than either
  };
  Kind kind = Kind::kStation;
  double md = 0;                                         ///< on the first [m]
  double other_md = 0;                                   ///< on the second [m]
  Eigen::Vector3d position_W = Eigen::Vector3d::Zero();  ///< on the first [m]
  Eigen::Vector3d vector_W = Eigen::Vector3d::Zero();    ///< from the first to the second [m]
  double distance = 0;                                   ///< [m]
  Eigen::Matrix3d cov_W = Eigen::Matrix3d::Zero();       ///< of the vector, shared errors out [m^2]
  /// Of the distance, along the vector; of the worst direction where both meet [m].
  double sigma = 0;
  std::optional<double> sigmas;  ///< distance / sigma; absent where sigma is zero
  double holes = 0;              ///< both radii [m]
  /// (distance - holes - margin) / (k sqrt(sigma^2 + sigma_ahead^2)), or by the ellipsoid, where
  /// the vector, shortened by radii and margin, is measured by the covariance itself; absent where
  /// nothing is uncertain.
  std::optional<double> factor;
  double allowed = 0;   ///< the distance at which the factor is 1 by the pedal curve [m]
  double toolface = 0;  ///< of the second, seen down the first, clockwise from its high side [rad]
  double high_side =
      0;  ///< azimuth that the first's toolface counts from, where it is vertical [rad]
};

/// The second seen from every station of `first`, and, by Scan::kNearest, from those places between
/// stations where distance or separation factor is lowest; both in one frame, in order of MD. With
/// C the covariances and E the errors that both share, term by term under the same name,
///   C = C1 + C2 - sum (E1 E2' + E2 E1').
/// Same hole: stations of the first outside the second's are left out; by the scans in a plane
/// those whose plane the second does not meet. Distances are the arcs', to 1e-7 m.
WELLGYRO_EXPORT std::vector<Separation> Separations(const HoleLine& first, const HoleLine& second,
                                                    Pairing pairing,
                                                    const SeparationRule& rule = {});

/// The row with the lowest factor, or where none has one, the smallest distance; null when empty.
WELLGYRO_EXPORT const Separation* Lowest(const std::vector<Separation>& rows);

/// Whether the separation factor of `first` against `second` may fall below `factor` anywhere. No
/// where it cannot, whatever the correlation and surface of errors: found from boxes around the
/// legs and a bound of their variances, in O(log n) for wells that are far from each other.
WELLGYRO_EXPORT bool MayFallBelow(const HoleLine& first, const HoleLine& second,
                                  const SeparationRule& rule, double factor);

}  // namespace wellgyro

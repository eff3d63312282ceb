#pragma once

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/earth/earth.h"

namespace wellgyro {

/// Where the hole points at one measured depth.
struct PathStation {
  double md = 0;           ///< [m]
  double inclination = 0;  ///< [rad]
  double azimuth = 0;      ///< true, at the station's own meridian [rad]
};

/// One point of the path of the well, in the well frame W: north, east, TVD.
struct PathPoint {
  PathStation station;
  Eigen::Vector3d p_WT_W = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Vector3d tangent_W =
      Eigen::Vector3d::UnitZ();  ///< of the hole; TVD along the local vertical
  double dogleg_severity = 0;    ///< over the leg that ends here [rad/m]
};

/// The angle [rad] by which the meridian `north`, `east` metres from the well head has turned
/// against the well head's own: azimuth at the point = azimuth in W + this.
///
/// The difference of a geodesic's azimuths at its two ends, to second order in distance over Earth
/// radius (5 km east at 60 deg north: 0.08 deg): within 3e-8 rad for points up to 10 km away at
/// latitudes up to 70 deg. Depth, which is left out, changes it by 0.016 % per kilometre. Without
/// a meaning at the poles: Path refuses latitudes beyond 89.5 deg.
WELLGYRO_EXPORT double MeridianConvergence(const Site& head, double north, double east);

/// Sums stations into positions, one at a time in constant time and memory: minimum curvature with
/// each azimuth turned by the convergence of the meridians from the station's own north to that of
/// the well head. TVD counts along the local vertical.
class WELLGYRO_EXPORT Path {
 public:
  /// Starts at the tie-in: its attitude and its position `p_WT_W` [m], for a well head at `head`
  /// (its height does not matter). Throws std::invalid_argument when the latitude is beyond
  /// 89.5 deg or a value of the tie-in is not finite.
  Path(const Site& head, const PathStation& tie_in, const Eigen::Vector3d& p_WT_W);

  /// Adds the next station down. A Fault leaves the path as it was: kOrder when depth does not
  /// increase, kRange when a value is not finite or the station points opposite to the one before.
  Result<PathPoint> Add(const PathStation& station);

  const PathPoint& last() const { return last_; }

 private:
  Site head_;
  PathPoint last_;
};

/// The point at measured depth `md` [m] on the arc between two consecutive points of a path; beyond
/// them the circle goes on, up to kDoglegLimit away from `from`. The azimuth refers to the point's
/// own meridian; in an exactly vertical hole it is that of `from`. `dogleg_severity` is the arc's.
/// The points must come from one path.
WELLGYRO_EXPORT PathPoint Interpolate(const Site& head, const PathPoint& from, const PathPoint& to,
                                      double md);

}  // namespace wellgyro

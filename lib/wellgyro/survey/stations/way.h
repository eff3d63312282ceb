#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/base/time.h"
#include "wellgyro/earth/earth.h"
#include "wellgyro/record/station.h"
#include "wellgyro/trajectory/path.h"

namespace wellgyro {

/// Where the hole points at one instant of a run. A run has one every second: what it saw between
/// its stations, which positions are summed over so that they do not depend on the stations'
/// spacing.
struct Waypoint {
  UtcTime utc;
  PathStation station;
};

/// Those of `way`, which is in the order of time, between two stations of one pass: strictly deeper
/// than `above` and shallower than `below`, depth increasing by at least 0.2 m from one to the next
/// and to `below`. Empty where time says that the stations are of no one way.
WELLGYRO_EXPORT std::vector<PathStation> WayBetween(std::span<const Waypoint> way,
                                                    const Station& above, const Station& below);

/// Those above the shallowest station of a pass, from where the pass begins (in-run) or to where it
/// ends (`out`), in the order of depth.
WELLGYRO_EXPORT std::vector<PathStation> WayAbove(std::span<const Waypoint> way,
                                                  const Station& shallowest, bool out);

/// One pass, placed: its way and its stations, depth increasing.
struct PassLine {
  std::int32_t run = 0;
  std::int32_t pass_number = 0;
  std::vector<PathPoint> points;
  /// Position covariance at each, without the point's own depth error [m^2].
  std::vector<Eigen::Matrix3d> covs_W;

  /// Index of the first point at or below `md`; absent unless one lies above it too.
  std::optional<std::size_t> Below(double md) const;
};

/// What minimum curvature between two depths leaves out of the way that the hole takes, as a pass
/// saw it [m]: to be added to the displacement of a leg between them. Of `lines` the pass of the
/// lower station counts first, then that of the upper, then any; zero where none saw it all.
WELLGYRO_EXPORT Eigen::Vector3d Bulge(const Site& head, std::span<const PassLine> lines,
                                      const Station& above, const Station& below);

}  // namespace wellgyro

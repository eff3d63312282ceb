#pragma once

#include <vector>

#include <Eigen/Core>

#include "wellgyro/attitude/station_state.h"
#include "wellgyro/record/station.h"
#include "wellgyro/survey/job.h"
#include "wellgyro/trajectory/path.h"

namespace wellgyro {

/// A station of one pass on its way to a position.
struct PassItem {
  Station station;
  const StationState* state = nullptr;  ///< nullptr: from a window of its own
  bool listed = true;
  bool on_line = true;                ///< deeper than the one before
  bool carried = false;               ///< of an earlier pass, on which this one begins
  std::vector<PathStation> way = {};  ///< from the one before on the line
};
using PassItems = std::vector<PassItem>;  ///< in the order of depth

/// A leg so long without a depth in it was not seen: marks at stands of pipe. Marks in time leave
/// gaps of 5 s at most (DepthTrackSetup::max_gap), 5 m at 1 m/s.
inline constexpr double kUnseenLeg = 5;  // [m]

inline PathStation PathOf(const Station& s) { return {s.md, s.inclination, s.azimuth}; }

/// The depth from which on the pass saw the hole.
inline double SeenFrom(const PassItems& pass) {
  const PassItem& first = pass.front();
  return first.way.empty() ? first.station.md : first.way.front().md;
}

/// Where a sum of legs starts.
struct PathStart {
  PathPoint point;
  Eigen::Matrix3d cov_p_WT_W = Eigen::Matrix3d::Zero();  ///< without the depth's error [m^2]
  /// Where the well begins, at the tie-in: an error of the depth moves all that is below.
  Eigen::Vector3d top_tangent_W = Eigen::Vector3d::UnitZ();
};

/// Position covariances of a pass's stations, in their order, from its start on [m^2].
struct PassCovariances {
  std::vector<Eigen::Matrix3d> covs_of_sensors_W;  ///< and what the hole may do where nobody saw it
  std::vector<Eigen::Matrix3d> covs_of_depth_W;    ///< what its error adds
};

PassCovariances PassCovariancesOf(const Job& job, const PassItems& pass, const PathStart& start);

/// Covariance of a place by a depth error e of variance one that all stations share, the unit
/// tangents being `top_W` at the begin and `tangent_W` there. The path to where the tool was
/// begins e deeper and moves by e top; the hole at that measured depth is e further up and
/// moves by e (top - tangent) ("survey station" and "assigned depth" of the ISCWSA model, SPE
/// 67616). Both are asked for: this is the least ellipsoid that holds both.
Eigen::Matrix3d ByCommonDepth(const Eigen::Vector3d& top_W, const Eigen::Vector3d& tangent_W);

}  // namespace wellgyro

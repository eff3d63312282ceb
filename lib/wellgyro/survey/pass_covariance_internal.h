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
  std::vector<PathStation> way = {};  ///< from the one before on the line
};
using PassItems = std::vector<PassItem>;  ///< in the order of depth

/// Where a sum of legs starts.
struct PathStart {
  PathPoint point;
  Eigen::Matrix3d cov_p_WT_W = Eigen::Matrix3d::Zero();
};

/// Position covariances of a pass's stations, in their order, from its start on: the sensors' and
/// the depth's errors, and what the hole may do where nobody saw it.
std::vector<Eigen::Matrix3d> PassCovariances(const Job& job, const PassItems& pass,
                                             const PathStart& start);

}  // namespace wellgyro

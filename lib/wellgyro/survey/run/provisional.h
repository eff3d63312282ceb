#pragma once

#include <optional>
#include <vector>

#include "wellgyro/attitude/along_hole_covariance.h"
#include "wellgyro/attitude/station_state.h"
#include "wellgyro/survey/job.h"
#include "wellgyro/survey/stations/draft.h"
#include "wellgyro/trajectory/path.h"

namespace wellgyro {

/// Positions of one run's stations as they come, in constant time each: the first in-run is summed
/// from the tie-in on, every other pass is laid on it. Assemble() does it properly, all at once.
class ProvisionalPath {
 public:
  /// `job` must outlive this object.
  explicit ProvisionalPath(const Job& job) : job_(job) {}

  /// The station of `draft`, whose attitude is that of `state`; absent where it has no position
  /// yet. Every draft of the run goes through here in the order of time, and once more where it
  /// comes to be listed afterwards.
  std::optional<Station> Place(const Draft& draft, const StationState* state);

 private:
  bool Start(const Station& first);
  void Extend(Station& station, const StationState* state);
  void LayOn(Station& station) const;

  const Job& job_;
  std::int32_t pass_number_ = 0;     ///< of the in-run; 0: not begun
  std::optional<std::size_t> told_;  ///< knot of the last station of that pass
  std::optional<Path> path_;
  std::optional<AlongHoleCovariance> covariance_;
  std::vector<PathPoint> points_;
  std::vector<Eigen::Matrix3d> covs_W_;
};

}  // namespace wellgyro

#pragma once

#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/survey/job.h"

namespace wellgyro {

/// The depths at which a job wants stations: whole multiples of stations.every, stations.at, and
/// the tie-in where it takes its attitude from the run.
class WELLGYRO_EXPORT StationPlan {
 public:
  explicit StationPlan(const Job& job);

  struct Target {
    double md = 0;       ///< [m]
    bool listed = true;  ///< false: needed, but not asked for
  };
  /// Targets between two depths of a pass, in the order in which the tool meets them: (from, to],
  /// or [from, to] where `inclusive`; `to` may be above `from`. Two nearer than kSameDepth are one.
  void Between(double from, double to, bool inclusive, std::vector<Target>& targets) const;

 private:
  double every_ = 0;
  std::vector<Target> at_;  ///< by depth
};

}  // namespace wellgyro

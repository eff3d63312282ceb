#pragma once

#include <optional>
#include <string>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/plan/expected_end.h"
#include "wellgyro/plan/plan_case.h"
#include "wellgyro/plan/stop_search.h"

namespace wellgyro {

/// What one stop of a plan buys: what the end would be without it, all others kept.
struct StopWorth {
  double ellipse_without = 0;  ///< semi-major axis [m]
  double hidden_without = 0;   ///< [m]
};

/// Where to stop and how long.
struct StopPlan {
  bool feasible = false;
  std::string why_not = {};             ///< where it is not, in words
  std::vector<PlannedStop> stops = {};  ///< in the order of time
  std::vector<StopWorth> worth = {};    ///< of each
  double at_rest = 0;                   ///< [s]
  double cost = 0;                      ///< with what stops cost beside [s]
  /// Time at rest below which no plan meets the ellipse's limit [s]; absent: none does.
  std::optional<double> least_at_rest = {};
  /// Of its cost, stops being at the places and of the lengths that were looked at: the best plan
  /// of one stop or two, all tried, or what three cost beside least_at_rest [s].
  std::optional<double> least_cost = {};
  ExpectedEnd expected = {};     ///< with the stops
  ExpectedEnd without = {};      ///< with none
  PlanValue best_possible = {};  ///< an hour at rest at every fortieth of the way
};

/// The stops that meet `limits` in the least time found, each verified with the whole run, stops
/// and all, put through the estimator: where that says more than the search's own sums the search
/// is held to less. Not feasible where an hour at rest everywhere does not meet them, or where a
/// fault stays above the hidden limit whatever the search tries. One stop at least, unless an
/// azimuth is told. Throws std::invalid_argument as CheckPlanCase(),
/// and for limits that are not positive.
WELLGYRO_EXPORT StopPlan PlanStops(const PlanCase& c, const PlanLimits& limits);

/// The tool with drift, g-dependent errors and bias `factor` times as large.
WELLGYRO_EXPORT PlanCase WorseTool(PlanCase c, double factor);

}  // namespace wellgyro

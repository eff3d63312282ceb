#pragma once

#include <optional>
#include <vector>

#include "wellgyro/plan/stop_information.h"
#include "wellgyro/plan/stop_search.h"

namespace wellgyro {

/// Of all single stops and all pairs of stops at two places the one that meets the ellipse's limit
/// at the least cost; nothing where none costs less than `cost_most` [s]. Times are
/// least_stop and whole kStopGrain more. Hidden faults and PlanLimits::here do not count.
///
/// Every pair is looked at: with both stops as long as the cost allows its ellipse is the least
/// that any split of the time could have, which leaves out nearly all. Of the others the largest
/// eigenvalue is convex along a split of one time.
std::optional<std::vector<StopStand::Rest>> BestOfTwo(const StopInformation& info,
                                                      const PlanLimits& limits, double cost_most);

}  // namespace wellgyro

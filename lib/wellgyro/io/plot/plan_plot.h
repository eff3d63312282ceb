#pragma once

#include <optional>
#include <string>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/plan/stop_plan.h"

namespace wellgyro {

/// A plan as a picture: the well with its stops, how long they are, and what the end is known to
/// with them, without any, and by what is usually done. SVG.
WELLGYRO_EXPORT std::string PlanSvg(const std::string& title, const PlanCase& c,
                                    const PlanLimits& limits, const StopPlan& plan,
                                    const std::vector<PlannedStop>& practice_stops,
                                    const std::optional<ExpectedEnd>& practice);

}  // namespace wellgyro

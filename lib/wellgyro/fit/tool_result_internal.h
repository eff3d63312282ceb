#pragma once

#include "wellgyro/fit/tool_adjust_internal.h"
#include "wellgyro/fit/tool_fit.h"

namespace wellgyro {

/// The adjustment's coefficients as quantities of the report, as groups of the tool model and as
/// its members with their covariance; a loop of hysteresis joins the biases' covariance.
void TakeToolResult(const ToolReadings& readings, const ToolFitSetup& setup, const ToolModel& model,
                    const ToolAdjustment& adjustment, ToolFit& fit);

}  // namespace wellgyro

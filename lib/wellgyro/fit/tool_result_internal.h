#pragma once

#include "wellgyro/fit/tool_adjust_internal.h"
#include "wellgyro/fit/tool_fit.h"
#include "wellgyro/fit/tool_left_out_internal.h"

namespace wellgyro {

/// The adjustment's coefficients as quantities of the report, as groups of the tool model and as
/// its members with their covariance, which the errors of what was left out join, and a loop of
/// hysteresis the biases'.
void TakeToolResult(const ToolReadings& readings, const ToolFitSetup& setup, const ToolModel& model,
                    const ToolAdjustment& adjustment, const LeftOutErrors& left_out, ToolFit& fit);

}  // namespace wellgyro

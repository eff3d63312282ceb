#pragma once

#include <vector>

#include "wellgyro/estimate/setup.h"
#include "wellgyro/record/tool_use.h"
#include "wellgyro/survey/job.h"
#include "wellgyro/survey/run/run_history.h"

namespace wellgyro {

/// The tool's temperature, its change and the inclination in parts of the run of equal length.
std::vector<ToolUse> UsesOf(const RunHistory& history);

/// The covariance that the tool's calibration left, as the run uses the tool, into `setup`, whose
/// errors are then what the job states beyond it. Where the job states less of a kind of error, its
/// covariance shrinks to that.
void TakeCalibration(const Job& job, const RunHistory& history, EstimateSetup& setup);

}  // namespace wellgyro

#pragma once

#include "wellgyro/record/north_fix.h"
#include "wellgyro/survey/job.h"
#include "wellgyro/survey/survey.h"

namespace wellgyro {

/// Sigma of the rate at which a tool at rest seems to roll because it warms [rad/s]: of what its
/// calibration's covariance leaves of the accelerometers between the temperatures at the begin and
/// at the end of the stop. 0 without such a covariance, or where the run's temperatures are not
/// known.
double SigmaOfRollByWarming(const Job& job, const RunSummary& run, const NorthFix& fix);

}  // namespace wellgyro

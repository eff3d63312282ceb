#pragma once

#include "wellgyro/estimate/run_estimate.h"
#include "wellgyro/survey/job.h"
#include "wellgyro/survey/run_history.h"

namespace wellgyro {

/// The run as one adjustment of rotations finds it. Where nothing is found that fits, `fit` says so
/// and what was known on the way is given.
SmoothedRun EstimatedRun(const Job& job, const RunHistory& history);

/// The same of a run that goes on, as a ForwardRun begins with it: without a diagnosis and without
/// another guess. Unsolved where no tie and no fix give a north.
RunEstimate EstimateSoFar(const Job& job, const RunHistory& history);

/// Attitudes and stations of what has been solved.
SmoothedRun SmoothedOf(const RunEstimate& estimate, const RunHistory& history);

}  // namespace wellgyro

#pragma once

#include <cstddef>

#include "wellgyro/estimate/run_estimate.h"
#include "wellgyro/survey/job.h"
#include "wellgyro/survey/run/run_history.h"

namespace wellgyro {

/// The run as one adjustment of rotations finds it. Where nothing is found that fits, `fit` says so
/// and what was known on the way is given.
SmoothedRun EstimatedRun(const Job& job, const RunHistory& history);

/// The same of a run that goes on, as a ForwardRun begins with it: without a diagnosis. Unsolved
/// where no tie and no fix give a north.
RunEstimate EstimateSoFar(const Job& job, const RunHistory& history);

/// The same of a part of a run, at whose begin this much was known.
RunEstimate EstimateSince(const RunState& known, const RunHistory& part);

/// Attitudes and stations of what has been solved.
SmoothedRun SmoothedOf(const RunEstimate& estimate, const RunHistory& history);

}  // namespace wellgyro

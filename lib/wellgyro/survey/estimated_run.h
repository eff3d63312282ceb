#pragma once

#include <cstddef>

#include "wellgyro/estimate/run_estimate.h"
#include "wellgyro/survey/job.h"
#include "wellgyro/survey/run_history.h"

namespace wellgyro {

/// The run as one adjustment of rotations finds it. Where nothing is found that fits, `fit` says so
/// and what was known on the way is given.
SmoothedRun EstimatedRun(const Job& job, const RunHistory& history);

/// The same of a run that goes on, as a ForwardRun begins with it: without a diagnosis. Unsolved
/// where no tie and no fix give a north.
RunEstimate EstimateSoFar(const Job& job, const RunHistory& history);

/// The same from the end of knot `begin`, counted from one, on, where this much was known.
RunEstimate EstimateSince(std::size_t begin, const RunState& known, const RunHistory& history);

/// Attitudes and stations of what has been solved, from that knot on.
SmoothedRun SmoothedOf(const RunEstimate& estimate, const RunHistory& history,
                       std::size_t begin = 0);

}  // namespace wellgyro

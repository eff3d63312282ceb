#pragma once

#include <vector>

#include "wellgyro/survey/job.h"
#include "wellgyro/survey/stations/draft.h"
#include "wellgyro/survey/stations/pass_covariance_internal.h"

namespace wellgyro {

/// The passes of a run, each in the order of depth, with hole attitudes and the run's way between
/// stations but without positions. A stop from which the tool goes out of the hole belongs to the
/// pass that follows. A pass that goes on down from within the hole carries the stations of the
/// run that led there before its own.
std::vector<PassItems> SplitPasses(const Job& job, const DraftedRun& run);

}  // namespace wellgyro

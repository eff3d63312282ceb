#pragma once

#include <vector>

#include "wellgyro/record/check.h"
#include "wellgyro/survey/job.h"
#include "wellgyro/survey/survey.h"

namespace wellgyro {

/// Samples that came without fault: saturation, temperature, turn per sample, clock.
void CheckSamples(const Job& job, const RunSummary& run, std::vector<Check>& checks);

/// What stops tell of the tool and of the run: turning at rest, gyro biases from stop to stop, what
/// the carried azimuth was off at the last north, and magnetic azimuths.
void CheckStops(const Job& job, const RunSummary& run, std::vector<Check>& checks);

/// How the run fits as a whole, and the errors of the tool that the adjustment found against their
/// priors.
void CheckFit(const Job& job, const RunSummary& run, std::vector<Check>& checks);

}  // namespace wellgyro

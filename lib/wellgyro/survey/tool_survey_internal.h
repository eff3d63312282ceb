#pragma once

#include "wellgyro/base/time.h"
#include "wellgyro/record/north_fix.h"
#include "wellgyro/survey/job.h"
#include "wellgyro/survey/survey.h"

namespace wellgyro {

/// So long after the last sample or mark a tool that was at rest then still hangs as it did: a
/// connection takes some minutes, and what is ordered meanwhile belongs to that place.
inline constexpr Duration kHeld = Duration::Seconds(600);

/// The north fix that contradicts the job's external azimuth most, where one does.
const NorthFix* Contradiction(const Job& job, const RunSummary& run);

}  // namespace wellgyro

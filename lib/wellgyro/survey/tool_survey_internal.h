#pragma once

#include <optional>

#include "wellgyro/base/time.h"
#include "wellgyro/survey/job.h"
#include "wellgyro/survey/survey.h"

namespace wellgyro {

/// So long after the last sample or mark a tool that was at rest then still hangs as it did: a
/// connection takes some minutes, and what is ordered meanwhile belongs to that place.
inline constexpr Duration kHeld = Duration::Seconds(600);

/// What contradicts the job's external azimuth most.
struct Contradicted {
  double sigmas = 0;
  std::optional<double> md;  ///< of one north; absent: all of them together [m]
};

/// Where something does: the norths that the run found against the azimuth with which it begins,
/// or one of them against all the rest.
std::optional<Contradicted> Contradiction(const Job& job, const RunSummary& run);

}  // namespace wellgyro

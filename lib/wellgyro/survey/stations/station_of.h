#pragma once

#include "wellgyro/attitude/station_state.h"
#include "wellgyro/survey/job.h"
#include "wellgyro/survey/stations/draft.h"

namespace wellgyro {

/// The station of a draft with the hole's attitude and its covariance, without a position. `state`
/// is as known on the way or adjusted, nullptr where the draft carries its own attitude.
Station StationOf(const Job& job, const Draft& draft, const StationState* state);

}  // namespace wellgyro

#pragma once

#include <span>
#include <vector>

#include "wellgyro/attitude/station_state.h"
#include "wellgyro/base/export.h"

namespace wellgyro {

/// The states of a run's stations as best known: the first as the last adjustment found them, the
/// later ones as they were known on the way (`known`, all stations of the run).
///
/// Where the two meet the errors stay correlated as they were on the way, by as much as the
/// adjustment has left of them, so that the covariance of all together remains one.
WELLGYRO_EXPORT std::vector<StationState> JoinStates(std::span<const StationState> adjusted,
                                                     std::span<const StationState> known);

}  // namespace wellgyro

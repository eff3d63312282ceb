#pragma once

#include <span>
#include <vector>

#include "wellgyro/attitude/filter_state.h"
#include "wellgyro/base/export.h"

namespace wellgyro {

/// The states of a run's stations as best known: the first as the last adjustment found them, the
/// later ones as the filter did (`filtered`, all stations of the run), or, where it had no azimuth
/// yet, as the first north showed (`backwards`, may be shorter).
///
/// An adjustment may have other states than the filter, and is surer of the stations it has seen:
/// where the two meet the errors are correlated through the azimuth alone, as strongly as in the
/// filter, so that the covariance of all of them together remains one.
WELLGYRO_EXPORT std::vector<StationState> JoinStates(std::span<const StationState> adjusted,
                                                     std::span<const StationState> backwards,
                                                     std::span<const StationState> filtered);

}  // namespace wellgyro

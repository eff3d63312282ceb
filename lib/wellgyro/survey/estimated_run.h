#pragma once

#include <span>

#include "wellgyro/attitude/filter.h"
#include "wellgyro/attitude/smoother.h"
#include "wellgyro/record/increment.h"
#include "wellgyro/survey/job.h"

namespace wellgyro {

/// The run as one adjustment of rotations finds it from its increments: attitudes of the epochs and
/// states of the marked stations of `history`, as Smooth() gives them. Where the increments do not
/// reach the last epochs, the first ones only.
///
/// Without a north, or where nothing is found that fits, `fit` says so and the smoothed run is
/// given.
SmoothedRun EstimatedRun(const Job& job, const FilterHistory& history,
                         std::span<const Increment> increments);

}  // namespace wellgyro

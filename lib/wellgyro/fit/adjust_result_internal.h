#pragma once

#include <vector>

#include <Eigen/Core>

#include "wellgyro/attitude/smoother.h"
#include "wellgyro/fit/adjust_problem_internal.h"
#include "wellgyro/fit/selected_inverse_internal.h"

namespace wellgyro {

/// Attitudes of all epochs and states of all marked stations, from a solved problem. `known`: of
/// each node, whether its azimuth is worth anything.
SmoothedRun ResultOf(const AdjustProblem& problem, const SelectedInverse& inverse,
                     const std::vector<bool>& known);

/// Azimuth growth of every epoch of a span, errors and the Earth taken off, and how the rest of the
/// span's growth is shared out: the azimuth at the end of each of its epochs.
std::vector<double> AzimuthsWithin(const AdjustProblem& problem, std::size_t span);

}  // namespace wellgyro

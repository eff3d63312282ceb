#pragma once

#include <cstddef>
#include <span>

#include "wellgyro/estimate/run_estimate.h"
#include "wellgyro/estimate/run_solver.h"

namespace wellgyro {

/// Of the solver's last linearisation, into `result`: the covariance of every node, the
/// cross-covariances of the marked ones (ascending), the tool's errors, and the freedom that is
/// left to each kind of residual. Of a part of a run the first marked node is linked to the last
/// one of the part before.
void PassBack(RunSolver& solver, std::span<const std::size_t> marked, RunEstimate& result);

}  // namespace wellgyro

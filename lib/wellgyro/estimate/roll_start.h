#pragma once

#include <optional>
#include <span>
#include <vector>

#include "wellgyro/record/run_knot.h"

namespace wellgyro {

/// Of each knot, by how much the roll rate changes behind it where gravity plainly shows a start or
/// a stop: beyond 3.5 of what is usual in the run and of its own sigma, over 1, 4 or 12 knots; else
/// 0 [rad/s]. It widens the walk of the roll rate there, so that a tool that once spins up is not
/// taken for one that always jerks. Empty where the roll is nowhere seen.
std::vector<double> RollStarts(std::span<const RunKnot> knots);

/// What the roll rate usually changes by from one knot to the next where it is plainest, 1-sigma
/// [rad/s]; absent where it is nowhere seen.
std::optional<double> UsualRollChange(std::span<const RunKnot> knots);

}  // namespace wellgyro

#pragma once

#include <span>
#include <vector>

#include "wellgyro/estimate/diagnosis.h"
#include "wellgyro/record/run_knot.h"
#include "wellgyro/record/run_stretch.h"

namespace wellgyro {

/// The run in stretches of kStretchKnots knots, with the residuals that `tests` found in them, if
/// it is done.
std::vector<RunStretch> StretchesOf(const Diagnosis& tests, std::span<const RunKnot> knots);

}  // namespace wellgyro

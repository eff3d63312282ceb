#pragma once

#include <span>
#include <vector>

#include "wellgyro/record/run_knot.h"

namespace wellgyro {

/// Where gravity does not show the roll, near vertical, the Earth's rate across the tool does: it
/// stands still in L, so that its phase in the tool turns back by what psi misses of the roll. The
/// median over some twenty knots where the gyros read nothing but the Earth, `horizontal` [rad/s];
/// 0 elsewhere [rad/s]. For the start only.
std::vector<double> HiddenRoll(std::span<const RunKnot> knots, double horizontal);

}  // namespace wellgyro

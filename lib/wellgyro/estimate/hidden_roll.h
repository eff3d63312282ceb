#pragma once

#include <span>
#include <vector>

#include "wellgyro/record/run_knot.h"

namespace wellgyro {

/// Where gravity does not show the roll, near vertical, the rate across the tool does: the Earth's,
/// `horizontal` [rad/s], and that of a bend of the hole stand still in L for some time, so that
/// their phase in the tool turns back by what psi misses of the roll. The median over some twenty
/// knots [rad/s]; 0 where the roll is seen or too little is read. For the start only.
std::vector<double> HiddenRoll(std::span<const RunKnot> knots, double horizontal);

}  // namespace wellgyro

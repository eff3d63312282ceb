#pragma once

#include <span>
#include <vector>

#include "wellgyro/record/run_knot.h"

namespace wellgyro {

/// Of each knot, whether the rate across the tool keeps its size about it. It does not where a bend
/// begins or ends: it then turns in L.
std::vector<bool> SteadyAcross(std::span<const RunKnot> knots, double angle_random_walk);

/// Where gravity does not show the roll, near vertical, the rate across the tool does: the Earth's,
/// `horizontal` [rad/s], and that of a bend of the hole stand still in L for some time, so that
/// their phase in the tool turns back by the roll. The median over the knots about it that read it
/// and are steady, less the rate of psi [rad/s]; 0 where the roll is seen or too little is read.
/// For the start only.
std::vector<double> HiddenRoll(std::span<const RunKnot> knots, double horizontal,
                               const std::vector<bool>& steady);

}  // namespace wellgyro

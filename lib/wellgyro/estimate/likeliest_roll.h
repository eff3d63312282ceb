#pragma once

#include <span>
#include <vector>

#include "wellgyro/estimate/setup.h"
#include "wellgyro/record/run_knot.h"

namespace wellgyro {

/// By how much the tool rolls faster than psi in each knot [rad/s]; 0 where psi follows gravity, or
/// at rest. For the start of a solution only.
///
/// From one knot's middle to the next the roll shows twice, by its angle modulo a turn: in
/// gravity's phase, down to where it is three of the accelerometers' sigmas, and in that of the
/// rate across, the Earth's and the hole's bend, which stand still in L for some time. The
/// likeliest sequence of rates under both, whose changes from knot to knot are small or few, is
/// found by dynamic programming (Viterbi, 1967) on a grid of rates.
/// `by_phases`: the rates are then what the phases say, by the turns that the grid tells; of a
/// swing no step of the grid remains, of a phase that drifts all does.
std::vector<double> LikeliestRoll(std::span<const RunKnot> knots, const EstimateSetup& setup,
                                  bool by_phases = false);

}  // namespace wellgyro

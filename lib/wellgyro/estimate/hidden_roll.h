#pragma once

#include <span>
#include <vector>

#include "wellgyro/estimate/run_state.h"
#include "wellgyro/estimate/setup.h"
#include "wellgyro/estimate/start.h"
#include "wellgyro/record/run_knot.h"

namespace wellgyro {

/// Where psi follows neither gravity nor a third axis, and the tool does not rest.
bool RollIsHidden(const RunKnot& knot);
bool AnyRollIsHidden(std::span<const RunKnot> knots);

/// Roll rate of each hidden knot less the rate of psi [rad/s]; else 0, and where fewer than ten
/// knots in a row hide it.
///
/// Near vertical the gyros across read the Earth's rate as it turns in the tool, that of a bend,
/// and what is fixed in the tool, which may be more. From rest to rest the rate is that of
/// LikeliestRoll(), so that turns are not lost where the tool starts and stops. What is fixed and
/// how the hole bends is taken from RollWindowsOf(). Along a bend that is not known the path goes
/// on at the rate that it has, and of a swing it follows a part.
///
/// For the start of a solution only, never a measurement: to some 10 deg of heading where the
/// Earth's rate stands out of gyros and bends by three sigmas a second, up to 21 rpm.
std::vector<double> HiddenRoll(std::span<const RunKnot> knots, const EstimateSetup& setup);

/// That path, and for a roll that swings, of which it follows a part, the rate in the middle of the
/// swing by the median of the neighbours' rates. Near vertical a solution has many minima; the
/// evidence chooses among those that these lead to.
std::vector<std::vector<double>> HiddenRolls(std::span<const RunKnot> knots,
                                             const EstimateSetup& setup);

/// A start nearby a solution of the run: its nodes, those of hidden knots turned to the headings of
/// LikeliestRoll() by the errors and bends that the solution has found. Near vertical a solution
/// may be a local minimum, wrong where the tool swings, starts or stops and right elsewhere; what
/// it knows of the tool and the hole then shows the roll in those places too. Drift and swing are
/// zero. `before`: of a part of a run, else nullptr.
NodeGuess RollAbout(const EstimateSetup& setup, std::span<const RunKnot> knots,
                    const RunState* before, std::span<const Node> nodes,
                    const BorderVector& border);

}  // namespace wellgyro

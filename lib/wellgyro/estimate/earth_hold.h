#pragma once

#include <span>
#include <vector>

#include "wellgyro/estimate/setup.h"
#include "wellgyro/record/run_knot.h"

namespace wellgyro {

/// Rates found from knot to knot drift: what turns the lean adds the Earth's own rate, 0.03 rad/s
/// at 0.1 deg. So that the roll stays right for hours near vertical, `hidden` [rad/s], what each
/// hidden knot rolls by beyond psi, is changed until the Earth's rate across, found in windows of
/// half a minute, has one direction in all of them. For the start of a solution only.
void HoldToEarth(std::span<const RunKnot> knots, const EstimateSetup& setup,
                 std::vector<double>& hidden);

}  // namespace wellgyro

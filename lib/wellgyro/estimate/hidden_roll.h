#pragma once

#include <span>
#include <vector>

#include "wellgyro/record/run_knot.h"

namespace wellgyro {

/// Where psi follows neither gravity nor a third axis, and the tool does not rest.
bool RollIsHidden(const RunKnot& knot);
bool AnyRollIsHidden(std::span<const RunKnot> knots);

/// Whether a rate across the tool can be the Earth's, by its ratio to what that is there: of a bend
/// that turns as much, at an angle b to it, the sum is 2 cos b/2, within 1/sqrt(2) and sqrt(2) for
/// b from 90 to 139 deg alone, one in four.
inline constexpr double kEarthsLeast = 0.7, kEarthsMost = 1.4;
constexpr bool MayBeEarths(double ratio) { return ratio > kEarthsLeast && ratio < kEarthsMost; }

/// Of each knot, whether the rate across the tool keeps its size about it. It does not where a bend
/// begins or ends: it then turns in L.
std::vector<bool> SteadyAcross(std::span<const RunKnot> knots, double angle_random_walk);

/// Roll rate near vertical, where gravity does not show it, less the rate of psi [rad/s]. The rate
/// across the axis, the Earth's (`horizontal` [rad/s]) and that of a bend, keeps its direction in L
/// for some time, so that its phase in the tool turns at minus the roll rate. The median over the
/// steady knots nearby that read it; 0 where gravity shows the roll or too few knots read the rate.
/// For the start only, never a measurement.
std::vector<double> HiddenRoll(std::span<const RunKnot> knots, double horizontal,
                               const std::vector<bool>& steady);

}  // namespace wellgyro

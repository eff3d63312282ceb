#pragma once

#include <optional>
#include <span>
#include <vector>

#include "wellgyro/record/run_knot.h"

namespace wellgyro {

/// Outlier test of the roll rate: of each knot, the change after it where gravity shows a start or
/// stop, else 0 [rad/s]. A change over 1, 4 or 12 knots is one where it exceeds 3.5 times what is
/// usual in the run and 3.5 times its own sigma. Kept apart from the random walk, one spin-up does
/// not make that large for the whole run. `swung`: the turn by a swing in each knot, which is no
/// start [rad]; empty: nothing swings.
std::vector<double> RollStarts(std::span<const RunKnot> knots, std::span<const double> swung = {});

/// What evidence that takes RollStarts() for sigmas owes, as -2 ln of a probability: they were read
/// from the run. Which m of n knots they are has exp(-n H(m / n)), H the entropy of a share; and
/// how large each is, by a sigma anywhere between the bounds of the walk, L = ln(most / least), the
/// density 1 / (2 L |x|) of a change x in place of 0.242 / |x|, that of its own size for sigma.
double CostOfStarts(std::span<const double> starts);

/// Of each knot, by how much the roll rate may at most change behind it with the speed along the
/// hole, seen or not [rad/s]: within 5 s of a change of the speed by 2 rad/m of that; else 0.
std::vector<double> SpeedStarts(std::span<const RunKnot> knots);
/// The same of the last knot alone.
double LastSpeedStart(std::span<const RunKnot> knots);

/// What the roll rate usually changes by from one knot to the next where it is plainest, 1-sigma
/// [rad/s]; absent where it is nowhere seen.
std::optional<double> UsualRollChange(std::span<const RunKnot> knots);

/// Start of the search for the roll's random walk, or its value where none is sought
/// [rad/s/sqrt(s)]: UsualRollChange() rounded up to a power of ten. The noise of the measured rates
/// is part of that change, so that the walk is rather too large.
double RollWalkBy(std::span<const RunKnot> knots);

/// Somewhere the tool starts or stops, by `speed_starts`, and gravity does not show how it rolls.
bool HidesAStart(std::span<const RunKnot> knots, std::span<const double> speed_starts);

/// What the roll rate may do where the speed changes: 20 rpm at 1 m/s [rad/m]. With 1 or 4 the end
/// of a well that kicks off moves by 0.09 or 0.03 sigma.
inline constexpr double kRollPerSpeed = 2;

/// Bounds of the roll's random walk [rad/s/sqrt(s)]: 0.1 of a tool that jerks; 1e-7 turns it by
/// 1e-7 t^1.5 / sqrt(3) = a quarter of a degree in half an hour, which is as good as none.
inline constexpr double kRollWalkMost = 0.1, kRollWalkLeast = 1e-7;

}  // namespace wellgyro

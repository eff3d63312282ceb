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

/// Of each knot, by how much the roll rate may at most change behind it with the speed along the
/// hole, seen or not [rad/s]: within 5 s of a change of the speed by 2 rad/m of that; else 0.
std::vector<double> SpeedStarts(std::span<const RunKnot> knots);
/// The same of the last knot alone.
double LastSpeedStart(std::span<const RunKnot> knots);

/// What the roll rate usually changes by from one knot to the next where it is plainest, 1-sigma
/// [rad/s]; absent where it is nowhere seen.
std::optional<double> UsualRollChange(std::span<const RunKnot> knots);

/// From which a roll walk is looked for, or taken where none is: the decade above what the rate
/// usually changes by, which its own noise is part of [rad/s/sqrt(s)].
double RollWalkBy(std::span<const RunKnot> knots);

/// Somewhere the tool starts or stops, by `speed_starts`, and gravity does not show how it rolls.
bool HidesAStart(std::span<const RunKnot> knots, std::span<const double> speed_starts);

/// The roll walks that there are, from that of a tool that jerks to one that turns it by a quarter
/// of a degree in half an hour, which is as good as none [rad/s/sqrt(s)].
inline constexpr double kRollWalkMost = 0.1, kRollWalkLeast = 1e-7;

}  // namespace wellgyro

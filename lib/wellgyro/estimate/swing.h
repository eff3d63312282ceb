#pragma once

#include <optional>
#include <span>

#include "wellgyro/estimate/node.h"
#include "wellgyro/record/run_knot.h"

namespace wellgyro {

/// Angular frequency at which the tool's roll swings, if most of what its rate does where gravity
/// shows it, but for starts and stops, is one line between a period of a minute and two knots
/// [rad/s]: within kSwingSigma.
std::optional<double> SwingOf(std::span<const RunKnot> knots);
/// The same of a solution whose rate walks, wherever the tool moves: a roll that gravity hardly
/// shows is known there by all that the run says.
std::optional<double> SwingOf(std::span<const RunKnot> knots, std::span<const Node> nodes);

/// A quarter of the width of a line of 600 s, 2 pi / 600 s / 4 [rad/s].
inline constexpr double kSwingSigma = 2.6e-3;

}  // namespace wellgyro

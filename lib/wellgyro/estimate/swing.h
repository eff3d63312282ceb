#pragma once

#include <optional>
#include <span>

#include "wellgyro/record/run_knot.h"

namespace wellgyro {

/// Angular frequency at which the tool's roll swings, if most of what its rate does where gravity
/// shows it is one line between a period of a minute and two knots [rad/s]:
/// within kSwingSigma, a quarter of the width of a line of 600 s.
std::optional<double> SwingOf(std::span<const RunKnot> knots);

inline constexpr double kSwingSigma = 2.6e-3;

}  // namespace wellgyro

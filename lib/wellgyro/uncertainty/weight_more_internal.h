#pragma once

#include <numbers>
#include <span>

#include "wellgyro/uncertainty/weight.h"

namespace wellgyro {

inline constexpr double kHalfSqrt2 = std::numbers::sqrt2 / 2;

/// Of inclination alone, of azimuth alone.
constexpr Weights Inc(double w) { return {0, w, 0}; }
constexpr Weights Azi(double w) { return {0, 0, w}; }

/// Magnetic tools corrected for axial interference, inclination-only and six-axis tools: OWSG Sets
/// A and B Rev 5.1, which follow SPE 63275 and SPE 67616.
std::span<const WeightFunction> MoreWeights();

}  // namespace wellgyro

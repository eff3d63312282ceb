#pragma once

#include <span>

#include "wellgyro/uncertainty/weight.h"

namespace wellgyro {

/// Magnetic tools corrected for axial interference, inclination-only and six-axis tools: OWSG Sets
/// A and B Rev 5.1, which follow SPE 63275 and SPE 67616.
std::span<const WeightFunction> MoreWeights();

}  // namespace wellgyro

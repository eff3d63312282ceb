#pragma once

#include "wellgyro/base/export.h"
#include "wellgyro/record/knot.h"
#include "wellgyro/record/noise.h"

namespace wellgyro {

/// 1-sigma prior of every constant error that a knot knows, in its unit. Zero for the two gyro
/// biases: what they are takes the noise coefficients too.
WELLGYRO_EXPORT Knot::SourceVector SourceSigmas(const ErrorPriors& errors);

}  // namespace wellgyro

#pragma once

#include <cstdint>

#include "wellgyro/estimate/setup.h"
#include "wellgyro/math/random.h"
#include "wellgyro/simulate/tool_errors.h"

namespace wellgyro::testing {

/// One tool and one place out of all that a job speaks of: the tool's errors from its priors,
/// gravity and its growth with depth from what the estimator leaves to the Earth model. Sigmas are
/// true on the average only of runs of which each that they count was drawn.
inline void DrawErrors(const ErrorPriors& priors, const NoiseCoefficients& noise,
                       std::uint64_t seed, Simulation& simulation) {
  simulation.tool.errors = DrawToolErrors(priors, noise, seed);
  Random random(7'000'000 + seed);
  const EstimateSetup earth;
  simulation.earth.gravity_anomaly = earth.sigma_gravity * random.Normal();
  simulation.earth.gravity_gradient_anomaly = earth.sigma_gravity_gradient * random.Normal();
}

}  // namespace wellgyro::testing

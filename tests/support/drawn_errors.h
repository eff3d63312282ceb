#pragma once

#include <cstdint>

#include "wellgyro/estimate/setup.h"
#include "wellgyro/math/random.h"
#include "wellgyro/simulate/tool_errors.h"

namespace wellgyro::testing {

/// Gravity and its growth with depth of one place, from what the estimator leaves to the Earth
/// model.
inline void DrawGravity(std::uint64_t seed, Simulation& simulation) {
  Random random(7'000'000 + seed);
  const EstimateSetup earth;
  simulation.earth.gravity_anomaly = earth.sigma_gravity * random.Normal();
  simulation.earth.gravity_gradient_anomaly = earth.sigma_gravity_gradient * random.Normal();
}

/// One tool and one place out of all that a job speaks of. A sigma is true on the average only of
/// runs of which each error that it counts was drawn.
inline void DrawErrors(const ErrorPriors& priors, const NoiseCoefficients& noise,
                       std::uint64_t seed, Simulation& simulation) {
  simulation.tool.errors = DrawToolErrors(priors, noise, seed);
  DrawGravity(seed, simulation);
}

}  // namespace wellgyro::testing

#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace wellgyro {

/// The likeliest step of a series' level.
struct LevelStep {
  std::size_t at = 0;   ///< first value behind it
  double size = 0;      ///< behind less before
  double evidence = 0;  ///< what it raises 2 ln(likelihood) by
};

/// Of white noise about a level that walks (local level model), the ratio of walk to noise being
/// the likeliest, with the step and without. Without a walk the evidence is the square of the
/// CUSUM's maximum over sqrt(t (1 - t)), a Brownian bridge; with one it is that of the level's
/// auxiliary residual (Harvey and Koopman, J. Bus. Econ. Stat. 10, 1992). Nothing for fewer than
/// 200 values, or where all are alike.
std::optional<LevelStep> FindLevelStep(std::span<const double> values);

}  // namespace wellgyro

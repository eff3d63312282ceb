#pragma once

#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "wellgyro/estimate/layout.h"
#include "wellgyro/estimate/run_solver.h"
#include "wellgyro/estimate/start.h"

namespace wellgyro {

/// Where a run may be solved. The evidence is that of a SolveReport, the smaller the better.
struct Solution {
  double evidence = HUGE_VAL;
  NodeGuess nodes;
  BorderVector border;
  std::optional<double> swing;  ///< of the setup [rad/s]
  RollBegin begin;
};

/// Keeps another solution than the chosen one, of `evidence` and `nodes`, if it comes near it. One
/// that is found again is kept once, as the better of the two.
void AddRival(Solution other, double evidence, std::span<const Node> nodes,
              std::vector<Solution>& rivals);

}  // namespace wellgyro

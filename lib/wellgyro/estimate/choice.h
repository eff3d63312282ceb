#pragma once

#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include "wellgyro/estimate/rivals.h"
#include "wellgyro/estimate/run_solver.h"
#include "wellgyro/estimate/run_state.h"
#include "wellgyro/estimate/setup.h"
#include "wellgyro/estimate/start.h"
#include "wellgyro/record/run_knot.h"

namespace wellgyro {

/// The solution of greatest evidence of those that some guesses lead to.
struct Choice {
  std::unique_ptr<RunSolver> solver;  ///< null: no guess leads to one
  SolveReport report;
  std::vector<Solution> rivals;      ///< others that come near it
  double least_evidence = HUGE_VAL;  ///< of all guesses, those that lead to no solution too
};

/// Solves the run from each guess, by each model of its roll rate: a random walk, that from several
/// begins (RollBeginsOf), and where the tool swings, that and a swing. Where the roll is hidden it
/// solves again from nearby each solution (RollAbout), which may be a local minimum. `before`: of a
/// part of a run, else nullptr.
Choice Choose(const EstimateSetup& setup, std::span<const RunKnot> knots,
              std::span<const NodeGuess> guesses, const RunState* before);

/// Joins the choice among other guesses: true where its evidence is better, which then is the
/// choice. The worse of the two may remain a rival.
bool Join(Choice other, Choice& choice);

}  // namespace wellgyro

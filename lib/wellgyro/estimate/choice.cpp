#include "wellgyro/estimate/choice.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "wellgyro/estimate/hidden_roll.h"
#include "wellgyro/estimate/swing.h"
#include "wellgyro/record/decides.h"

namespace wellgyro {
namespace {

constexpr int kSolveIterations = 40;  // at most, before the scales of the roll are sought
// Solvers that stand within a sigma of one minimum, over all unknowns together, have an evidence,
// -2 ln of a density, within 1 of its.
constexpr double kSameEvidence = 1;
// Each is begun from a better one: of random wells that fail without, one solution was bettered a
// second time, by 48, and none a third.
constexpr int kAboutMost = 3;

/// Where a solver stood before it sought the scales of the roll.
struct Approached {
  std::optional<double> swing;  ///< of the setup [rad/s]
  RollBegin begin;
  double evidence = 0;
  NodeGuess nodes;
};

/// Solves one run from guess after guess and keeps the best solution.
class Search {
 public:
  Search(const EstimateSetup& setup, std::span<const RunKnot> knots, const RunState* before)
      : setup_(setup),
        knots_(knots),
        before_(before),
        begins_(RollBeginsOf(knots)),
        may_swing_(setup.may_swing && !setup.third_axis),
        hides_roll_(AnyRollIsHidden(knots)) {
    if (may_swing_) swing_ = SwingOf(knots);
  }

  /// From one guess, and from nearby what it leads to; the best of its solutions.
  Solution From(const NodeGuess& guess) {
    Solution solution;
    SolveByEach(guess, solution);
    SolveAbout(solution);
    return solution;
  }

  Choice Chosen(std::vector<Solution> solutions) && {
    if (!choice_.solver) return std::move(choice_);
    for (Solution& s : solutions) {
      AddRival(std::move(s), choice_.report.evidence, choice_.solver->nodes(), choice_.rivals);
    }
    return std::move(choice_);
  }

 private:
  EstimateSetup SetupWith(std::optional<double> swing) const {
    EstimateSetup with = setup_;
    with.swing = swing;
    return with;
  }

  bool WasThere(const RunSolver& solver, const RollBegin& begin);
  NodeGuess Solve(const NodeGuess& guess, std::optional<double> swing, const RollBegin& begin,
                  Solution& solution);
  void SolveAsHiddenSwing(const NodeGuess& walk, Solution& solution);
  void SolveByEach(const NodeGuess& guess, Solution& solution);
  void SolveAbout(Solution& solution);

  const EstimateSetup& setup_;
  std::span<const RunKnot> knots_;
  const RunState* before_;
  std::vector<RollBegin> begins_;  ///< of a roll rate that walks
  bool may_swing_, hides_roll_;
  std::optional<double> swing_;  ///< of the roll where gravity shows it [rad/s]
  std::vector<Approached> approached_;
  Choice choice_;
};

/// What follows from where the solver stands has been tried: as the same model it was there before,
/// to a sigma over all unknowns together. Else it is noted.
bool Search::WasThere(const RunSolver& solver, const RollBegin& begin) {
  if (!solver.IsNear()) return false;
  Approached now{solver.setup().swing, begin, solver.Evidence(), solver.nodes()};
  const bool there = std::ranges::any_of(approached_, [&](const Approached& before) {
    return before.swing == now.swing && before.begin == now.begin &&
           std::abs(before.evidence - now.evidence) < kSameEvidence &&
           SameSolution(before.nodes, now.nodes);
  });
  if (!there) approached_.push_back(std::move(now));
  return there;
}

/// Solves from one guess, with a swing of this frequency or none, unless it leads where one before
/// it did; keeps the solution where it betters those before. Returns where it ended.
NodeGuess Search::Solve(const NodeGuess& guess, std::optional<double> swing, const RollBegin& begin,
                        Solution& solution) {
  auto solver = std::make_unique<RunSolver>(SetupWith(swing), knots_, before_);
  solver->nodes() = guess;
  const double best = choice_.solver ? choice_.report.evidence : HUGE_VAL;
  solver->Approach(kSolveIterations, begin);
  if (WasThere(*solver, begin)) return solver->nodes();
  const SolveReport report = solver->Settle(best + kDecides);
  NodeGuess nodes = solver->nodes();
  choice_.least_evidence = std::min(choice_.least_evidence, report.evidence);
  if (!report.converged || !(report.evidence < solution.evidence)) return nodes;
  solution = {report.evidence, nodes, solver->border(), swing, begin};
  if (choice_.solver && !(report.evidence < choice_.report.evidence)) return nodes;
  choice_.report = report;
  choice_.solver = std::move(solver);
  return nodes;
}

/// Solves from where a walk led, as that and the swing that it shows, where only it shows one.
void Search::SolveAsHiddenSwing(const NodeGuess& walk, Solution& solution) {
  if (swing_ || !may_swing_ || !hides_roll_) return;
  const std::optional<double> swing = SwingOf(knots_, walk);
  if (swing) Solve(walk, swing, {}, solution);
}

/// Solves from one guess with the roll rate as the setup has it, a random walk, and, where it
/// swings, as that and a swing, whose frequency gravity shows or else, where the roll is hidden,
/// the walk's solution.
void Search::SolveByEach(const NodeGuess& guess, Solution& solution) {
  if (swing_) Solve(guess, swing_, {}, solution);
  NodeGuess walk;
  for (const RollBegin& begin : begins_) {
    const double evidence = solution.evidence;
    NodeGuess nodes = Solve(guess, setup_.swing, begin, solution);
    if (walk.empty() || solution.evidence < evidence) walk = std::move(nodes);
  }
  SolveAsHiddenSwing(walk, solution);
}

/// Solves again from nearby a solution, as the model that fits best there, as long as that is
/// better, where it may be a local minimum.
void Search::SolveAbout(Solution& solution) {
  for (int i = 0; i < kAboutMost && hides_roll_ && !solution.nodes.empty(); ++i) {
    const double evidence = solution.evidence;
    const std::optional<double> swing = solution.swing;
    const RollBegin begin = solution.begin;
    const NodeGuess about =
        RollAbout(SetupWith(swing), knots_, before_, solution.nodes, solution.border);
    const NodeGuess nodes = Solve(about, swing, begin, solution);
    SolveAsHiddenSwing(nodes, solution);
    if (!(solution.evidence < evidence - kDecides)) return;
  }
}

}  // namespace

Choice Choose(const EstimateSetup& setup, std::span<const RunKnot> knots,
              std::span<const NodeGuess> guesses, const RunState* before) {
  Search search(setup, knots, before);
  std::vector<Solution> solutions;
  for (const NodeGuess& guess : guesses) solutions.push_back(search.From(guess));
  return std::move(search).Chosen(std::move(solutions));
}

bool Join(Choice other, Choice& choice) {
  if (!other.solver) return false;
  const bool better = !choice.solver || other.report.evidence < choice.report.evidence;
  if (better) std::swap(choice, other);
  const auto add = [&choice](Solution rival) {
    AddRival(std::move(rival), choice.report.evidence, choice.solver->nodes(), choice.rivals);
  };
  for (Solution& rival : other.rivals) add(std::move(rival));
  if (other.solver) {
    add({other.report.evidence, other.solver->nodes(), other.solver->border(),
         other.solver->setup().swing});
  }
  return better;
}

}  // namespace wellgyro

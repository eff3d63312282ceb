#include "wellgyro/estimate/run_estimate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <memory>
#include <optional>
#include <utility>

#include <Eigen/Cholesky>

#include "wellgyro/estimate/end_of_run.h"
#include "wellgyro/estimate/hidden_roll.h"
#include "wellgyro/estimate/rivals.h"
#include "wellgyro/estimate/swing.h"
#include "wellgyro/math/linear_algebra.h"
#include "wellgyro/record/decides.h"
#include "wellgyro/record/unknown_angle.h"

namespace wellgyro {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kSolveIterations = 40;  // at most, before the scales of the roll are sought
// A sum of squares this many sigmas above its freedom is not chance, P(x > 4) = 3.2e-5: one run in
// 30 000.
constexpr double kTooLarge = 4;
// Solvers that stand within a sigma of one minimum, over all unknowns together, have an evidence,
// -2 ln of a density, within 1 of its.
constexpr double kSameEvidence = 1;
// Each takes the noise to what the residuals about the last solution say; the third moves it by
// less than a per cent.
constexpr int kNoiseRounds = 3;
// Each is begun from a better one: of random wells that fail without, one solution was bettered a
// second time, by 48, and none a third.
constexpr int kAboutMost = 3;

/// Covariance of the sources' constant errors, from the border's; zero for those it does not have.
ErrorMatrix OfSources(const Layout& layout, const BorderMatrix& border) {
  ErrorMatrix cov = ErrorMatrix::Zero();
  for (int i = 0; i < kErrorSources; ++i) {
    for (int j = 0; j < kErrorSources; ++j) {
      const int row = layout.source[static_cast<std::size_t>(i)];
      const int column = layout.source[static_cast<std::size_t>(j)];
      if (row != kAbsent && column != kAbsent) cov(i, j) = border(row, column);
    }
  }
  return cov;
}

/// Backward pass: the covariance of every node, the cross-covariances of the marked ones, and the
/// freedom that is left to each kind of residual. Of a part of a run the first marked node is
/// linked to the last one of the part before.
class Sweep {
 public:
  Sweep(RunSolver& solver, std::span<const std::size_t> marked, RunEstimate& result)
      : solver_(solver),
        columns_(LinkedColumns(solver.layout())),
        marked_(marked),
        left_(marked.size()),
        result_(result) {}

  void Run() {
    const Elimination& e = solver_.elimination();
    const Layout& layout = solver_.layout();
    EdgeMatrix next = e.LastCovariance();
    const std::size_t n = solver_.knots().size();
    result_.cov_phi_T.resize(n + 1);
    result_.marked.resize(marked_.size());
    TakeErrors(next);
    At(n, next);
    solver_.BeginMeasure();
    for (std::size_t k = n; k-- > 0;) {
      const BehindMatrix gain = e.Gain(k);
      BehindMatrix with_next;
      const EdgeMatrix here = e.CovarianceBefore(k, gain, next, with_next);
      solver_.Measure(k, here, next, with_next);
      if (link_.size() > 0) link_.topRows(layout.node) = (gain * link_).eval();
      At(k, here);
      next = here;
    }
    const RunState* before = solver_.before();
    if (before != nullptr && before->link.size() > 0 && link_.size() > 0) {
      result_.marked.front().cov_with_previous = before->link * link_;
    }
    result_.report.sums = solver_.sums();
  }

 private:
  void At(std::size_t node, const EdgeMatrix& cov) {
    result_.cov_phi_T[node] = cov.topLeftCorner<3, 3>();
    while (left_ > 0 && marked_[left_ - 1] == node) {
      --left_;
      LinkedErrors& mark = result_.marked[left_];
      mark.node = node;
      mark.cov = cov(columns_, columns_);
      if (link_.size() > 0) {
        result_.marked[left_ + 1].cov_with_previous = link_(columns_, Eigen::all);
      }
      link_ = cov(Eigen::all, columns_);
    }
  }

  void TakeErrors(const EdgeMatrix& cov) {
    const Layout& layout = solver_.layout();
    for (int i = 0; i < kErrorSources; ++i) {
      const int at = layout.source[static_cast<std::size_t>(i)];
      if (at == kAbsent) continue;
      result_.errors[i] = solver_.border()[at];
      result_.sigma_errors[i] = std::sqrt(cov(layout.node + at, layout.node + at));
    }
    const BorderMatrix posterior = cov.bottomRightCorner(layout.border, layout.border);
    result_.cov_errors = OfSources(layout, posterior);
    result_.cov_prior = OfSources(layout, InverseOfSymmetric(layout.information));
  }

  RunSolver& solver_;
  std::vector<int> columns_;
  std::span<const std::size_t> marked_;
  std::size_t left_;
  RunEstimate& result_;
  Eigen::MatrixXd link_;  ///< E[(node; border) x'] of the marked node behind
};

/// sqrt(squares / freedom) of residuals of these kinds, the factor by which their noise is larger
/// than stated; 1 where the squares are chance.
double Excess(const std::array<RowSum, kRowKinds>& sums, std::initializer_list<RowKind> kinds) {
  double weighted = 0, freedom = 0;
  for (const RowKind kind : kinds) {
    const RowSum& sum = sums[static_cast<std::size_t>(kind)];
    weighted += sum.weighted;
    freedom += sum.freedom;
  }
  if (!(freedom > 1) || weighted < freedom + kTooLarge * std::sqrt(2 * freedom)) return 1;
  return std::sqrt(weighted / freedom);
}

/// Solves again with the noise that the residuals show, until they agree with it.
void FitNoise(RunSolver& solver, std::span<const std::size_t> marked, RunEstimate& result) {
  const std::array<RowSum, kRowKinds> stated = result.report.sums;
  for (int i = 0; i < kNoiseRounds && result.solved; ++i) {
    const double gyro = Excess(result.report.sums, {RowKind::kTurn, RowKind::kStill});
    const double accel = Excess(result.report.sums, {RowKind::kForce});
    if (gyro == 1 && accel == 1) break;
    result.gyro_noise *= gyro;
    result.accel_noise *= accel;
    result.solved = solver.SolveWithNoise(gyro, accel);
    if (result.solved) Sweep(solver, marked, result).Run();
  }
  result.report.sums = stated;
}

/// Of a run by a tool without a calibration's covariance: what the temperature does by itself.
void TakeWarmth(std::span<const RunKnot> knots, EstimateSetup& setup) {
  if (setup.cov_errors) return;
  ErrorCovariance none;
  for (const RunKnot& knot : knots) none.reference += static_cast<double>(knot.temperature);
  none.reference /= static_cast<double>(knots.size());
  double largest = 0;
  for (const RunKnot& knot : knots) {
    largest = std::max(largest, std::abs(static_cast<double>(knot.temperature) - none.reference));
  }
  // A thermometer that stands still tells nothing, nor does one that is not there.
  constexpr double kLeast = 1;  // [degC]
  if (!(largest > kLeast)) return;
  none.span = largest;
  setup.cov_errors = none;
}

/// A fault may be of a constant that the run holds at zero (prior sigma 0). For the test it becomes
/// an unknown whose prior is kTestedPrior of the fault's size. The scale of depth becomes one by
/// the job's prior: the accelerometers along the hole observe it.
Diagnosis DiagnosisOf(const RunSolver& solved) {
  EstimateSetup setup = solved.setup();
  setup.sigma_depth_scale = setup.errors.depth_scale_sigma;
  TakeWarmth(solved.knots(), setup);
  for (const CauseSpec& cause : setup.causes) {
    if (cause.kind != CauseSpec::Kind::kConstant && cause.kind != CauseSpec::Kind::kOnset) continue;
    double* sigma = PriorOf(cause.unknown, setup);
    if (sigma != nullptr) *sigma = std::max(*sigma, kTestedPrior * cause.size);
  }
  RunSolver tested(setup, solved.knots());
  tested.TakeOver(solved);
  return Diagnose(tested, setup.causes, EndByPhi(solved.nodes()), setup.false_alarm_rate,
                  EndByDepthScale(solved.nodes()));
}

std::vector<NorthClosure> ClosuresOf(RunSolver& solved) {
  LinearRun run(solved);
  if (!run.Solve()) return {};
  return NorthClosures(run, solved.nodes(), solved.setup().norths);
}

std::vector<NodeGuess> GuessesOf(const EstimateSetup& setup, std::span<const RunKnot> knots,
                                 std::span<const Start> starts) {
  if (starts.empty()) return GuessesOfHeadings(setup, knots);
  const std::vector<std::vector<double>> rolls = HiddenRolls(knots, setup);
  std::vector<NodeGuess> guesses;
  for (const Start& start : starts) {
    for (const std::vector<double>& roll : rolls) {
      guesses.push_back(GuessOf(setup, knots, start, roll));
    }
  }
  return guesses;
}

/// Where a solver stood before it sought the scales of the roll.
struct Approached {
  std::optional<double> swing;  ///< of the setup [rad/s]
  RollBegin begin;
  double evidence = 0;
  NodeGuess nodes;
};

struct Choice {
  std::unique_ptr<RunSolver> solver;  ///< of the solution of greatest evidence; null: none
  SolveReport report;
  std::vector<Solution> rivals;      ///< others that come near it
  double least_evidence = HUGE_VAL;  ///< of all guesses, those that lead to no solution too
  std::vector<Approached> approached;
};

/// What follows from where the solver stands has been tried: as the same model it was there before,
/// to a sigma over all unknowns together. Else it is noted.
bool WasThere(const RunSolver& solver, const RollBegin& begin, Choice& choice) {
  if (!solver.IsNear()) return false;
  Approached now{solver.setup().swing, begin, solver.Evidence(), solver.nodes()};
  const bool there = std::ranges::any_of(choice.approached, [&](const Approached& before) {
    return before.swing == now.swing && before.begin == now.begin &&
           std::abs(before.evidence - now.evidence) < kSameEvidence &&
           SameSolution(before.nodes, now.nodes);
  });
  if (!there) choice.approached.push_back(std::move(now));
  return there;
}

/// Keeps another solution, once, where it comes near the chosen one.
void AddRival(Solution other, Choice& choice) {
  if (!choice.solver) return;
  AddRival(std::move(other), choice.report.evidence, choice.solver->nodes(), choice.rivals);
}

/// A run, and what it is solved as.
struct Problem {
  const EstimateSetup& setup;
  std::span<const RunKnot> knots;
  const RunState* before;
  std::vector<RollBegin> begins;  ///< of a roll rate that walks
  bool may_swing = false;
  bool hides_roll = false;
  std::optional<double> swing;  ///< of the roll where gravity shows it [rad/s]
};

Problem ProblemOf(const EstimateSetup& setup, std::span<const RunKnot> knots,
                  const RunState* before) {
  Problem p{.setup = setup, .knots = knots, .before = before, .begins = RollBeginsOf(knots)};
  p.may_swing = setup.may_swing && !setup.third_axis;
  p.hides_roll = AnyRollIsHidden(knots);
  if (p.may_swing) p.swing = SwingOf(knots);
  return p;
}

EstimateSetup SetupWith(const EstimateSetup& setup, std::optional<double> swing) {
  EstimateSetup with = setup;
  with.swing = swing;
  return with;
}

/// Solves from one guess, with a swing of this frequency or none, unless it leads where one before
/// it did; keeps the solution where it betters those before. Returns where it ended.
NodeGuess SolveFrom(const NodeGuess& guess, const Problem& p, std::optional<double> swing,
                    const RollBegin& begin, Solution& solution, Choice& choice) {
  auto solver = std::make_unique<RunSolver>(SetupWith(p.setup, swing), p.knots, p.before);
  solver->nodes() = guess;
  const double best = choice.solver ? choice.report.evidence : HUGE_VAL;
  solver->Approach(kSolveIterations, begin);
  if (WasThere(*solver, begin, choice)) return solver->nodes();
  const SolveReport report = solver->Settle(best + kDecides);
  NodeGuess nodes = solver->nodes();
  choice.least_evidence = std::min(choice.least_evidence, report.evidence);
  if (!report.converged || !(report.evidence < solution.evidence)) return nodes;
  solution = {report.evidence, nodes, solver->border(), swing, begin};
  if (choice.solver && !(report.evidence < choice.report.evidence)) return nodes;
  choice.report = report;
  choice.solver = std::move(solver);
  return nodes;
}

/// Solves from where a walk led, as that and the swing that it shows, where only it shows one.
void SolveAsHiddenSwing(const NodeGuess& walk, const Problem& p, Solution& solution,
                        Choice& choice) {
  if (p.swing || !p.may_swing || !p.hides_roll) return;
  const std::optional<double> swing = SwingOf(p.knots, walk);
  if (swing) SolveFrom(walk, p, swing, {}, solution, choice);
}

/// Solves from one guess with the roll rate as the setup has it, a random walk, and, where it
/// swings, as that and a swing, whose frequency gravity shows or else, where the roll is hidden,
/// the walk's solution.
void SolveFrom(const NodeGuess& guess, const Problem& p, Solution& solution, Choice& choice) {
  if (p.swing) SolveFrom(guess, p, p.swing, {}, solution, choice);
  NodeGuess walk;
  for (const RollBegin& begin : p.begins) {
    const double evidence = solution.evidence;
    NodeGuess nodes = SolveFrom(guess, p, p.setup.swing, begin, solution, choice);
    if (walk.empty() || solution.evidence < evidence) walk = std::move(nodes);
  }
  SolveAsHiddenSwing(walk, p, solution, choice);
}

/// Solves again from nearby a solution, as the model that fits best there, as long as that is
/// better, where it may be a local minimum.
void SolveAbout(const Problem& p, Solution& solution, Choice& choice) {
  for (int i = 0; i < kAboutMost && p.hides_roll && !solution.nodes.empty(); ++i) {
    const double evidence = solution.evidence;
    const std::optional<double> swing = solution.swing;
    const RollBegin begin = solution.begin;
    const NodeGuess about =
        RollAbout(SetupWith(p.setup, swing), p.knots, p.before, solution.nodes, solution.border);
    const NodeGuess nodes = SolveFrom(about, p, swing, begin, solution, choice);
    SolveAsHiddenSwing(nodes, p, solution, choice);
    if (!(solution.evidence < evidence - kDecides)) return;
  }
}

Choice Choose(const EstimateSetup& setup, std::span<const RunKnot> knots,
              std::span<const NodeGuess> guesses, const RunState* before) {
  const Problem problem = ProblemOf(setup, knots, before);
  std::vector<Solution> solutions(guesses.size());
  Choice choice;
  for (std::size_t i = 0; i < guesses.size(); ++i) {
    SolveFrom(guesses[i], problem, solutions[i], choice);
    SolveAbout(problem, solutions[i], choice);
  }
  for (Solution& s : solutions) AddRival(std::move(s), choice);
  return choice;
}

/// What the errors of node k would be if the rival were right, in [node; border].
EdgeVector Towards(const Solution& rival, const RunSolver& best, std::size_t k) {
  const Layout& layout = best.layout();
  const Node &a = best.nodes()[k], &b = rival.nodes[k];
  EdgeVector d = EdgeVector::Zero(layout.node + layout.border);
  d.head<3>() = Log(a.R_LT.transpose() * b.R_LT);
  const auto of_gyros = [&](int column, const Vector3d& by) {
    if (column != kAbsent) d.segment(column, layout.gyros) = by.head(layout.gyros);
  };
  of_gyros(layout.walk, b.walk_T - a.walk_T);
  of_gyros(layout.markov, b.markov_T - a.markov_T);
  d.tail(layout.border) = rival.border - best.border();
  return d;
}

/// Second moment of the mixture of two solutions about `best`: cov += w d d', d the rival's
/// difference and w = odds / (1 + odds) its weight by evidence. Near east-west the rival is the
/// mirror azimuth, and sigma covers both. False beyond kVagueAngle, where no one covariance does.
bool CountIn(const Solution& rival, double evidence, const RunSolver& best, RunEstimate& result) {
  const std::vector<int> columns = LinkedColumns(best.layout());
  const double odds = std::exp(0.5 * (evidence - rival.evidence)), weight = odds / (1 + odds);
  if (rival.border.size() != best.border().size()) return false;
  for (std::size_t k = 0; k < result.cov_phi_T.size(); ++k) {
    const Vector3d d = Towards(rival, best, k).head<3>();
    if (d.norm() > kVagueAngle) return false;
    result.cov_phi_T[k] += weight * d * d.transpose();
  }
  // Solutions of a run's later part begin at one state, and so differ by nothing at a node marked
  // before it.
  Eigen::VectorXd before = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(columns.size()));
  for (LinkedErrors& mark : result.marked) {
    const Eigen::VectorXd d = Towards(rival, best, mark.node)(columns);
    mark.cov += weight * d * d.transpose();
    if (mark.cov_with_previous.size() > 0) {
      mark.cov_with_previous += weight * before * d.transpose();
    }
    before = d;
  }
  return true;
}

/// 1-sigma of the turn about the vertical, of the node where it is known best.
double SigmaOfHeading(std::span<const Node> nodes, std::span<const Matrix3d> cov_phi_T) {
  double least = HUGE_VAL;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    least = std::min(least, HeadingVariance(nodes[k].R_LT, cov_phi_T[k]));
  }
  return std::sqrt(least);
}

void Take(const Choice& choice, std::span<const std::size_t> marked, RunEstimate& result) {
  if (!choice.solver) return;
  result.solved = true;
  result.report = choice.report;
  Sweep(*choice.solver, marked, result).Run();
}

RunState EndOf(const RunSolver& solved, std::span<const std::size_t> marked) {
  const Elimination& e = solved.elimination();
  const Layout& layout = solved.layout();
  const std::span<const RunKnot> knots = solved.knots();
  const std::vector<Node>& nodes = solved.nodes();
  const RunState* before = solved.before();
  RunState end;
  end.setup = solved.setup();
  end.setup.causes.clear();
  end.setup.norths.clear();
  end.border = solved.border();
  end.information = e.edge_information().selfadjointView<Eigen::Lower>();
  for (std::size_t i = 0; i < RunState::kTail; ++i) {
    const std::size_t back = std::min(i, knots.size());
    end.nodes[RunState::kTail - 1 - i] = nodes[knots.size() - back];
  }
  if (before != nullptr) {
    end.p_W = before->p_W;
    end.seconds = before->seconds;
  }
  end.way = before != nullptr ? before->way : WayFrom(layout, nodes.front());
  for (std::size_t k = 0; k < knots.size(); ++k) {
    const Node &a = nodes[k], &b = nodes[k + 1];
    CarryWay(layout, a, b, e.Gain(k), e.Remainder(k), end.way);
    end.p_W += 0.5 * (b.md - a.md) * (a.tangent_L() + b.tangent_L());
    end.seconds += knots[k].increment.seconds;
  }
  if (!marked.empty()) {
    end.link = LinkedRows(layout);
  } else if (before != nullptr) {
    end.link = before->link;
  }
  if (end.link.size() == 0) return end;
  for (std::size_t k = marked.empty() ? 0 : marked.back(); k < knots.size(); ++k) {
    CarryLink(layout, e.Gain(k), end.link);
  }
  return end;
}

/// Residuals of the gyros that are no chance: their noise is stated too small, or this is a local
/// minimum.
bool GyrosMisfit(const RunEstimate& run) {
  return !run.solved || Excess(run.report.sums, {RowKind::kTurn, RowKind::kStill}) > 1;
}

/// Takes the solution of other guesses where its evidence is better; the worse of the two may
/// remain a rival. False: it is not better.
bool TakeIfBetter(Choice other, std::span<const std::size_t> marked, Choice& choice,
                  RunEstimate& result) {
  if (!other.solver) return false;
  const bool better = !choice.solver || other.report.evidence < choice.report.evidence;
  if (better) std::swap(choice, other);
  for (Solution& rival : other.rivals) AddRival(std::move(rival), choice);
  if (other.solver) {
    AddRival({other.report.evidence, other.solver->nodes(), other.solver->border(),
              other.solver->setup().swing},
             choice);
  }
  if (better) Take(choice, marked, result);
  return better;
}

}  // namespace

RunEstimate EstimateRun(const EstimateSetup& setup, std::span<const RunKnot> knots,
                        const Starts& starts, std::span<const std::size_t> marked,
                        const RunState* before) {
  RunEstimate result;
  if (knots.empty()) return result;
  Choice choice = Choose(setup, knots, GuessesOf(setup, knots, starts.anchored), before);
  Take(choice, marked, result);
  if (starts.otherwise && GyrosMisfit(result)) {
    const std::array otherwise{starts.otherwise()};
    Choice other = Choose(setup, knots, otherwise, before);
    const double least = other.least_evidence;
    if (!TakeIfBetter(std::move(other), marked, choice, result) &&
        least < result.report.evidence - kDecides) {
      return {};  // something fits better that is no solution: nothing is known
    }
  }
  if (!result.solved) return result;
  RunSolver& best = *choice.solver;
  // Before the noise is taken larger: a fault is what makes the residuals too large.
  if (!setup.causes.empty()) result.diagnosis = DiagnosisOf(best);
  if (!setup.norths.empty()) result.closures = ClosuresOf(best);
  FitNoise(best, marked, result);
  result.alone = choice.rivals.empty();
  for (const Solution& rival : choice.rivals) {
    result.ambiguous |= !CountIn(rival, choice.report.evidence, best, result);
  }
  result.ambiguous |= SigmaOfHeading(best.nodes(), result.cov_phi_T) > kVagueAngle;
  result.nodes = best.nodes();
  result.end = EndOf(best, marked);
  return result;
}

}  // namespace wellgyro

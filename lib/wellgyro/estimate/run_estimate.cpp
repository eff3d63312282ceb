#include "wellgyro/estimate/run_estimate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <utility>

#include "wellgyro/estimate/backward_pass.h"
#include "wellgyro/estimate/choice.h"
#include "wellgyro/estimate/end_of_run.h"
#include "wellgyro/estimate/hidden_roll.h"
#include "wellgyro/estimate/rivals.h"
#include "wellgyro/record/decides.h"
#include "wellgyro/record/unknown_angle.h"

namespace wellgyro {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// A sum of squares this many sigmas above its freedom is not chance, P(x > 4) = 3.2e-5: one run in
// 30 000.
constexpr double kTooLarge = 4;
// Each takes the noise to what the residuals about the last solution say; the third moves it by
// less than a per cent.
constexpr int kNoiseRounds = 3;

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
    if (result.solved) PassBack(solver, marked, result);
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
  PassBack(*choice.solver, marked, result);
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
    if (Join(std::move(other), choice)) {
      Take(choice, marked, result);
    } else if (least < result.report.evidence - kDecides) {
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

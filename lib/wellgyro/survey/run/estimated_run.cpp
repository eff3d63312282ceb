#include "wellgyro/survey/run/estimated_run.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <initializer_list>
#include <span>
#include <vector>

#include "wellgyro/base/angle.h"
#include "wellgyro/estimate/hidden_roll.h"
#include "wellgyro/estimate/run_estimate.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/survey/hole/hole_axis.h"
#include "wellgyro/survey/hole/node_attitude.h"
#include "wellgyro/survey/run/calibration_prior.h"
#include "wellgyro/survey/run/run_stretches.h"
#include "wellgyro/survey/verdict/run_diagnosis.h"

namespace wellgyro {
namespace {

constexpr const char* kEstimator = "least squares of rotations";

Anchor AnchorOf(const FixAtNode& at, double azimuth) {
  return {at.node, AttitudeMatrix(azimuth, at.fix.inclination, at.fix.toolface)};
}

/// Two azimuths to start from, a sigma or more to either side of the middle between an azimuth and
/// its mirror, where these are within six sigmas of each other, as near east-west; else none.
std::vector<double> SidesOf(const NorthFix& fix) {
  const double sigma = std::sqrt(fix.cov_attitude(1, 1));
  const double to_middle = WrapPi(kPi - 2 * fix.azimuth) / 2;
  if (std::abs(2 * to_middle) > 6 * sigma) return {};
  const double half = std::max(std::abs(to_middle), sigma);
  return {fix.azimuth + to_middle - half, fix.azimuth + to_middle + half};
}

/// Starts through a tie or, without one, through all fixes that have no mirror; where there is none
/// of these, one through the surest fix and one through its mirror. A surest fix without a mirror
/// that is near east-west gives the two of SidesOf().
std::vector<Start> StartsOf(const EstimateSetup& setup, const RunHistory& history) {
  Start sure;
  const FixAtNode *surest = nullptr, *surest_alone = nullptr;  // of all; of those without a mirror
  const auto surer = [](const FixAtNode& at, const FixAtNode* than) {
    return than == nullptr || at.fix.cov_attitude(1, 1) < than->fix.cov_attitude(1, 1);
  };
  for (const FixAtNode& at : history.fixes) {
    if (surer(at, surest)) surest = &at;
    if (at.fix.mirror_azimuth) continue;
    if (surer(at, surest_alone)) surest_alone = &at;
    sure.push_back(AnchorOf(at, at.fix.azimuth));
  }
  const auto from = [&](const Anchor& first) {
    Start start{first};
    for (const Anchor& anchor : sure) {
      if (anchor.node > first.node) start.push_back(anchor);
    }
    return start;
  };
  if (!setup.ties.empty()) return {from(AnchorOf(setup, history.knots, setup.ties.front()))};
  if (!sure.empty()) {
    std::vector<Start> starts{sure};
    const auto sides = SidesOf(surest_alone->fix);
    if (!sides.empty()) starts.clear();
    for (const double azimuth : sides) starts.push_back(from(AnchorOf(*surest_alone, azimuth)));
    return starts;
  }
  if (surest == nullptr) return {};
  return {from(AnchorOf(*surest, surest->fix.azimuth)),
          from(AnchorOf(*surest, *surest->fix.mirror_azimuth))};
}

/// Start at what is known at the begin of a part; it passes the fixes in it that have no mirror.
Start StartOf(const RunState& known, const RunHistory& part) {
  Start start{{0, known.node().R_LT}};
  for (const FixAtNode& at : part.fixes) {
    if (!at.fix.mirror_azimuth) start.push_back(AnchorOf(at, at.fix.azimuth));
  }
  return start;
}

/// The forward estimate's attitude at every node.
NodeGuess GuessOf(const EstimateSetup& setup, const RunHistory& history) {
  std::vector<Eigen::Matrix3d> R_LT;
  for (const AttitudeSample& a : history.attitude) {
    R_LT.push_back(AttitudeMatrix(a.azimuth, a.inclination, a.toolface));
  }
  R_LT.insert(R_LT.begin(), R_LT.front());
  return GuessOf(setup, history.knots, R_LT);
}

RunFit FitOf(const RunEstimate& estimate) {
  RunFit fit;
  fit.adjuster = kEstimator;
  fit.converged = estimate.report.converged;
  fit.ambiguous = estimate.ambiguous;
  double freedom = 0;
  const auto squares = [&](std::initializer_list<RowKind> kinds) {
    RunFit::Squares part;
    for (const RowKind kind : kinds) {
      const RowSum& sum = estimate.report.sums[static_cast<std::size_t>(kind)];
      part.sum += sum.weighted;
      part.freedom += sum.freedom;
    }
    fit.chi_square += part.sum;
    freedom += part.freedom;
    return part;
  };
  fit.parts[RunFit::kInclination] = squares({RowKind::kTurn, RowKind::kAxial});
  fit.parts[RunFit::kForce] = squares({RowKind::kForce});
  fit.parts[RunFit::kRest] = squares({RowKind::kStill});
  fit.parts[RunFit::kAzimuth] = squares({RowKind::kAzimuth});
  // Residuals of depth do not count: marks come of a smooth track, their errors are correlated over
  // many knots, and their squares are a two-hundredth of their number.
  squares({RowKind::kDrift});
  fit.degrees_of_freedom = static_cast<int>(std::lround(freedom));
  fit.errors = estimate.errors;
  fit.sigma_errors = estimate.sigma_errors;
  return fit;
}

/// RunFit::hidden_turn [rad]: |roll over a knot, as solved, less the roll it was summed with| that
/// twenty moving knots exceed, where neither gravity nor a third axis shows the roll. Such a knot
/// is summed as if the tool did not roll, and a truncated series corrects it. The twenty largest
/// are left out for single knots, as where the roll starts.
double HiddenTurn(std::span<const RunKnot> knots, std::span<const Node> nodes) {
  constexpr std::size_t kKnots = 20;
  std::vector<double> turns;
  for (std::size_t k = 0; k < knots.size(); ++k) {
    if (!RollIsHidden(knots[k])) continue;
    const Increment& i = knots[k].increment;
    turns.push_back(std::abs(nodes[k].roll_rate * i.seconds - i.roll_before - i.roll_after));
  }
  if (turns.size() <= kKnots) return 0;
  std::ranges::nth_element(turns, turns.begin() + kKnots, std::greater());
  return turns[kKnots];
}

/// The stations as nodes.
std::vector<std::size_t> NodesOf(const RunHistory& history) {
  std::vector<std::size_t> nodes;
  for (const std::size_t knot : history.stations) nodes.push_back(knot + 1);
  return nodes;
}

/// The norths of a run, as SmoothedRun::closures.
std::vector<NorthAt> NorthsOf(const RunHistory& history) {
  std::vector<NorthAt> norths;
  for (const FixAtNode& at : history.fixes) {
    std::size_t begin = at.node;
    while (begin > 0 && history.knots[begin - 1].increment.time > at.fix.begin) --begin;
    norths.push_back({begin, at.node});
  }
  for (const AzimuthTie& tie : history.ties) {
    norths.push_back({std::max<std::size_t>(tie.node, 1) - 1, tie.node, true});
  }
  return norths;
}

/// Of the tie with which the run begins, if any.
void TakeClosureOutside(const RunHistory& history, std::span<const NorthClosure> closures,
                        RunFit& fit) {
  if (closures.size() != history.fixes.size() + history.ties.size()) return;
  if (history.ties.empty() || history.ties.front().node != 0) return;
  const NorthClosure& closure = closures[history.fixes.size()];
  fit.closure_outside = closure.angle;
  fit.sigma_closure_outside = closure.sigma;
}

EstimateSetup SetupOf(const Job& job, const RunHistory& history) {
  EstimateSetup setup;
  setup.gyro = job.noise;
  setup.errors = job.errors;
  setup.site = history.site;
  setup.third_axis = std::any_of(history.knots.begin(), history.knots.end(),
                                 [](const RunKnot& k) { return k.increment.has_axial; });
  setup.ties = history.ties;
  TakeCalibration(job, history, setup);
  return setup;
}

RunEstimate EstimateFrom(const EstimateSetup& setup, const RunHistory& history,
                         const Starts& starts) {
  if (history.knots.empty()) return {};
  return EstimateRun(setup, history.knots, starts, NodesOf(history));
}

/// By which the gyros x and y see the roll: what was found beside what is known.
Eigen::Vector2d SkewOf(const RunEstimate& estimate) {
  const ErrorPriors& known = estimate.end.setup.errors;
  return {known.gyro_misalignment_x + estimate.errors[kMisalignmentX],
          known.gyro_misalignment_y + estimate.errors[kMisalignmentY]};
}

}  // namespace

SmoothedRun SmoothedOf(const RunEstimate& estimate, const RunHistory& history) {
  SmoothedRun run;
  const std::vector<Eigen::Matrix3d> R_LT =
      OnHoleAxis(history.knots, estimate.nodes, SkewOf(estimate));
  for (std::size_t k = 0; k < history.knots.size(); ++k) {
    run.attitude.push_back(AttitudeOf(history.knots[k], R_LT[k], estimate.cov_phi_T[k + 1]));
    if (estimate.ambiguous) ForgetAzimuth(run.attitude.back());
  }
  for (std::size_t j = 0; j < history.stations.size(); ++j) {
    const std::size_t k = history.stations[j];
    run.stations.push_back(
        StateOf(k, history.knots[k], run.attitude[k], R_LT[k], estimate.marked[j]));
  }
  return run;
}

RunEstimate EstimateSoFar(const Job& job, const RunHistory& history) {
  EstimateSetup setup = SetupOf(job, history);
  setup.may_swing = false;
  const std::vector<Start> starts = StartsOf(setup, history);
  if (starts.empty()) return {};
  return EstimateFrom(setup, history, {starts, nullptr});
}

RunEstimate EstimateSince(const RunState& known, const RunHistory& part) {
  EstimateSetup setup = known.setup;
  setup.ties = part.ties;
  return EstimateRun(setup, part.knots, {{StartOf(known, part)}, nullptr}, NodesOf(part), &known);
}

SmoothedRun EstimatedRun(const Job& job, const RunHistory& history) {
  EstimateSetup setup = SetupOf(job, history);
  setup.norths = NorthsOf(history);
  setup.causes = CausesLookedFor(setup.site);
  setup.false_alarm_rate = kDiagnosisFalseAlarms;
  std::vector<Start> starts;
  if (!history.knots.empty()) starts = StartsOf(setup, history);
  const RunEstimate estimate =
      EstimateFrom(setup, history, {starts, [&] { return GuessOf(setup, history); }});
  if (!estimate.solved) {
    SmoothedRun before{history.attitude, history.states, RunFit{}};
    before.fit->adjuster = kEstimator;
    before.fit->stretches = StretchesOf({}, history.knots);
    return before;
  }
  SmoothedRun run = SmoothedOf(estimate, history);
  run.closures = estimate.closures;
  run.fit = FitOf(estimate);
  TakeClosureOutside(history, run.closures, *run.fit);
  run.fit->hidden_turn = HiddenTurn(history.knots, estimate.nodes);
  if (setup.cov_errors) {
    run.fit->lesson = {estimate.errors, estimate.cov_prior, estimate.cov_errors, UsesOf(history)};
  }
  run.fit->stretches = StretchesOf(estimate.diagnosis, history.knots);
  run.fit->diagnosis = DiagnosisOf(estimate.diagnosis, history.knots);
  return run;
}

}  // namespace wellgyro

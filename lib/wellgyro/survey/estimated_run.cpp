#include "wellgyro/survey/estimated_run.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <span>
#include <vector>

#include "wellgyro/base/angle.h"
#include "wellgyro/estimate/run_estimate.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/survey/calibration_prior.h"
#include "wellgyro/survey/node_attitude.h"
#include "wellgyro/survey/run_diagnosis.h"
#include "wellgyro/survey/run_stretches.h"

namespace wellgyro {
namespace {

// Attitude, two kinds of drift, the border.
static_assert(3 + 4 + kBorderMax <= kStationErrorsMax);

Anchor AnchorOf(const FixAtNode& at, double azimuth) {
  return {at.node, AttitudeMatrix(azimuth, at.fix.inclination, at.fix.toolface)};
}

/// Near east-west an azimuth and its mirror run into one, which a stop tells to its sigma: an
/// azimuth on either side, where the mirror is within six of them; else none.
std::vector<double> SidesOf(const NorthFix& fix) {
  const double sigma = std::sqrt(fix.cov_attitude(1, 1));
  const double to_middle = WrapPi(kPi - 2 * fix.azimuth) / 2;
  if (std::abs(2 * to_middle) > 6 * sigma) return {};
  const double half = std::max(std::abs(to_middle), sigma);
  return {fix.azimuth + to_middle - half, fix.azimuth + to_middle + half};
}

/// From a tie, else from the surest fix and from its mirror; on the way past the fixes that have
/// none.
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

/// From what is known at the begin of a part, past the fixes in it that have no mirror.
Start StartOf(std::size_t begin, const RunState& known, const RunHistory& history) {
  Start start{{0, known.node().R_LT}};
  for (const FixAtNode& at : history.fixes) {
    if (at.node <= begin || at.fix.mirror_azimuth) continue;
    start.push_back(AnchorOf(at, at.fix.azimuth));
    start.back().node -= begin;
  }
  return start;
}

/// Every node as it was known on the way.
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
  // Depth is read off a smooth track: its errors go together over many knots, and their squares are
  // a two-hundredth of their number.
  squares({RowKind::kDrift});
  fit.degrees_of_freedom = static_cast<int>(std::lround(freedom));
  fit.errors = estimate.errors;
  fit.sigma_errors = estimate.sigma_errors;
  return fit;
}

/// Of the stations from knot `begin` on, the first of them by its number.
std::size_t FirstStation(const RunHistory& history, std::size_t begin) {
  const auto& stations = history.stations;
  const auto first = std::lower_bound(stations.begin(), stations.end(), begin);
  return static_cast<std::size_t>(first - stations.begin());
}

/// The same as nodes of the part that begins there.
std::vector<std::size_t> NodesOf(const RunHistory& history, std::size_t begin) {
  std::vector<std::size_t> nodes;
  for (std::size_t j = FirstStation(history, begin); j < history.stations.size(); ++j) {
    nodes.push_back(history.stations[j] + 1 - begin);
  }
  return nodes;
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
  return EstimateRun(setup, history.knots, starts, NodesOf(history, 0));
}

}  // namespace

SmoothedRun SmoothedOf(const RunEstimate& estimate, const RunHistory& history, std::size_t begin) {
  SmoothedRun run;
  for (std::size_t k = begin; k < history.knots.size(); ++k) {
    const std::size_t node = k + 1 - begin;
    run.attitude.push_back(
        AttitudeOf(history.knots[k], estimate.nodes[node], estimate.cov_phi[node]));
    if (estimate.ambiguous) ForgetAzimuth(run.attitude.back());
  }
  const std::size_t first = FirstStation(history, begin);
  for (std::size_t j = first; j < history.stations.size(); ++j) {
    const std::size_t k = history.stations[j];
    run.stations.push_back(StateOf(k, history.knots[k], run.attitude[k - begin],
                                   estimate.nodes[k + 1 - begin].R_LT, estimate.marked[j - first]));
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

RunEstimate EstimateSince(std::size_t begin, const RunState& known, const RunHistory& history) {
  EstimateSetup setup = known.setup;
  setup.ties.clear();
  for (AzimuthTie tie : history.ties) {
    if (tie.node <= begin) continue;
    tie.node -= begin;
    setup.ties.push_back(tie);
  }
  const auto part = std::span(history.knots).subspan(begin);
  return EstimateRun(setup, part, {{StartOf(begin, known, history)}, nullptr},
                     NodesOf(history, begin), &known);
}

SmoothedRun EstimatedRun(const Job& job, const RunHistory& history) {
  EstimateSetup setup = SetupOf(job, history);
  setup.causes = CausesLookedFor();
  setup.false_alarm_rate = kDiagnosisFalseAlarms;
  std::vector<Start> starts;
  if (!history.knots.empty()) starts = StartsOf(setup, history);
  const RunEstimate estimate =
      EstimateFrom(setup, history, {starts, [&] { return GuessOf(setup, history); }});
  if (!estimate.solved) {
    SmoothedRun before{history.attitude, history.states, RunFit{}};
    before.fit->stretches = StretchesOf({}, history.knots);
    return before;
  }
  SmoothedRun run = SmoothedOf(estimate, history);
  run.fit = FitOf(estimate);
  if (setup.cov_errors) {
    run.fit->lesson = {estimate.errors, estimate.cov_prior, estimate.cov_errors, UsesOf(history)};
  }
  run.fit->stretches = StretchesOf(estimate.diagnosis, history.knots);
  run.fit->diagnosis = DiagnosisOf(estimate.diagnosis, history.knots);
  return run;
}

}  // namespace wellgyro

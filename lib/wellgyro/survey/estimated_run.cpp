#include "wellgyro/survey/estimated_run.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <vector>

#include "wellgyro/attitude/unseen.h"
#include "wellgyro/base/angle.h"
#include "wellgyro/estimate/run_estimate.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/record/unknown_angle.h"
#include "wellgyro/survey/run_diagnosis.h"

namespace wellgyro {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Cuts of one place by the tracker and by the increments, each rounded to a nanosecond.
constexpr std::int64_t kSameNs = 2;
// An inclination at which an azimuth's sigma is that of no knowledge for any attitude's.
constexpr double kLeastSine = 1e-9;
// From here on the angle is not what its first order says: sine and angle part by 2 %.
constexpr double kVaguest = 20 * kPi / 180;  // [rad]

/// How far the axis turned in this knot where nothing was seen of it, 1-sigma: what the hole may
/// bend, or, of gyros at full scale, as much again as they read.
double UnseenIn(const RunKnot& knot) {
  const UnseenHole hole;
  const Increment& inc = knot.increment;
  const double rate = knot.along.known ? hole.dogleg * std::abs(knot.along.speed) : hole.rate;
  return inc.gap_seconds * std::max(rate, inc.turn_M.norm() / inc.seconds);
}

/// Knots joined with the epochs that end where they do, and which node each epoch is.
struct JoinedKnots {
  std::vector<RunKnot> knots;
  std::vector<std::size_t> node;  ///< of the epochs, as many as the increments reach
};

JoinedKnots Join(const Job& job, const FilterHistory& history,
                 std::span<const Increment> increments) {
  const bool rests =
      job.alignment.method == AlignmentSpec::Method::kGyrocompass || job.alignment.use_fixes;
  JoinedKnots joined;
  UnseenTurn unseen;
  std::size_t epoch = 0;
  const auto& epochs = history.epochs;
  for (const Increment& increment : increments) {
    RunKnot knot{.increment = increment};
    while (epoch < epochs.size() && epochs[epoch].knot.time.ns < increment.time.ns - kSameNs) {
      joined.node.push_back(joined.knots.size());
      ++epoch;
    }
    if (epoch < epochs.size() && epochs[epoch].knot.time.ns <= increment.time.ns + kSameNs) {
      const Knot& at = epochs[epoch].knot;
      knot.utc = at.utc;
      knot.along = at.along;
      knot.still = at.still && rests;
      joined.node.push_back(joined.knots.size() + 1);
      ++epoch;
    }
    knot.unseen = UnseenIn(knot);
    knot.var_unseen = unseen.VarOf(knot.unseen);
    unseen.Add(knot.unseen);
    unseen.Pass(increment.seconds - increment.gap_seconds, UnseenHole().seconds);
    joined.knots.push_back(knot);
  }
  return joined;
}

EstimateSetup SetupOf(const Job& job, const FilterHistory& history, const JoinedKnots& joined) {
  EstimateSetup setup;
  setup.gyro = job.noise;
  setup.errors = job.errors;
  setup.site = history.setup.site;
  setup.third_axis = std::any_of(joined.knots.begin(), joined.knots.end(),
                                 [](const RunKnot& k) { return k.increment.has_axial; });
  const bool of_mark = job.alignment.of == AlignmentSpec::Of::kMark;
  const auto tie = [&](std::size_t node, double azimuth, double sigma, bool of_job) {
    const bool mark = of_job && of_mark;
    setup.ties.push_back({node, mark ? job.alignment.azimuth : azimuth, sigma, mark});
  };
  if (history.setup.start_azimuth) {
    tie(0, *history.setup.start_azimuth, history.setup.start_sigma, true);
  }
  for (const FilterFix& fix : history.fixes) {
    if (!fix.fix.external) continue;
    const std::size_t epoch = fix.epoch_end == 0 ? 0 : fix.epoch_end - 1;
    if (epoch >= joined.node.size()) continue;
    tie(fix.epoch_end == 0 ? 0 : joined.node[epoch], fix.fix.azimuth,
        std::sqrt(fix.fix.cov_attitude(1, 1)), !fix.fix.magnetic_azimuth);
  }
  return setup;
}

Anchor AnchorOf(const JoinedKnots& joined, const FilterFix& fix, double azimuth) {
  return {joined.node[fix.epoch_end - 1],
          AttitudeMatrix(azimuth, fix.fix.inclination, fix.fix.toolface)};
}

Anchor AnchorOf(const AzimuthTie& tie, const FilterHistory& history, const JoinedKnots& joined) {
  if (tie.of_mark) return {tie.node, RotationZ(tie.azimuth)};
  const Knot& first = history.epochs[0].knot;
  double inclination = first.inclination, toolface = first.toolface - first.roll;
  for (std::size_t i = 0; i < joined.node.size(); ++i) {
    if (joined.node[i] != tie.node) continue;
    inclination = history.epochs[i].knot.inclination;
    toolface = history.epochs[i].knot.toolface;
  }
  return {tie.node, AttitudeMatrix(tie.azimuth, inclination, toolface)};
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
std::vector<Start> StartsOf(const EstimateSetup& setup, const FilterHistory& history,
                            const JoinedKnots& joined) {
  Start sure;
  const FilterFix *surest = nullptr, *surest_alone = nullptr;  // of all; of those without a mirror
  const auto surer = [](const FilterFix& fix, const FilterFix* than) {
    return than == nullptr || fix.fix.cov_attitude(1, 1) < than->fix.cov_attitude(1, 1);
  };
  for (const FilterFix& fix : history.fixes) {
    if (fix.epoch_end == 0 || fix.epoch_end > joined.node.size() || fix.fix.external) continue;
    if (surer(fix, surest)) surest = &fix;
    if (fix.fix.mirror_azimuth) continue;
    if (surer(fix, surest_alone)) surest_alone = &fix;
    sure.push_back(AnchorOf(joined, fix, fix.fix.azimuth));
  }
  const auto from = [&](const Anchor& first) {
    Start start{first};
    for (const Anchor& anchor : sure) {
      if (anchor.node > first.node) start.push_back(anchor);
    }
    return start;
  };
  if (!setup.ties.empty()) return {from(AnchorOf(setup.ties.front(), history, joined))};
  if (!sure.empty()) {
    std::vector<Start> starts{sure};
    const auto sides = SidesOf(surest_alone->fix);
    if (!sides.empty()) starts.clear();
    for (const double azimuth : sides) {
      starts.push_back(from(AnchorOf(joined, *surest_alone, azimuth)));
    }
    return starts;
  }
  if (surest == nullptr) return {};
  return {from(AnchorOf(joined, *surest, surest->fix.azimuth)),
          from(AnchorOf(joined, *surest, *surest->fix.mirror_azimuth))};
}

/// d(inclination, azimuth, toolface) / d phi, by R_LT Exp(phi).
Matrix3d AnglesByPhi(double inclination, double toolface) {
  const double s = std::max(std::sin(inclination), kLeastSine), c = std::cos(inclination);
  const double st = std::sin(toolface), ct = std::cos(toolface);
  Matrix3d slope;
  slope.row(0) << st, ct, 0;
  slope.row(1) << -ct / s, st / s, 0;
  slope.row(2) = Eigen::RowVector3d::UnitZ() - c * slope.row(1);
  return slope;
}

/// As the smoother has it, each node's attitude that of the epoch at it or before it.
NodeGuess GuessOf(const EstimateSetup& setup, const SmoothedRun& smoothed,
                  const JoinedKnots& joined) {
  std::vector<Matrix3d> R_LT(joined.knots.size() + 1);
  std::size_t epoch = 0;
  for (std::size_t k = 0; k < R_LT.size(); ++k) {
    while (epoch + 1 < joined.node.size() && joined.node[epoch + 1] <= k) ++epoch;
    const AttitudeSample& a = smoothed.attitude[epoch];
    R_LT[k] = AttitudeMatrix(a.azimuth, a.inclination, a.toolface);
  }
  return GuessOf(setup, joined.knots, R_LT);
}

void ForgetAngle(int i, AttitudeSample& a) {
  a.cov_attitude.row(i).setZero();
  a.cov_attitude.col(i).setZero();
  a.cov_attitude(i, i) = kUnknownAngleVariance;
}

/// Of a run whose heading is not known: its axis has a direction only where the hole hardly leans.
void ForgetAzimuth(AttitudeSample& a) {
  a.azimuth_known = false;
  const double leans = kVaguest * std::sin(a.inclination);
  if (a.cov_attitude(0, 0) < leans * leans) a.quality = Without(a.quality, Quality::kVertical);
  ForgetAngle(1, a);
}

AttitudeSample SampleOf(const Knot& knot, const Node& node, const Matrix3d& cov_phi) {
  AttitudeSample a;
  const Matrix3d& R = node.R_LT;
  a.time = knot.time;
  a.inclination = std::atan2(std::hypot(R(0, 2), R(1, 2)), R(2, 2));
  a.azimuth = WrapTwoPi(std::atan2(R(1, 2), R(0, 2)));
  a.toolface = std::atan2(R(2, 1), -R(2, 0));
  a.azimuth_known = true;
  a.quality = Without(knot.quality, Quality::kVertical);
  const Matrix3d slope = AnglesByPhi(a.inclination, a.toolface);
  a.cov_attitude = slope * cov_phi * slope.transpose();
  if (a.cov_attitude(1, 1) > kVaguest * kVaguest) a.quality |= Quality::kVertical;
  for (const int i : {1, 2}) {
    if (!(a.cov_attitude(i, i) < kUnknownAngleVariance)) ForgetAngle(i, a);
  }
  return a;
}

void TakeStation(const LinkedErrors& errors, StationState& state) {
  const Eigen::Index n = errors.cov.rows();
  state.cov = errors.cov;
  state.cov_with_previous = errors.cov_with_previous;
  state.angles.setZero(2, n);
  state.angles.leftCols<3>() =
      AnglesByPhi(state.attitude.inclination, state.attitude.toolface).topRows<2>();
  state.cov_white.setZero();
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
  fit.parts[RunFit::kRest] = squares({RowKind::kStill, RowKind::kRest});
  fit.parts[RunFit::kAzimuth] = squares({RowKind::kAzimuth});
  squares({RowKind::kDepth, RowKind::kDrift});
  fit.degrees_of_freedom = static_cast<int>(std::lround(freedom));
  fit.errors = estimate.errors.head<Knot::kSources>();
  fit.sigma_errors = estimate.sigma_errors.head<Knot::kSources>();
  return fit;
}

}  // namespace

SmoothedRun EstimatedRun(const Job& job, const FilterHistory& history,
                         std::span<const Increment> increments) {
  const JoinedKnots joined = Join(job, history, increments);
  std::vector<std::size_t> epochs, marked;
  for (std::size_t i = 0; i < joined.node.size(); ++i) {
    if (!history.epochs[i].station) continue;
    epochs.push_back(i);
    marked.push_back(joined.node[i]);
  }
  SmoothedRun smoothed = Smooth(history);
  RunEstimate estimate;
  if (!joined.knots.empty() && !joined.node.empty()) {
    EstimateSetup setup = SetupOf(job, history, joined);
    setup.causes = CausesLookedFor();
    setup.false_alarm_rate = kDiagnosisFalseAlarms;
    estimate =
        EstimateRun(setup, joined.knots,
                    {StartsOf(setup, history, joined), {GuessOf(setup, smoothed, joined)}}, marked);
  }
  if (!estimate.solved) {
    smoothed.fit = RunFit{};
    return smoothed;
  }
  SmoothedRun run;
  for (std::size_t i = 0; i < joined.node.size(); ++i) {
    const std::size_t node = joined.node[i];
    run.attitude.push_back(
        SampleOf(history.epochs[i].knot, estimate.nodes[node], estimate.cov_phi[node]));
  }
  for (std::size_t j = 0; j < epochs.size(); ++j) {
    StationState state;
    state.epoch = epochs[j];
    state.attitude = run.attitude[epochs[j]];
    state.along = history.epochs[epochs[j]].knot.along;
    TakeStation(estimate.marked[j], state);
    run.stations.push_back(std::move(state));
  }
  run.fit = FitOf(estimate);
  run.fit->diagnosis = DiagnosisOf(estimate.diagnosis, joined.knots);
  if (estimate.ambiguous) {
    for (AttitudeSample& a : run.attitude) ForgetAzimuth(a);
    for (StationState& s : run.stations) ForgetAzimuth(s.attitude);
  }
  return run;
}

}  // namespace wellgyro

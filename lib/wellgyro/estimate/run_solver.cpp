#include "wellgyro/estimate/run_solver.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "wellgyro/estimate/guess_pass.h"
#include "wellgyro/estimate/places.h"
#include "wellgyro/estimate/roll_start.h"
#include "wellgyro/estimate/run_solver_internal.h"

namespace wellgyro {
namespace {

// Gauss-Newton is trusted as far as this in one step: past it sine and angle part by 4 %. At 0.25
// and at 1 three clean runs come to the same solution, to 0.001 sigma.
constexpr double kStepMost = 0.5;  // [rad]
// Newton's decrement squared at which a run counts as converged: a thousandth of a sigma over all
// unknowns together.
constexpr double kStays = 1e-6;
// Steps towards it, since the last ones of a run with starts and stops are slow: with 15 three
// clean runs have the same bytes; and those over which the decrements' trend is taken.
constexpr int kFinish = 30, kSlow = 10;
// Ratios of a decrement to the last one. By less than kLeastFall nothing is extrapolated: a single
// step may fall more than the next. More than kCreeps creeps: Gauss-Newton takes far more than half
// off a decrement. Halved or doubled, these three lead three clean runs to the same solution, to
// 0.001 sigma, in 0.92 to 1.05 of the time.
constexpr double kLeastFall = 0.05, kCreeps = 0.5;

/// Decrement of the whole way still to go, by linear convergence: with q = decrement / last the
/// steps to come, roots of decrements, are a geometric series of ratio sqrt(q), and their sum has
/// the square decrement q / (1 - sqrt(q))^2.
double Left(double decrement, double last) {
  const double falls = std::max(decrement / last, kLeastFall);
  if (!(falls < 1)) return HUGE_VAL;
  const double rest = 1 - std::sqrt(falls);
  return decrement * falls / (rest * rest);
}

/// This step takes back more than half of the last one, over all attitudes.
bool TakesBack(const std::vector<NodeVector>& steps, const std::vector<NodeVector>& before) {
  double back = 0, way = 0;
  for (std::size_t k = 0; k < before.size(); ++k) {
    back -= steps[k].head<3>().dot(before[k].head<3>());
    way += before[k].head<3>().squaredNorm();
  }
  return back > 0.5 * way && way > 0;
}

}  // namespace

RunSolver::RunSolver(const EstimateSetup& setup, std::span<const RunKnot> knots,
                     const RunState* before)
    : setup_(setup),
      layout_(LayoutOf(setup_)),
      knots_(knots),
      before_(before),
      rows_(setup_, layout_),
      elimination_(layout_) {
  border_.setZero(layout_.border);
  if (before_ != nullptr) border_ = before_->border;
}

void RunSolver::Begin(const Eigen::Matrix3d& R_LT, std::span<const double> hidden_roll) {
  border_.setZero();
  GuessPass pass(setup_, knots_, hidden_roll);
  pass.Begin(R_LT);
  pass.Run(0, knots_.size());
  nodes_ = std::move(pass).nodes();
}

bool RunSolver::Linearise() {
  EdgeMatrix information;
  EdgeVector gradient;
  FirstRows(information, gradient);
  elimination_.Start(knots_.size(), information, gradient);
  block_.ClearSums();
  for (std::size_t k = 0; k < knots_.size(); ++k) {
    BlockOf(k, block_);
    if (!elimination_.Step(block_)) return false;
  }
  return true;
}

/// Moves all unknowns, by no more than kStepMost anywhere.
void RunSolver::Step(const std::vector<NodeVector>& steps, const BorderVector& border_step,
                     double share) {
  double most = 0;
  for (const NodeVector& step : steps) most = std::max(most, step.head<3>().norm());
  if (most > kStepMost) share = std::min(share, kStepMost / most);
  for (std::size_t k = 0; k < steps.size(); ++k) Move(layout_, share * steps[k], nodes_[k]);
  border_ += share * border_step;
}

void RunSolver::TakeOver(const RunSolver& other) {
  nodes_ = other.nodes_;
  places_ = other.places_;
  scales_ = other.scales_;
  border_.setZero();
  const auto take = [&](int to, int from) {
    if (to != kAbsent && from != kAbsent) border_[to] = other.border_[from];
  };
  const Layout& theirs = other.layout_;
  for (std::size_t i = 0; i < kErrorSources; ++i) {
    take(layout_.source[i], theirs.source[i]);
    take(layout_.change[i], theirs.change[i]);
  }
  if (layout_.ramp != kAbsent && theirs.ramp != kAbsent) {
    for (int i = 0; i < layout_.gyros; ++i) take(layout_.ramp + i, theirs.ramp + i);
  }
  take(layout_.latitude, theirs.latitude);
  take(layout_.gravity, theirs.gravity);
  take(layout_.gravity_gradient, theirs.gravity_gradient);
  take(layout_.frequency, theirs.frequency);
  take(layout_.depth_scale, theirs.depth_scale);
}

/// One step of Gauss-Newton; half of one that takes back the last, which overshot as this one
/// would.
bool RunSolver::Advance(SolveReport& report) {
  PlaceKnots(setup_.site, before_, knots_, nodes_, places_);
  BowKnots(knots_, RollRates(), places_);
  BorderVector border_step;
  if (!Linearise() || !elimination_.Solve(steps_, border_step)) return false;
  Step(steps_, border_step, TakesBack(steps_, last_steps_) ? 0.5 : 1);
  ++report.iterations;
  std::swap(steps_, last_steps_);
  return true;
}

/// Gauss-Newton until Newton's decrement squared is below `stays`: all unknowns together then move
/// by less than sqrt(stays) sigmas. Below kFar it also ends, false, where the decrement keeps more
/// than the share `creeps` of the last one: only the robust weights still settle then, and the next
/// scale of the roll changes them anyway.
bool RunSolver::Iterate(int most, double stays, SolveReport& report, double creeps) {
  last_steps_.clear();
  double last = HUGE_VAL;
  for (int i = 0; i < most; ++i) {
    if (!Advance(report)) return false;
    if (elimination_.decrement() < stays) return true;
    if (last < kFar && elimination_.decrement() > creeps * last) return false;
    last = elimination_.decrement();
  }
  return false;
}

/// Gauss-Newton until the run has converged; given up where the trend of its decrements leaves it
/// far from kNear after kFinish steps, or where its evidence cannot come below `least`.
void RunSolver::Finish(double least, SolveReport& report) {
  last_steps_.clear();
  std::vector<double> decrements;
  for (int i = 0; i < kFinish; ++i) {
    if (!Advance(report)) return;
    const double now = elimination_.decrement();
    if (now < kStays || Evidence() - kGain * now > least) return;
    if (i > 0 && Left(now, decrements.back()) < kStays) return;
    decrements.push_back(now);
    if (i < kSlow) continue;
    const double falls = now / decrements[static_cast<std::size_t>(i - kSlow)];
    if (now * std::pow(falls, static_cast<double>(kFinish - 1 - i) / kSlow) > kGain * kNear) return;
  }
}

bool RunSolver::SolveWithNoise(double gyro, double accel) {
  setup_.gyro.angle_random_walk *= gyro;
  setup_.gyro.quantization *= gyro;
  setup_.errors.accel_noise *= accel;
  SolveReport report;
  Finish(HUGE_VAL, report);
  return IsNear();
}

bool RunSolver::Approach(int iterations, const RollBegin& begin) {
  BeginScales(begin);
  SolveReport report;
  return Iterate(iterations, kNear, report, kCreeps) || elimination_.decrement() < kFar;
}

bool RunSolver::IsNear() const { return elimination_.decrement() < kNear; }

SolveReport RunSolver::Settle(double least) {
  SolveReport report;
  const bool measured = std::all_of(knots_.begin(), knots_.end(),
                                    [](const RunKnot& k) { return k.increment.has_axial; });
  if (!measured) {
    FindWalks(report);
    if (HidesAStart(knots_, scales_.speed_start)) {
      FindDecade(kShareLeast, 1, {&scales_.speed_share}, report);
    }
  }
  // KnotPlace::roll_walk enters the process noise only now that the scales are found. A bend
  // changes the roll rate slowly and in one direction, which is no random walk: with this noise
  // beside it the evidence would choose too small a walk.
  scales_.follows_hole = true;
  HoldRollWeights();
  Finish(least, report);
  report.converged = IsNear();
  report.sums = block_.sums();
  report.evidence = Evidence();
  report.roll_walk = scales_.roll_walk;
  return report;
}

}  // namespace wellgyro

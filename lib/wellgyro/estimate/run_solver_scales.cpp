// The scales by which the roll rate of a run may change, sought by their marginal likelihood.
#include <algorithm>
#include <cmath>

#include "wellgyro/estimate/roll_start.h"
#include "wellgyro/estimate/run_solver.h"
#include "wellgyro/estimate/run_solver_internal.h"

namespace wellgyro {
namespace {

// Of a tool that hardly turns [rad/s/sqrt(s)]: 1e-4 t^1.5 / sqrt(3) is 1.5 deg in a minute.
constexpr double kWalkHeld = 1e-4;
// Steps with each scale. With one the demonstration's azimuth sigmas are 4 % larger and its end is
// 0.05 sigma elsewhere; with four 0.1 % smaller and 0.002, in 26 % more time.
constexpr int kTry = 2;
constexpr double kHalfDecade = 3.1622776601683795;  // sqrt(10)

}  // namespace

std::vector<RollBegin> RollBeginsOf(std::span<const RunKnot> knots) {
  std::vector<RollBegin> begins = {{}};
  const bool seen = UsualRollChange(knots).has_value();
  if (!seen) begins.push_back({.walk = kWalkHeld});
  if (HidesAStart(knots, SpeedStarts(knots))) {
    begins.push_back({seen ? HUGE_VAL : kWalkHeld, kShareLeast});
  }
  return begins;
}

void RunSolver::BeginScales(const RollBegin& begin) {
  scales_ = {};
  scales_.roll_start = RollStarts(knots_);
  scales_.speed_start = SpeedStarts(knots_);
  scales_.roll_walk = scales_.swing_walk = std::min(RollWalkBy(knots_), begin.walk);
  scales_.speed_share = begin.share;
}

double RunSolver::Evidence() const {
  double evidence = elimination_.log_determinant() + border_.dot(layout_.information * border_) +
                    CostOfStarts(scales_.roll_start);
  for (const RowSum& sum : block_.sums()) evidence += sum.cost;
  const bool swings = layout_.swing != kAbsent;
  if (swings) evidence += 4 * std::log(kAnyRoll);  // of its prior
  for (std::size_t k = 0; k < knots_.size(); ++k) {
    const RollChange change = Change(k);
    evidence += 2 * std::log(change.sigma);
    if (swings) evidence += 4 * std::log(change.swing_sigma);
  }
  return evidence;
}

/// Evidence with `tried` for the scales, after at most kTry steps; HUGE_VAL where they do not
/// converge. An evidence below `least` by more than kGain decrements stays below it: the steps end
/// there, and what the linear model predicts of the next one is returned.
double RunSolver::EvidenceOf(double tried, double least, Scales scales, SolveReport& report) {
  for (double* scale : scales) *scale = tried;
  last_steps_.clear();
  for (int i = 0; i < kTry && Advance(report); ++i) {
    const double now = elimination_.decrement();
    if (now < kNear) break;
    if (Evidence() + kGain * now < least) return Evidence() - now;
  }
  return elimination_.decrement() < kFar ? Evidence() : HUGE_VAL;
}

/// Marginal likelihood of the scales, decade by decade from what they are, downwards or else
/// upwards; returns the best evidence and leaves the scales and the solution there.
///
/// Not the best fit of the residuals: roll rates are incidental parameters, as many as the knots
/// (Neyman and Scott, 1948), and too large a walk does more than widen the covariance. Near
/// vertical a free roll explains the more of the accelerometers' noise the more the hole leans,
/// which biases the inclination upwards. The evidence counts that freedom against what it explains.
double RunSolver::FindDecade(double least, double most, Scales scales, SolveReport& report) {
  const double begin = **scales.begin();
  double best = EvidenceOf(begin, -HUGE_VAL, scales, report), best_scale = begin;
  std::vector<Node> nodes = nodes_;
  BorderVector border = border_;
  for (const double step : {0.1, 10.}) {
    for (double tried = begin * step; tried > 0.9 * least && tried < 1.1 * most; tried *= step) {
      const double evidence = EvidenceOf(tried, best, scales, report);
      if (!(evidence < best)) break;
      best = evidence;
      best_scale = tried;
      nodes = nodes_;
      border = border_;
    }
    nodes_ = nodes;
    border_ = border;
    if (best_scale != begin) break;
  }
  for (double* scale : scales) *scale = best_scale;
  return best;
}

/// By the parabola through the scale, whose evidence this is, and the half decades beside it.
void RunSolver::FindBetween(double evidence, double& scale, SolveReport& report) {
  const double decade = scale;
  const std::vector<Node> nodes = nodes_;
  const BorderVector border = border_;
  double beside[2];
  for (const int side : {0, 1}) {
    const double tried = decade * (side == 0 ? 1 / kHalfDecade : kHalfDecade);
    beside[side] = EvidenceOf(tried, -HUGE_VAL, {&scale}, report);
    nodes_ = nodes;
    border_ = border;
  }
  scale = decade;
  const double bend = beside[0] - 2 * evidence + beside[1];
  if (!std::isfinite(bend) || !(bend > 0)) return;
  scale *= std::pow(kHalfDecade, std::clamp(0.5 * (beside[0] - beside[1]) / bend, -1.0, 1.0));
}

/// What the swing turns the tool by in each knot [rad]; zeros where there is none.
std::vector<double> RunSolver::Swung() const {
  const std::optional<double> swings = FrequencyOf(setup_, layout_, border_);
  if (!swings) return std::vector<double>(knots_.size(), 0);
  const double frequency = *swings;
  std::vector<double> swung;
  for (std::size_t k = 0; k < knots_.size(); ++k) {
    const double seconds = knots_[k].increment.seconds;
    swung.push_back(seconds * MeanOfSwing(frequency, seconds).dot(nodes_[k].swing));
  }
  return swung;
}

/// Over each knot, with its swing [rad/s].
std::vector<double> RunSolver::RollRates() const {
  std::vector<double> rates = Swung();
  for (std::size_t k = 0; k < knots_.size(); ++k) {
    rates[k] = nodes_[k].roll_rate + rates[k] / knots_[k].increment.seconds;
  }
  return rates;
}

/// What the roll rate and its swing walk by: first both by the same, so that neither takes the
/// other's part, then each by itself. A swing of one frequency goes on as it is while the rate
/// follows the hole and the string, or the other way round.
void RunSolver::FindWalks(SolveReport& report) {
  double &roll = scales_.roll_walk, &swing = scales_.swing_walk;
  double evidence = FindDecade(kRollWalkLeast, kRollWalkMost, {&roll, &swing}, report);
  if (layout_.swing != kAbsent) {
    scales_.roll_start = RollStarts(knots_, Swung());
    FindDecade(kRollWalkLeast, kRollWalkMost, {&swing}, report);
    evidence = FindDecade(kRollWalkLeast, kRollWalkMost, {&roll}, report);
  }
  // At the least walk that counts, less or somewhat more says the same.
  if (roll > 1.1 * kRollWalkLeast) FindBetween(evidence, roll, report);
}

}  // namespace wellgyro

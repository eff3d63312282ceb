#include "wellgyro/estimate/run_solver.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "wellgyro/estimate/guess_pass.h"
#include "wellgyro/estimate/places.h"
#include "wellgyro/estimate/roll_start.h"
#include "wellgyro/math/drift.h"
#include "wellgyro/math/rotation.h"

namespace wellgyro {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Priors of node 0 that say nothing against any measurement: a turn, a roll of 100 rpm, the
// length of a well.
constexpr double kAnyAttitude = 10;  // [rad]
constexpr double kAnyRoll = 10;      // [rad/s]
constexpr double kAnyDepth = 1e4;    // [m]
constexpr double kAnySpeed = 10;     // [m/s]
constexpr double kNoDrift = 1e-12;   // the walk begins at the bias [rad/s]
// Gauss-Newton is trusted as far as this in one step: past it sine and angle part by 4 %.
constexpr double kStepMost = 0.5;  // [rad]
// Newton's decrement squared at which a run stays: a thousandth of a sigma over all unknowns
// together.
constexpr double kStays = 1e-6;
constexpr int kFinish =
    30;  // steps towards it; the last ones of a run with starts and stops are slow
// What may be hoped for beyond what the linear model promises, or a trend over kSlow steps.
constexpr double kGain = 10;
constexpr int kSlow = 10;
constexpr double kLeastFall = 0.05;  // of decrements; one step alone may fall by more than the next
// Steps at which another roll walk can be told from the last, and from which it is not worth while.
constexpr double kNear = 1, kFar = 1e4;
constexpr double kWalkHeld = 1e-4;  // of a tool that hardly turns
constexpr int kTry = 2;             // steps with each scale: by the third the evidence hardly moves
constexpr double kCreeps = 0.5;     // Gauss-Newton takes far more off a decrement than its half
constexpr double kHalfDecade = 3.1622776601683795;

/// Decrement of the whole way still to go, by linear convergence: with q = decrement / last the
/// steps to come, roots of decrements, are a geometric series of ratio sqrt(q), and their sum has
/// the square decrement q / (1 - sqrt(q))^2.
double Left(double decrement, double last) {
  const double falls = std::max(decrement / last, kLeastFall);
  if (!(falls < 1)) return HUGE_VAL;
  const double rest = 1 - std::sqrt(falls);
  return decrement * falls / (rest * rest);
}

/// The attitudes go back most of the way that they came.
bool TakesBack(const std::vector<NodeVector>& steps, const std::vector<NodeVector>& before) {
  double back = 0, way = 0;
  for (std::size_t k = 0; k < before.size(); ++k) {
    back -= steps[k].head<3>().dot(before[k].head<3>());
    way += before[k].head<3>().squaredNorm();
  }
  return back > 0.5 * way && way > 0;
}

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

void RunSolver::Begin(const Matrix3d& R_LT) {
  border_.setZero();
  const RollTrack track = RollOfNeighbours(knots_, setup_);
  GuessPass pass(setup_, knots_, track);
  pass.Begin(R_LT);
  pass.Run(0, knots_.size());
  nodes_ = std::move(pass).nodes();
}

/// Information of node 0 and of the border before any knot.
void RunSolver::FirstRows(EdgeMatrix& information, EdgeVector& gradient) const {
  if (before_ != nullptr) {
    information = before_->information;
    gradient = information * AwayFrom(*before_, layout_, nodes_[0], border_);
    return;
  }
  const int n = layout_.node, b = layout_.border;
  const Node& first = nodes_[0];
  NodeVector sigma(n), value = NodeVector::Zero(n);
  sigma.head<3>().setConstant(kAnyAttitude);
  sigma[layout_.roll] = kAnyRoll;
  sigma[layout_.depth] = kAnyDepth;
  sigma[layout_.speed] = kAnySpeed;
  value[layout_.speed] = first.speed;
  if (layout_.walk != kAbsent) {
    sigma.segment<2>(layout_.walk).setConstant(kNoDrift);
    value.segment<2>(layout_.walk) = first.walk;
  }
  if (layout_.markov != kAbsent) {
    sigma.segment<2>(layout_.markov)
        .setConstant(kMarkovSigmaPerInstability * setup_.gyro.bias_instability);
    value.segment<2>(layout_.markov) = first.markov;
  }
  if (layout_.swing != kAbsent) {
    sigma.segment<2>(layout_.swing).setConstant(kAnyRoll);
    value.segment<2>(layout_.swing) = first.swing;
  }
  information.setZero(n + b, n + b);
  information.diagonal().head(n) = sigma.cwiseAbs2().cwiseInverse();
  information.bottomRightCorner(b, b) = layout_.information;
  gradient.resize(n + b);
  gradient.head(n) = value.cwiseQuotient(sigma.cwiseAbs2());
  gradient.tail(b) = layout_.information * border_;
}

/// Azimuths from outside that hold at this node, whose columns begin at `at`.
void RunSolver::AddTies(std::size_t node, NormalBlock& block, int at) {
  for (const AzimuthTie& tie : setup_.ties) {
    if (tie.node != node) continue;
    const Vector3d u = tie.of_mark ? Vector3d::UnitX() : Vector3d::UnitZ();
    const Matrix3d& R = nodes_[node].R_LT;
    const Vector3d direction = R * u;
    const Vector3d across(-std::sin(tie.azimuth), std::cos(tie.azimuth), 0);
    const Vector3d ahead(std::cos(tie.azimuth), std::sin(tie.azimuth), 0);
    const double horizontal = std::hypot(direction.x(), direction.y());
    if (!(horizontal > 0)) continue;
    // d azimuth = n . R (phi x u) / horizontal, n the horizontal normal of the direction.
    const Vector3d normal(-direction.y() / horizontal, direction.x() / horizontal, 0);
    Factor f;
    f.Begin(RowKind::kAzimuth, 1);
    f.per_unit = 1 / tie.sigma;
    f.r[0] = std::atan2(across.dot(direction), ahead.dot(direction)) / tie.sigma;
    const Eigen::RowVector3d by_phi = -normal.transpose() * R * Skew(u) / (horizontal * tie.sigma);
    for (int i = 0; i < 3; ++i) f.Column(at + layout_.phi + i)[0] = by_phi[i];
    block.Add(f);
  }
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
    for (int i = 0; i < 2; ++i) take(layout_.ramp + i, theirs.ramp + i);
  }
  take(layout_.latitude, theirs.latitude);
  take(layout_.gravity, theirs.gravity);
  take(layout_.gravity_gradient, theirs.gravity_gradient);
  take(layout_.frequency, theirs.frequency);
  take(layout_.depth_scale, theirs.depth_scale);
}

void RunSolver::BlockOf(std::size_t knot, NormalBlock& block) {
  block.Clear(layout_);
  if (knot == 0) AddTies(0, block, 0);
  AddTies(knot + 1, block, block.next());
  rows_.Add(knots_[knot], places_[knot], Change(knot), border_, nodes_[knot], nodes_[knot + 1],
            block);
}

void RunSolver::RowsOf(std::size_t knot, std::vector<Factor>& rows) {
  block_.Collect(&rows);
  BlockOf(knot, block_);
  block_.Collect(nullptr);
}

void RunSolver::Measure(std::size_t knot, const EdgeMatrix& begin, const EdgeMatrix& end,
                        const BehindMatrix& begin_with_end) {
  const int n = layout_.node, m = n + layout_.border;
  NormalBlock::Matrix joint(n + m, n + m);
  joint.topLeftCorner(n, n) = begin.topLeftCorner(n, n);
  joint.topRightCorner(n, m) = begin_with_end;
  joint.bottomLeftCorner(m, n) = begin_with_end.transpose();
  joint.bottomRightCorner(m, m) = end;
  block_.Clear(layout_);
  block_.Measure(&joint);
  AddTies(knot + 1, block_, block_.next());
  rows_.Add(knots_[knot], places_[knot], Change(knot), border_, nodes_[knot], nodes_[knot + 1],
            block_);
  block_.Measure(nullptr);
}

/// 1-sigma of the change of roll rate by an unobserved turn of the axis, in this knot or the next
/// [rad/s]: psi' = T' + A' cos I, with T' kept and A' = angle / sin I at most, hence angle cot I.
/// Nearer to vertical than 45 deg the high side holds no toolface, and the angle is the bound.
double RunSolver::WalkOfUnseen(std::size_t knot) const {
  double rate = 0;
  for (std::size_t k = knot; k < std::min(knot + 2, knots_.size()); ++k) {
    rate = std::max(rate, knots_[k].unseen / knots_[k].increment.seconds);
  }
  if (rate == 0) return 0;
  const Vector3d t = nodes_[knot + 1].tangent_L();
  const double along = std::abs(t.z());
  return rate * along / std::max(along, std::hypot(t.x(), t.y()));
}

/// 1-sigma of the change over a knot of the roll rate, or of its swing, that walks by `walk` and
/// starts and stops with the tool [rad/s].
double RunSolver::Walk(std::size_t knot, double walk) const {
  // A third axis measures the roll: its walk then only keeps the system whole.
  const Increment& inc = knots_[knot].increment;
  if (inc.has_axial) return std::sqrt(inc.seconds);
  const double seen = scales_.roll_start.empty() ? 0 : scales_.roll_start[knot];
  const double by_speed = scales_.speed_start.empty() ? 0 : scales_.speed_start[knot];
  return std::hypot(walk * std::sqrt(inc.seconds), std::max(seen, scales_.speed_share * by_speed),
                    WalkOfUnseen(knot));
}

RollChange RunSolver::Change(std::size_t knot) const {
  const double by_hole = scales_.follows_hole ? places_[knot].roll_walk : 0;
  const double with_hole = std::hypot(scales_.roll_walk, by_hole);
  RollChange change{Walk(knot, with_hole), Walk(knot, scales_.swing_walk), 0, 0};
  if (scales_.roll_weight.empty()) return change;
  change.weight = scales_.roll_weight[knot][0];
  change.swing_weight = scales_.roll_weight[knot][1];
  return change;
}

/// From here on the problem is one of least squares, which Gauss-Newton ends in few steps.
void RunSolver::HoldRollWeights() {
  const std::optional<double> frequency = FrequencyOf(setup_, layout_, border_);
  std::vector<std::array<double, 2>> weights(knots_.size());
  for (std::size_t k = 0; k < knots_.size(); ++k) {
    const RollSquares squares =
        RollSquaresOf(frequency, knots_[k].increment.seconds, places_[k].axial_change, Change(k),
                      nodes_[k], nodes_[k + 1]);
    weights[k] = {RollWeight(squares.rate, 1), RollWeight(squares.swing, 2)};
  }
  scales_.roll_weight = std::move(weights);
}

/// One step of Gauss-Newton. One that takes the last one back went too far, as the next one would:
/// half of it then.
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

/// Until the run stays; not as far where it will not within kFinish steps, or where its evidence
/// stays above `least`.
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

double RunSolver::Evidence() const {
  double evidence = elimination_.log_determinant() + border_.dot(layout_.information * border_);
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

bool RunSolver::SolveWithNoise(double gyro, double accel) {
  setup_.gyro.angle_random_walk *= gyro;
  setup_.gyro.quantization *= gyro;
  setup_.errors.accel_noise *= accel;
  SolveReport report;
  Finish(HUGE_VAL, report);
  return elimination_.decrement() < kNear;
}

void RunSolver::BeginScales(const RollBegin& begin) {
  scales_ = {};
  scales_.roll_start = RollStarts(knots_);
  scales_.speed_start = SpeedStarts(knots_);
  scales_.roll_walk = scales_.swing_walk = std::min(RollWalkBy(knots_), begin.walk);
  scales_.speed_share = begin.share;
}

bool RunSolver::Approach(int iterations) {
  BeginScales({});
  SolveReport report;
  return Iterate(iterations, kNear, report) || elimination_.decrement() < kFar;
}

SolveReport RunSolver::Solve(int iterations, double least, const RollBegin& begin) {
  SolveReport report;
  BeginScales(begin);
  Iterate(iterations, kNear, report, kCreeps);
  const bool measured = std::all_of(knots_.begin(), knots_.end(),
                                    [](const RunKnot& k) { return k.increment.has_axial; });
  if (!measured) {
    FindWalks(report);
    if (HidesAStart(knots_, scales_.speed_start)) {
      FindDecade(kShareLeast, 1, {&scales_.speed_share}, report);
    }
  }
  // Not before: that the hole changes the rate slowly and one way, evidence takes for a smaller
  // walk.
  scales_.follows_hole = true;
  HoldRollWeights();
  Finish(least, report);
  report.converged = elimination_.decrement() < kNear;
  report.sums = block_.sums();
  report.evidence = Evidence();
  report.roll_walk = scales_.roll_walk;
  return report;
}

}  // namespace wellgyro

#include "wellgyro/plan/synthetic_run.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numeric>

#include <Eigen/Geometry>

#include "wellgyro/base/angle.h"
#include "wellgyro/earth/earth_rate.h"
#include "wellgyro/estimate/places.h"
#include "wellgyro/estimate/roll_start.h"
#include "wellgyro/estimate/run_solver.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/math/sinc.h"
#include "wellgyro/math/so3.h"
#include "wellgyro/survey/verdict/run_diagnosis.h"

namespace wellgyro {
namespace {

using Complex = std::complex<double>;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr Complex kI{0, 1};
constexpr double kTurnKnot = 10;   // [s] to turn to another toolface, half a turn at 3 rpm
constexpr double kTurnMost = 0.6;  // [rad] of it in a knot, as KnotLength::roll
constexpr double kSigmaMd = 0.05;  // [m] of a mark against its neighbours: 5 counts of 1 cm
// What a rolling tool's rate does from knot to knot beyond its plan, beside kRollPerSpeed where the
// speed changes; where gravity shows the roll neither counts. With half or twice the walk the end's
// ellipse in the demonstration's well is the same, its worst unseen fault 2.05 or 2.83 m for 2.34.
constexpr double kRollWalk = 1e-3;       // [rad/s/sqrt(s)]
constexpr double kSpeedChanges = 0.001;  // [m/s]: a planned speed is even but for rounding

Vector2d Pair(Complex z) { return {z.real(), z.imag()}; }

/// Time on the move from the begin of the way to this place of it [s].
double MovingTo(const PlannedWay& way, double md, bool out) {
  if (!out) return std::max(0.0, md - way.begin_md) / way.speed_in;
  const double down = (way.end_md - way.begin_md) / way.speed_in;
  return down + (way.speed_out > 0 ? std::max(0.0, way.end_md - md) / way.speed_out : 0);
}

/// The least rotation that takes one direction to another less than half a turn away.
Matrix3d Least(const Vector3d& from, const Vector3d& to) {
  const Vector3d axis = from.cross(to);
  const double sine = axis.norm();
  if (!(sine > 0)) return Matrix3d::Identity();
  return Exp(std::atan2(sine, from.dot(to)) / sine * axis);
}

/// What an error of one unit of the two axes across, and of their scales, sums to in M while the
/// tool rolls by `roll` at an even rate; `v`: what is sensed, in M.
struct Evenly {
  double roll;
  Complex v;

  Complex scale(bool y) const {
    const Complex turned = std::conj(v) * Sinc(roll);
    return 0.5 * (y ? v - turned : v + turned);
  }
  double bias() const { return Sinc(0.5 * roll); }
};

void FillErrors(Increment& inc, double roll, const Vector3d& force_M) {
  const double dt = inc.seconds;
  const Evenly turn{roll, {inc.turn_M.x(), inc.turn_M.y()}};
  const Evenly force{roll, {force_M.x(), force_M.y()}};
  const double edge = turn.bias();
  auto& t = inc.turn_by_error;
  t.col(kGyroBiasX) = Vector2d(dt * edge, 0);
  t.col(kGyroBiasY) = Vector2d(0, dt * edge);
  t.col(kMassUnbalance) = Pair(dt * force.v);
  t.col(kQuadrature) = Pair(-kI * dt * force.v);
  t.col(kGyroScaleX) = Pair(turn.scale(false));
  t.col(kGyroScaleY) = Pair(turn.scale(true));
  t.col(kMisalignmentX) = Vector2d(roll * edge, 0);
  t.col(kMisalignmentY) = Vector2d(0, roll * edge);
  t.col(kToolfaceOffset) = Pair(kI * turn.v);
  t.col(kTimeSkew) = Pair(kI * turn.v * roll / dt);
  inc.ForceBy(kAccelBiasX) = Vector3d(edge, 0, 0);
  inc.ForceBy(kAccelBiasY) = Vector3d(0, edge, 0);
  inc.ForceBy(kAccelBiasZ) = Vector3d::UnitZ();
  inc.ForceBy(kAccelScaleX).head<2>() = Pair(force.scale(false));
  inc.ForceBy(kAccelScaleY).head<2>() = Pair(force.scale(true));
  inc.ForceBy(kAccelScaleZ) = force_M.z() * Vector3d::UnitZ();
  inc.ForceBy(kAccelMisalignmentX) = Vector3d(force_M.z() * edge, 0, 0);
  inc.ForceBy(kAccelMisalignmentY) = Vector3d(0, force_M.z() * edge, 0);
  inc.ForceBy(kAccelShear).head<2>() = Pair(kI * std::conj(force.v) * Sinc(roll));
  inc.ForceBy(kAccelMisalignmentZX) = force.v.real() * edge * Vector3d::UnitZ();
  inc.ForceBy(kAccelMisalignmentZY) = force.v.imag() * edge * Vector3d::UnitZ();
}

/// What perfect sensors say of a knot between these attitudes, `roll` being near their inertial
/// turn about the axis.
void FillIncrement(const Matrix3d& begin, const Matrix3d& end, const KnotPlace& place, double roll,
                   Increment& inc) {
  const double dt = inc.seconds;
  const Matrix3d turned = begin.transpose() * Exp(dt * place.w_IL_L) * end;
  const Matrix3d across = Least(Vector3d::UnitZ(), turned.col(2));
  const Matrix3d about = across.transpose() * turned;
  const double angle = roll + WrapPi(std::atan2(about(1, 0), about(0, 0)) - roll);
  inc.roll_before = inc.roll_after = 0.5 * angle;
  const Vector3d turn = RotationZ(-0.5 * angle) * Log(across);
  inc.turn_M = turn.head<2>();
  inc.turn_before_M = 0.5 * inc.turn_M;
  const Matrix3d R_LM = Exp(-0.5 * dt * place.w_IL_L) * begin * RotationZ(0.5 * angle) *
                        Exp({0.5 * turn.x(), 0.5 * turn.y(), 0});
  inc.force_M = R_LM.transpose() * (place.acceleration_L - place.site.gravity * Vector3d::UnitZ());
  inc.roll_seen = true;
  FillErrors(inc, angle, inc.force_M);
}

}  // namespace

EstimateSetup SetupOfPlan(const PlanCase& c) {
  EstimateSetup setup;
  setup.gyro = c.gyro;
  setup.errors = c.errors;
  setup.site = c.site;
  setup.third_axis = c.third_axis;
  setup.causes = CausesLookedFor(setup.site);
  setup.false_alarm_rate = kDiagnosisFalseAlarms;
  for (const CauseSpec& cause : setup.causes) {
    if (cause.kind != CauseSpec::Kind::kConstant && cause.kind != CauseSpec::Kind::kOnset) continue;
    // No stop helps against it, and a planned tool starts and stops at once.
    if (cause.unknown == kDepthScaleError) continue;
    if (double* sigma = PriorOf(cause.unknown, setup)) {
      *sigma = std::max(*sigma, kTestedPrior * cause.size);
    }
  }
  return setup;
}

SyntheticRun::SyntheticRun(const PlanCase& c, std::span<const PlannedStop> stops,
                           EstimateSetup setup, const KnotLength& knots)
    : case_(c),
      longest_(knots),
      setup_(std::move(setup)),
      layout_(LayoutOf(setup_)),
      stop_nodes_(stops.size(), 0),
      rows_(setup_, layout_) {
  CheckPlanCase(c, stops);
  setup_.site = c.site;
  setup_.ties.clear();
  const TrajectoryPoint first = c.well.AtMd(std::max(c.way.begin_md, c.well.md_begin()));
  if (c.sigma_start_azimuth) {
    setup_.ties.push_back({0, first.azimuth, *c.sigma_start_azimuth, first.inclination < 0.01});
  }
  Node node;
  node.R_LT = AttitudeMatrix(first.azimuth, first.inclination, c.way.toolface);
  node.md = c.way.begin_md;
  nodes_.push_back(node);
  AddWay(stops, false);
}

SyntheticRun::SyntheticRun(const PlanCase& c, std::span<const PlannedStop> stops,
                           const RunSoFar& so_far, const KnotLength& knots)
    : case_(c),
      longest_(knots),
      before_(so_far.state),
      setup_(so_far.state->setup),
      layout_(LayoutOf(setup_)),
      stop_nodes_(stops.size(), 0),
      rows_(setup_, layout_) {
  CheckPlanCase(c, stops);
  setup_.ties.clear();
  const Node& here = before_->node();
  nodes_.push_back(here);
  // Below, the hole goes on to lean as it does here against its plan; above, it came to that little
  // by little. A tool that slides goes on to swing as planned, from where it is.
  departs_L_ = Log(Least(HoleTangent(here.md), here.tangent_L()));
  moving_ = MovingTo(c.way, here.md, so_far.out);
  AddWay(stops, so_far.out);
}

void SyntheticRun::AddWay(std::span<const PlannedStop> stops, bool up) {
  std::vector<std::size_t> order(stops.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
    if (stops[i].out != stops[j].out) return stops[j].out;
    return stops[i].out ? stops[i].md > stops[j].md : stops[i].md < stops[j].md;
  });
  for (const std::size_t i : order) {
    const PlannedStop& stop = stops[i];
    if (stop.out && !up) AddMove(case_.way.end_md, case_.way.speed_in);
    up = up || stop.out;
    AddMove(stop.md, up ? case_.way.speed_out : case_.way.speed_in);
    const double before = ToolfaceNow();
    const bool turns = stop.toolface && stop.seconds > 0;
    if (turns) AddTurn(*stop.toolface);
    stop_nodes_[i] = knots_.size();
    AddRest(stop.seconds);
    if (turns) AddTurn(before);
  }
  const PlannedWay& way = case_.way;
  if (!up) AddMove(way.end_md, way.speed_in);
  if (way.speed_out > 0) AddMove(way.begin_md, way.speed_out);
  // A tool whose way is gone has its next second at rest.
  if (knots_.empty()) AddRest(1);
  MakeIncrements();
}

void SyntheticRun::AddKnot(double seconds, double to_md, double roll, bool still) {
  RunKnot knot;
  Increment& inc = knot.increment;
  seconds_ += seconds;
  inc.seconds = seconds;
  inc.time = ToolTime{std::llround(seconds_ * 1e9)};
  inc.has_axial = setup_.third_axis;
  knot.utc = UtcTime{inc.time.ns};
  knot.still = still;
  knot.along = {.md = to_md, .speed = 0, .sigma_md = kSigmaMd, .known = true};
  const Node& from = nodes_.back();
  Node to = from;
  to.md = to_md;
  to.speed = still ? 0 : (to_md - from.md) / seconds;
  knot.along.speed = to.speed;
  if (!still) {
    to.R_LT = Least(from.tangent_L(), HoleTangent(to_md)) * from.R_LT * RotationZ(roll);
  }
  knots_.push_back(knot);
  nodes_.push_back(to);
  rolls_.push_back(roll);
}

/// As planned, and as it departs from that.
Vector3d SyntheticRun::HoleTangent(double md) const {
  const Vector3d planned =
      case_.well.AtMd(std::clamp(md, case_.well.md_begin(), case_.well.md_end())).tangent_W;
  if (before_ == nullptr) return planned;
  const double begin = case_.way.begin_md, known = std::max(before_->node().md - begin, 1.0);
  return Exp(std::clamp((md - begin) / known, 0.0, 1.0) * departs_L_) * planned;
}

void SyntheticRun::AddMove(double to_md, double speed) {
  const PlannedWay& way = case_.way;
  const double from = nodes_.back().md, length = to_md - from;
  if (std::abs(length) < 1e-9) return;
  const double seconds = std::abs(length) / speed;
  const bool rolls = way.roll_rate != 0;
  const double fastest =
      rolls ? std::abs(way.roll_rate) : kTwoPi * std::abs(way.swing) / way.swing_period;
  const double knot = std::min(longest_.seconds, longest_.roll / std::max(fastest, 1e-6));
  const auto count = static_cast<int>(std::ceil(seconds / knot - 1e-9));
  for (int i = 1; i <= count; ++i) {
    // By the time on the move: a stop does not change how the tool comes to the next one.
    const double dt = seconds / count, at = kTwoPi * moving_ / way.swing_period;
    const double roll =
        rolls ? way.roll_rate * dt
              : way.swing * (std::sin(at + kTwoPi * dt / way.swing_period) - std::sin(at));
    AddKnot(dt, i == count ? to_md : from + length * i / count, roll, false);
    moving_ += dt;
  }
}

void SyntheticRun::AddRest(double seconds) {
  if (!(seconds > 0)) return;
  const auto count = static_cast<int>(std::ceil(seconds / kRestKnot - 1e-9));
  for (int i = 0; i < count; ++i) AddKnot(seconds / count, nodes_.back().md, 0, true);
}

double SyntheticRun::ToolfaceNow() const {
  const Matrix3d& R = nodes_.back().R_LT;
  return std::atan2(R(2, 1), -R(2, 0));
}

void SyntheticRun::AddTurn(double toolface) {
  const double roll = WrapPi(toolface - ToolfaceNow());
  const auto count = std::max(1, static_cast<int>(std::ceil(std::abs(roll) / kTurnMost)));
  for (int i = 0; i < count; ++i) {
    AddKnot(kTurnKnot / count, nodes_.back().md, roll / count, false);
  }
}

void SyntheticRun::MakeIncrements() {
  for (std::size_t k = 0; k + 1 < nodes_.size(); ++k) {
    if (!knots_[k].still) nodes_[k].speed = nodes_[k + 1].speed;
  }
  PlaceKnots(setup_.site, before_, knots_, nodes_, places_);
  for (std::size_t k = 0; k < knots_.size(); ++k) {
    const Matrix3d& begin = nodes_[k].R_LT;
    Increment& inc = knots_[k].increment;
    const double earth = inc.seconds * (begin.transpose() * places_[k].w_IL_L).z();
    FillIncrement(begin, nodes_[k + 1].R_LT, places_[k], rolls_[k] + earth, inc);
    nodes_[k].roll_rate = inc.roll() / inc.seconds;
  }
  nodes_.back().roll_rate = nodes_[nodes_.size() - 2].roll_rate;
}

void SyntheticRun::FirstRows(EdgeMatrix& information, EdgeVector& gradient) const {
  if (before_ != nullptr) {
    information = before_->information;
    gradient.setZero(information.rows());
    return;
  }
  RunSolver solver(setup_, std::span(knots_).first(1));
  solver.Begin(nodes_.front().R_LT, std::array{0.0});
  solver.FirstRows(information, gradient);
}

void SyntheticRun::AddTies(std::size_t node, NormalBlock& block, int at) const {
  for (const AzimuthTie& tie : setup_.ties) {
    if (tie.node != node) continue;
    // The azimuth of `u`, d = n . R (phi x u) / |horizontal part|, n across it.
    const Vector3d u = tie.of_mark ? Vector3d::UnitX() : Vector3d::UnitZ();
    const Matrix3d& R = nodes_[node].R_LT;
    const Vector3d along = R * u;
    const double horizontal = std::hypot(along.x(), along.y());
    if (!(horizontal > 0)) continue;
    const Vector3d across(-along.y() / horizontal, along.x() / horizontal, 0);
    const Eigen::RowVector3d by_phi = -across.transpose() * R * Skew(u) / (horizontal * tie.sigma);
    Factor f;
    f.Begin(RowKind::kAzimuth, 1);
    f.per_unit = 1 / tie.sigma;
    f.r[0] = 0;
    for (int i = 0; i < 3; ++i) f.Column(at + layout_.phi + i)[0] = by_phi[i];
    block.Add(f);
  }
}

void SyntheticRun::RowsOf(std::size_t k, std::vector<Factor>& rows) {
  block_.Collect(&rows);
  BlockOf(k, block_);
  block_.Collect(nullptr);
}

void SyntheticRun::BlockOf(std::size_t k, NormalBlock& block) {
  const Node &begin = nodes_[k], &end = nodes_[k + 1];
  const double dt = knots_[k].increment.seconds;
  const double speeds =
      std::abs(end.speed - begin.speed) + std::abs(k > 0 ? nodes_[k - 1].speed - begin.speed : 0.0);
  const double change = speeds > kSpeedChanges ? kRollPerSpeed * speeds : 0;
  const double walk = setup_.third_axis ? std::sqrt(dt) : kRollWalk * std::sqrt(dt);
  block.Clear(layout_);
  if (k == 0) AddTies(0, block, 0);
  rows_.Add(knots_[k], places_[k], {std::hypot(walk, change), 1, 1},
            BorderVector(BorderVector::Zero(layout_.border)), begin, end, block);
}

Factor SyntheticRun::RestAt(std::size_t node) {
  RunKnot knot;
  Increment& inc = knot.increment;
  inc.seconds = kRestKnot;
  knot.still = true;
  Node at = nodes_[node];
  at.speed = 0;
  KnotPlace place = places_[std::min(node, places_.size() - 1)];
  place.w_IL_L = EarthRateAt(place.site.latitude);
  place.acceleration_L.setZero();
  FillIncrement(at.R_LT, at.R_LT, place, inc.seconds * (at.R_LT.transpose() * place.w_IL_L).z(),
                inc);
  at.roll_rate = inc.roll() / inc.seconds;
  std::vector<Factor> rows;
  block_.Clear(layout_);
  block_.Collect(&rows);
  rows_.Add(knot, place, {1, 1, 1}, BorderVector(BorderVector::Zero(layout_.border)), at, at,
            block_);
  block_.Collect(nullptr);
  const auto found = std::find_if(rows.begin(), rows.end(),
                                  [](const Factor& f) { return f.kind == RowKind::kStill; });
  return *found;
}

}  // namespace wellgyro

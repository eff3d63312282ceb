#include "wellgyro/estimate/forward_run.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Cholesky>

#include "wellgyro/earth/earth_rate.h"
#include "wellgyro/estimate/normal_block.h"
#include "wellgyro/estimate/places.h"
#include "wellgyro/estimate/roll_start.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/math/so3.h"

namespace wellgyro {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// [rad] A knot is relinearised, at most kKnotIterations times, until a step turns its begin by
// less, as it takes where nothing shows the roll: the linearisation error, the square of that, 9e-6
// rad, is then below the 2e-5 rad of tilt that accelerometers of 2e-4 m/s^2/sqrt(Hz) tell in a knot
// of 1 s. Halved or doubled, these two move the ends of three clean runs by less than 0.001 sigma.
constexpr double kLinear = 3e-3;
constexpr int kKnotIterations = 4;

/// Linearisation point at the end of `knot`. Moving: dead reckoning by the gyros from `begin`.
/// Still: the attitude of `begin`, so that what the gyros read beside the Earth's rate is a
/// residual and not a turn; the roll alone follows its rate. The pseudo-measurement that ties the
/// two is far tighter than the roll is known, and off it the robust loss would take the gyros for
/// outliers.
Node Ahead(const RunKnot& knot, const Vector3d& w_IL_L, const Node& begin) {
  const Increment& inc = knot.increment;
  Node end = begin;
  const AlongHole& along = knot.along;
  end.md = along.known ? along.md : begin.md + begin.speed * inc.seconds;
  if (along.known) end.speed = along.speed;
  if (knot.still) {
    const double earth = (begin.R_LT.transpose() * w_IL_L).z();
    end.R_LT = begin.R_LT * RotationZ(inc.seconds * (begin.roll_rate - earth));
    return end;
  }
  const double delta = begin.roll_rate * inc.seconds - inc.roll();
  const Eigen::Vector2d turn = inc.turn_M + delta * inc.turn_per_roll;
  end.R_LT = Exp(-inc.seconds * w_IL_L) * begin.R_LT * RotationZ(inc.roll_before + 0.5 * delta) *
             Exp(Vector3d(turn.x(), turn.y(), 0)) * RotationZ(inc.roll_after + 0.5 * delta);
  return end;
}

/// 1-sigma of the change of roll rate at the end of the last knot [rad/s]: a random walk as usual
/// in the minute behind it, and what a change of speed there may make of the roll. A third axis
/// measures the roll: its walk is so wide that it tells nothing.
double WalkBehind(std::span<const RunKnot> knots) {
  const Increment& inc = knots.back().increment;
  if (inc.has_axial) return std::sqrt(inc.seconds);
  const auto recent = knots.last(std::min(knots.size(), ForwardRun::kLooksBack));
  return std::hypot(RollWalkBy(recent) * std::sqrt(inc.seconds), LastSpeedStart(recent));
}

/// Of a positive symmetric matrix; not finite where it is none.
EdgeMatrix InverseOf(const EdgeMatrix& information) {
  const Eigen::LLT<EdgeMatrix> llt(information);
  EdgeMatrix inverse = EdgeMatrix::Identity(information.rows(), information.cols());
  if (llt.info() != Eigen::Success) return inverse * std::numeric_limits<double>::quiet_NaN();
  llt.matrixL().solveInPlace(inverse);
  return inverse.transpose() * inverse;
}

/// Change of coordinates phi -> turn' phi of an information over [phi; others], after the attitude
/// has gone on by `turn`: phi stays the same vector in L. The unobserved direction, a
/// turn about the vertical, then stays the same too; with phi kept in T every relinearisation would
/// observe a little of it (inconsistency of the extended Kalman filter; Barrau and Bonnabel, IEEE
/// Trans. Autom. Control 62, 2017).
EdgeMatrix Turned(EdgeMatrix matrix, const Matrix3d& turn) {
  matrix.topRows<3>() = (turn.transpose() * matrix.topRows<3>()).eval();
  matrix.leftCols<3>() = (matrix.leftCols<3>() * turn).eval();
  return matrix;
}

}  // namespace

ForwardRun::ForwardRun(const RunState& solved, std::span<const RunKnot> knots)
    : state_(solved), layout_(LayoutOf(solved.setup)) {
  FreeRoll(WalkBehind(knots));
  cov_phi_T_ = InverseOf(state_.information).topLeftCorner<3, 3>();
}

/// Process noise of variance s^2 on the roll rate, in information form (matrix inversion lemma):
///   I <- I - I e s^2 e' I / (1 + s^2 e' I e),  e the unit vector of the roll rate,
/// of which e' I / (1 + s^2 e' I e) is the roll's own row. The solver found starts and stops of the
/// roll by the knots after them; the last knot has none, and was held as steady as the rest.
void ForwardRun::FreeRoll(double sigma) {
  const int roll = layout_.roll;
  const double var = sigma * sigma;
  const EdgeVector told = state_.information.col(roll);
  const EdgeVector left = told / (1 + var * told[roll]);
  state_.information -= var * told * left.transpose();
  state_.information.col(roll) = left;
  state_.information.row(roll) = left.transpose();
  const Vector3d by_roll = state_.way.by.col(roll);
  state_.way.cov_W += var / (1 + var * told[roll]) * by_roll * by_roll.transpose();
  state_.way.by -= var * by_roll * left.transpose();
  // What errors of the station before have in common with the node's stays as it was.
  if (state_.link.size() > 0) state_.link -= var * state_.link.col(roll).eval() * left.transpose();
}

/// The last knot of `tail`, between the newest node and `end`.
KnotPlace ForwardRun::PlaceOf(std::span<const RunKnot> tail, const Node& end) const {
  std::vector<Node> nodes(state_.nodes.end() - static_cast<std::ptrdiff_t>(tail.size()),
                          state_.nodes.end());
  nodes.push_back(end);
  std::vector<KnotPlace> places;
  PlaceKnots(state_.setup.site, &state_, tail, nodes, places);
  KnotPlace place = places.back();
  place.since_start = state_.seconds + 0.5 * tail.back().increment.seconds;
  place.depth = state_.p_W.z();
  return place;
}

bool ForwardRun::Step(std::span<const RunKnot> knots, const Increment* next) {
  const RunKnot& knot = knots.back();
  const Vector3d earth = EarthRateAt(state_.setup.site.latitude);
  Node begin = state_.nodes.back();
  const KnotPlace place =
      PlaceOf(knots.last(std::min(knots.size(), RunState::kTail)), Ahead(knot, earth, begin));
  // Linearised at the roll rate that gravity shows, not at the walk's prediction.
  if (knot.increment.roll_seen) begin.roll_rate = knot.increment.roll() / knot.increment.seconds;
  Node end = Ahead(knot, place.w_IL_L, begin);
  if (next != nullptr && next->roll_seen) end.roll_rate = next->roll() / next->seconds;
  BorderVector border = state_.border;
  KnotRows rows(state_.setup, layout_);
  // Robust weights of the roll's change: of what gravity shows, and held through the iterations.
  const double sigma = WalkBehind(knots);
  RollChange walk{.sigma = sigma, .swing_sigma = sigma};
  const RollSquares squares =
      RollSquaresOf(FrequencyOf(state_.setup, layout_, border), knot.increment.seconds,
                    place.axial_change, walk, begin, end);
  walk.weight = RollWeight(squares.rate, 1);
  walk.swing_weight = RollWeight(squares.swing, 2);
  Elimination elimination(layout_);
  std::vector<NodeVector> steps;
  for (int i = 0; i < kKnotIterations; ++i) {
    NormalBlock block;
    block.Clear(layout_);
    rows.Add(knot, place, walk, border, begin, end, block);
    elimination.Start(1, state_.information,
                      state_.information * AwayFrom(state_, layout_, begin, border));
    BorderVector border_step;
    if (!elimination.Step(block) || !elimination.Solve(steps, border_step)) return false;
    Move(layout_, steps.front(), begin);
    Move(layout_, steps.back(), end);
    border += border_step;
    const double rolled = steps.front()[layout_.roll] * knot.increment.seconds;
    if (std::max(steps.front().head<3>().norm(), std::abs(rolled)) < kLinear) break;
  }
  state_.border = border;
  Arrive(elimination, begin, end, steps.back());
  state_.seconds += knot.increment.seconds;
  return true;
}

/// phi of the information, the covariance and the links is about the linearisation point of the
/// end, which the last step turns.
void ForwardRun::Arrive(const Elimination& elimination, const Node& begin, const Node& end,
                        const NodeVector& last_step) {
  const Matrix3d turn = Exp(last_step.head<3>());
  state_.information = Turned(elimination.edge_information().selfadjointView<Eigen::Lower>(), turn);
  cov_phi_T_ = turn.transpose() * elimination.LastCovarianceOfPhi() * turn;
  const BehindMatrix gain = elimination.Gain(0);
  if (state_.link.size() > 0) {
    CarryLink(layout_, gain, state_.link);
    state_.link.leftCols<3>() = (state_.link.leftCols<3>() * turn).eval();
  }
  CarryWay(layout_, begin, end, gain, elimination.Remainder(0), state_.way);
  state_.way.by.leftCols<3>() = (state_.way.by.leftCols<3>() * turn).eval();
  const Node& before = state_.nodes.back();
  state_.p_W += 0.5 * (end.md - before.md) * (before.tangent_L() + end.tangent_L());
  std::rotate(state_.nodes.begin(), state_.nodes.begin() + 1, state_.nodes.end());
  state_.nodes.back() = end;
}

double ForwardRun::SigmaOfHeading() const {
  return std::sqrt(HeadingVariance(node().R_LT, CovPhi()));
}

LinkedErrors ForwardRun::Mark(std::size_t node) {
  const std::vector<int> columns = LinkedColumns(layout_);
  LinkedErrors mark;
  mark.node = node;
  const EdgeMatrix cov = InverseOf(state_.information);
  mark.cov = cov(columns, columns);
  if (state_.link.size() > 0) mark.cov_with_previous = (state_.link * cov)(Eigen::all, columns);
  state_.link = LinkedRows(layout_);
  return mark;
}

}  // namespace wellgyro

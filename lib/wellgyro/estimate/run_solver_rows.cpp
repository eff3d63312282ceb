// The rows of a run that a solver linearises: priors, ties, and how the roll rate may change.
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "wellgyro/estimate/run_solver.h"
#include "wellgyro/estimate/run_solver_internal.h"
#include "wellgyro/math/drift.h"
#include "wellgyro/math/so3.h"

namespace wellgyro {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Priors of node 0 that, as kAnyRoll, say nothing against any measurement: a turn, the length of a
// well.
constexpr double kAnyAttitude = 10;  // [rad]
constexpr double kAnyDepth = 1e4;    // [m]
constexpr double kAnySpeed = 10;     // [m/s]
constexpr double kNoDrift = 1e-12;   // the walk begins at the bias, to 2e-7 deg/h [rad/s]

}  // namespace

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
  const auto of_gyros = [&](int column, double of_each, const Vector3d& drift) {
    if (column == kAbsent) return;
    sigma.segment(column, layout_.gyros).setConstant(of_each);
    value.segment(column, layout_.gyros) = drift.head(layout_.gyros);
  };
  of_gyros(layout_.walk, kNoDrift, first.walk_T);
  of_gyros(layout_.markov, kMarkovSigmaPerInstability * setup_.gyro.bias_instability,
           first.markov_T);
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
  const BlockMatrix joint = JointCovariance(begin, begin_with_end, end);
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

/// Holds the robust weights of the roll's rows: from here on the problem is one of weighted least
/// squares, which Gauss-Newton ends in few steps.
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

}  // namespace wellgyro

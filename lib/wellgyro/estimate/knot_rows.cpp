#include "wellgyro/estimate/knot_rows.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "wellgyro/estimate/log_slopes.h"
#include "wellgyro/estimate/second_order.h"
#include "wellgyro/estimate/turn_columns.h"
#include "wellgyro/estimate/wobble.h"
#include "wellgyro/math/drift.h"
#include "wellgyro/math/plane.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/math/square.h"

namespace wellgyro {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

// What is left of the residuals of perfect sensors: an increment's own accuracy (see
// IncrementBuilder), and an acceleration of the path whose curvature changes within the window
// that it is read from, 1 deg/30 m at 0.3 m/s. Of an hour straight on at 60 deg and 3 rpm, no
// noise and none stated, azimuths are off by 1e-6 deg; their sigma is 3.2e-3, in proportion to
// kLeastTurn.
constexpr double kLeastTurn = 1e-7;   // [rad]
constexpr double kLeastForce = 5e-5;  // [m/s^2 sqrt(s)], so that of a moment it tells nothing
// The turn about the axis is the unknown roll rate's; this ties it to the attitude. A tenth of the
// finest toolface that accelerometers tell in a knot, 1e-5 g, and of what a third axis says. At
// half and at twice of it the ends of three clean runs move by 0.006 sigma, sigmas change by 0.9
// and 0.4 %.
constexpr double kAxialTie = 1e-6;  // [rad]
// Sigma of a pseudo-measurement of zero, over that of the gyros' turn: the tie beside a third axis,
// and the turn of a tool at rest. It widens the gyros' sigma by sqrt(1 + 0.1^2) - 1 = 0.5 %.
constexpr double kNothing = 0.1;
// Speed of a tool at rest [m/s]: as it starts gently a block of a second counts as still with a
// force that has changed by up to 1e-3 m/s^2 and five sigmas, as much again of a tool with 2e-4
// m/s^2/sqrt(Hz).
constexpr double kRestSpeed = 2e-3;
// Motion along the hole: what a mark and a knot's way are known to at best, and
// how a speed walks, a third of a m/s in a second. Halved or doubled, each moves the ends of three
// clean runs by less than 0.001 sigma.
constexpr double kSpeedWalk = 0.3;    // [m/s/sqrt(s)], of winch and pipe
constexpr double kLeastDepth = 1e-3;  // [m]
constexpr double kLeastWay = 1e-4;    // [m]
constexpr double kUnknownSpeed = 1;   // [m/s], without depth marks
// Truncation error of the trapezoidal rule for the way, over a dt^2, with a the acceleration by the
// depth's fit. A change of acceleration within the knot errs by at most 1/8 of it (see AddDepth),
// and the fit, a mean over its window, may show but a quarter of the change: 4/8. At 0.25 and at 1
// the ends of three clean runs move by 0.001 sigma.
constexpr double kTrapezoid = 0.5;

/// Whitens the direction lateral to the force by its own variance: of the noise's part `seen` it is
/// Increment::lateral times as large.
void ShrinkLateral(const Increment& inc, double seen, double missed, Factor& f) {
  const double norm = inc.force_M.head<2>().norm();
  if (inc.lateral == 1 || !(norm > 0)) return;
  const Vector3d lateral(-inc.force_M.y() / norm, inc.force_M.x() / norm, 0);
  f.Shrink(lateral, std::sqrt((inc.lateral * seen + missed) / (seen + missed)));
}

}  // namespace

void KnotRows::Add(const RunKnot& knot, const KnotPlace& place, const RollChange& roll,
                   const BorderVector& border, const Node& begin, const Node& end,
                   NormalBlock& block) {
  const Terms t = TermsOf({setup_, layout_, known_}, knot, place, border, begin, end);
  AddTurn(t, block);
  if (knot.increment.level) AddForce(t, block);
  if (knot.increment.has_axial) AddAxial(t, block);
  AddRoll(t, roll, block);
  AddDepth(t, block);
  AddDrift(t, block);
  if (knot.still) AddRest(t, block);
}

/// White noise of a gyro's turn over `dt`, 1 sigma [rad].
double KnotRows::TurnNoise(double dt) const {
  const double var =
      Square(setup_.gyro.angle_random_walk) * dt + 2 * Square(setup_.gyro.quantization);
  return std::max(std::sqrt(var), kLeastTurn);
}

/// Columns of what the mean roll rate is made of, `by_rate` being the residuals' derivative by it.
void KnotRows::AddRate(const Terms& t, const Vector3d& by_rate, NormalBlock& block) {
  factor_.Column(layout_.roll) = by_rate;
  if (layout_.swing == kAbsent) return;
  for (int i = 0; i < 2; ++i) factor_.Column(layout_.swing + i) = t.of_swing[i] * by_rate;
  factor_.Column(block.border() + layout_.frequency) =
      MeanByFrequency(t.frequency, t.dt).dot(t.begin.swing) * by_rate;
}

/// Columns of an error and of its change with the temperature, `by_error` being the residuals'
/// derivative by it.
void KnotRows::AddError(const Terms& t, int source, const Vector3d& by_error,
                        const NormalBlock& block) {
  const int at = layout_.source[static_cast<std::size_t>(source)];
  const int change = layout_.change[static_cast<std::size_t>(source)];
  if (at != kAbsent) factor_.Column(block.border() + at) = by_error;
  if (change != kAbsent) factor_.Column(block.border() + change) = t.warmth * by_error;
}

/// Log[(E R_k R_TM_begin Exp(turn) R_MT_end)' R_k+1], E = Exp(-w_IL dt): across the axis the gyros'
/// noise, about it the tie of roll rate and attitude.
void KnotRows::AddTurn(const Terms& t, NormalBlock& block) {
  const Increment& inc = t.inc;
  const Matrix3d X = Exp(Flat(t.turn));
  const Matrix3d B = t.R_TM_begin * X * t.R_MT_end;
  const Matrix3d R_end = Exp(-t.dt * t.w_IL_L) * t.begin.R_LT * B;
  const double var = Square(setup_.gyro.angle_random_walk) * t.dt +
                     2 * Square(setup_.gyro.quantization) + inc.var_turn + t.knot.var_unseen;
  const double across = 1 / std::max(std::sqrt(var), kLeastTurn);
  const double tie = inc.has_axial ? std::min(kAxialTie, kNothing * TurnNoise(t.dt)) : kAxialTie;
  const Vector3d whiten(across, across, 1 / tie);
  const auto by = whiten.asDiagonal();
  const Eigen::Matrix<double, 3, 2> turned = t.R_MT_end.topRows<2>().transpose();  // of a turn in M

  Factor& f = factor_;
  f.Begin(t.knot.still ? RowKind::kStill : RowKind::kTurn, 3);
  f.measured = 2;
  f.per_unit = across;
  const Vector3d r = Log(R_end.transpose() * t.end.R_LT);
  const LogSlopes slopes(r);
  f.r = by * r;
  const Matrix3d by_begin = by * slopes.left * -B.transpose(), by_end = by * slopes.right;
  for (int i = 0; i < 3; ++i) f.Column(layout_.phi + i) = by_begin.col(i);
  for (int i = 0; i < 3; ++i) f.Column(block.next() + layout_.phi + i) = by_end.col(i);
  const Vector3d by_delta = -0.5 * (X * t.R_MT_end).row(2).transpose() - 0.5 * Vector3d::UnitZ() -
                            turned * (t.turn_per_roll + t.skew_per_roll);
  const Vector3d by_rate = by * (t.dt * by_delta);
  AddRate(t, by_rate, block);
  TurnErrors by_error =
      by * (turned * WithoutNoise(inc, t.turn_by_error, (t.R_MT_end * r).head<2>()));
  for (int i = 0; i < 2; ++i) AddGyroDrift(t, i, by_error.col(kGyroBiasX + i), block);
  // Of PhaseErrors: where in the knot psi turns, and what the rates are turned by.
  const Vector3d by_bow = Vector3d::UnitZ() - (X * t.R_MT_end).row(2).transpose();
  const PhaseColumns by_phase =
      by *
      (by_bow * t.wobble.bow() + turned * (t.wobble.turn_M - t.turn_per_roll * t.wobble.roll()));
  for (const int source : kPhaseSources) {
    const Vector3d by_psi = by_phase * PhaseErrorsOf(source, inc.force_M.z());
    if (source < kTurnSources) by_error.col(source) += by_psi;
    if (source >= kTurnSources) AddError(t, source, by_psi, block);
  }
  for (std::size_t k = 0; k < kTurns.size(); ++k) {
    AddError(t, kTurns[k], by_error.col(static_cast<Eigen::Index>(k)), block);
  }
  if (layout_.latitude != kAbsent) {
    f.Column(block.border() + layout_.latitude) =
        by * (t.end.R_LT.transpose() * (t.dt * t.place.dw_by_latitude_L));
  }
  block.Add(f);
}

/// Columns of a gyro's drift: random walk and Gauss-Markov part, of which a knot has the mean of
/// its two ends, and ramp.
void KnotRows::AddGyroDrift(const Terms& t, int gyro, const Vector3d& by_bias, NormalBlock& block) {
  for (const int drift : {layout_.walk, layout_.markov}) {
    if (drift == kAbsent) continue;
    factor_.Column(drift + gyro) = 0.5 * by_bias;
    factor_.Column(block.next() + drift + gyro) = 0.5 * by_bias;
  }
  if (layout_.ramp == kAbsent) return;
  factor_.Column(block.border() + layout_.ramp + gyro) = t.place.since_start * by_bias;
}

/// Gravity beyond the model's, where it is unknown [m/s^2].
double KnotRows::GravityOffset(const Terms& t) const {
  double gravity = layout_.gravity == kAbsent ? 0 : t.border[layout_.gravity];
  if (layout_.gravity_gradient != kAbsent) {
    gravity += t.place.depth * t.border[layout_.gravity_gradient];
  }
  return gravity;
}

/// Columns of the tool's errors in the force's factor. M is where half of the turn leads, so that
/// an error d of the turn changes the predicted force `p_M` by p_M x d / 2; of a misalignment,
/// whose error goes round with the roll, by p_M x (d / 2 + `beyond`), see SkewBeforeHalf().
void KnotRows::AddForceErrors(const Terms& t, double whiten, const Vector3d& p_M,
                              const Vector3d& by_skew_M, const Eigen::Matrix2d& beyond,
                              const PhaseColumns& by_phase, NormalBlock& block) {
  const auto add = [&](int source, const Vector3d& by_error) {
    AddError(t, source, whiten * by_error, block);
  };
  for (std::size_t k = 0; k < kTurns.size(); ++k) {
    const int i = kTurns[k];
    const Vector2d turn = t.turn_by_error.col(static_cast<Eigen::Index>(k));
    Vector2d half = 0.5 * turn - t.delta / 8 * QuarterTurned(turn);
    if (i == kMisalignmentX || i == kMisalignmentY) half += beyond.col(i - kMisalignmentX);
    Vector3d by_error = p_M.cross(Flat(half)) - t.delta / 24 * t.inc.force_M.z() * Flat(turn);
    if (i == kTimeSkew) by_error -= by_skew_M;
    if (i < kTurnSources) by_error += by_phase * PhaseErrorsOf(i, t.inc.force_M.z());
    add(i, by_error);
  }
  for (int i = kAccelBiasX; i <= kAccelMisalignmentZY; ++i) {
    add(i, by_phase * PhaseErrorsOf(i, t.inc.force_M.z()) - ForceBy(t, i));
  }
  for (int i = 0; layout_.second_order && i < kSecondOrderSources; ++i) {
    add(kAccelSecondOrder + i, -t.by_second_order.col(i));
  }
}

/// Mean force in M less R_LM' (a - g) less the change of speed along the axis.
void KnotRows::AddForce(const Terms& t, NormalBlock& block) {
  const Increment& inc = t.inc;
  const Vector3d down_M = t.R_LM.row(2).transpose();
  const Vector3d path = t.R_LM.transpose() * t.place.acceleration_L;
  const Vector3d p_M = path - t.place.site.gravity * down_M;
  // Forces read later than they are stamped are those of a tool that has turned on: dF/dt = F x w,
  // of a roll to the second order.
  Vector3d by_skew_M = inc.force_M.cross(Flat(t.turn) / t.dt + t.axial_rate * Vector3d::UnitZ());
  by_skew_M += 0.5 * Square(t.axial_rate) * t.error[kTimeSkew] * Flat(inc.force_M.head<2>());
  const Eigen::Matrix2d beyond = SkewBeforeHalf(inc);
  const Vector2d skew(t.error[kMisalignmentX], t.error[kMisalignmentY]);
  Vector3d force = ForceOf(t, layout_, by_skew_M) + p_M.cross(Flat(beyond * skew));
  const Vector2d across = force.head<2>();
  force += t.delta * Flat(inc.force_per_roll - t.delta / 24 * across);
  // Rotation of f_z to mid-knot by the turn across the axis: that turn goes round by delta, which
  // psi has not seen, and its mean changes by delta / 24.
  force += t.delta / 24 * inc.force_M.z() * Flat(t.turn);
  const Vector3d force_per_roll = Flat(inc.force_per_roll - t.delta / 12 * across);
  // M is where half of the measured turn leads. Half of an unobserved turn is missing: 1-sigma
  // unseen / 2 times gravity.
  const double noise = std::max(setup_.errors.accel_noise, kLeastForce) / std::sqrt(t.dt);
  const double seen = Square(noise), missed = Square(0.5 * t.knot.unseen * t.place.site.gravity);
  const double whiten = 1 / std::sqrt(seen + missed);
  const Matrix3d px = Skew(p_M);

  Factor& f = factor_;
  f.Begin(RowKind::kForce, 3);
  f.per_unit = whiten;
  f.r = whiten * (force - p_M + GravityOffset(t) * down_M -
                  (t.end.speed - t.begin.speed) / t.dt * Vector3d::UnitZ());
  const Matrix3d by_phi =
      -(px + down_M.cross(path) * down_M.transpose()) * (t.R_TM_begin * t.R_MM_half).transpose();
  for (int i = 0; i < 3; ++i) f.Column(layout_.phi + i) = whiten * by_phi.col(i);
  const Vector3d by_rate =
      whiten * t.dt * (-0.5 * px * t.R_MM_half.row(2).transpose() + force_per_roll);
  AddRate(t, by_rate, block);
  f.Column(layout_.speed) = whiten / t.dt * Vector3d::UnitZ();
  f.Column(block.next() + layout_.speed) = -whiten / t.dt * Vector3d::UnitZ();
  PhaseColumns by_phase =
      force_per_roll * t.wobble.roll() - px * t.R_MM_half.row(2).transpose() * t.wobble.bow();
  by_phase.topRows<2>() -= t.wobble.force_M;
  AddForceErrors(t, whiten, p_M, by_skew_M, beyond, by_phase, block);
  if (layout_.gravity != kAbsent) f.Column(block.border() + layout_.gravity) = whiten * down_M;
  if (layout_.gravity_gradient != kAbsent) {
    f.Column(block.border() + layout_.gravity_gradient) = whiten * t.place.depth * down_M;
  }
  ShrinkLateral(inc, seen, missed, f);
  block.Add(f);
}

/// Random walk of the roll rate in the hole, r = (rate_k+1 - rate_k - axial_change) / sigma, and of
/// a swing, which turns by its own frequency. axial_change is the change of the Earth's rate along
/// the axis, taken of the path as it stands and not differentiated: its derivative would make a
/// steady roll a pseudo-measurement of azimuth, which gyros across the axis do not give.
void KnotRows::AddRoll(const Terms& t, const RollChange& roll, NormalBlock& block) {
  const double whiten = 1 / roll.sigma;
  Factor& f = factor_;
  f.Begin(RowKind::kRoll, 1);
  f.held = roll.weight;
  f.r[0] = whiten * (t.end.roll_rate - t.begin.roll_rate - t.place.axial_change);
  f.Column(layout_.roll)[0] = -whiten;
  f.Column(block.next() + layout_.roll)[0] = whiten;
  block.Add(f);
  if (layout_.swing == kAbsent) return;
  f.Begin(RowKind::kRoll, 2);
  f.held = roll.swing_weight;
  const double of_swing = 1 / roll.swing_sigma;
  f.r.head<2>() = of_swing * (t.end.swing - SwingAfter(t.frequency, t.dt, t.begin.swing));
  for (int i = 0; i < 2; ++i) {
    f.Column(layout_.swing + i).head<2>() =
        -of_swing * SwingAfter(t.frequency, t.dt, Vector2d::Unit(i));
    f.Column(block.next() + layout_.swing + i).head<2>() = of_swing * Vector2d::Unit(i);
  }
  f.Column(block.border() + layout_.frequency).head<2>() =
      -of_swing * SwingByFrequency(t.frequency, t.dt, t.begin.swing);
  block.Add(f);
}

/// Row of a third axis, of which psi is the integral, so that its error is -delta:
///   r = delta + dt (bias + drift) + roll scale + across . misalignment.
/// The scale's column is the roll without the axis's noise (errors in variables, WithoutNoise()).
/// `across` is the turn in T: that in M by the mean of e^{-i psi}, as if it went evenly.
void KnotRows::AddAxial(const Terms& t, NormalBlock& block) {
  const double whiten = 1 / TurnNoise(t.dt);
  const double axial = t.inc.roll();
  const Vector2d unit = t.inc.ForceBy(kAccelBiasX).head<2>();
  const Vector2d across(unit.dot(t.turn), unit.x() * t.turn.y() - unit.y() * t.turn.x());
  Factor& f = factor_;
  f.Begin(RowKind::kAxial, 1);
  f.r[0] =
      whiten * (t.delta + t.dt * (t.error[kGyroBiasZ] + t.drift_T.z()) +
                axial * t.error[kGyroScaleZ] + across.dot(t.error.segment<2>(kGyroMisalignmentZX)));
  AddRate(t, {whiten * t.dt, 0, 0}, block);
  AddError(t, kGyroBiasZ, {whiten * t.dt, 0, 0}, block);
  AddGyroDrift(t, 2, {whiten * t.dt, 0, 0}, block);
  AddError(t, kGyroScaleZ, {whiten * (axial + t.delta), 0, 0}, block);
  for (int i = 0; i < 2; ++i) {
    AddError(t, kGyroMisalignmentZX + i, {whiten * across[i], 0, 0}, block);
  }
  block.Add(f);
}

/// Rows along the hole: the depth mark, or a vague speed where there is none; the knot's way by the
/// trapezoidal rule; a random walk of the speed.
void KnotRows::AddDepth(const Terms& t, NormalBlock& block) {
  Factor& f = factor_;
  const AlongHole& along = t.knot.along;
  const int depth = layout_.depth, speed = layout_.speed, next = block.next();
  if (along.known) {
    // Where a scale of 1 begins does not matter: no other row knows a depth but from another.
    const double whiten = 1 / std::max(along.sigma_md, kLeastDepth);
    const int at = layout_.depth_scale;
    const double scale = at == kAbsent ? 1 : 1 + t.border[at];
    f.Begin(RowKind::kDepth, 1);
    f.r[0] = whiten * (scale * t.end.md - along.md);
    f.Column(next + depth)[0] = whiten * scale;
    if (at != kAbsent) f.Column(block.border() + at)[0] = whiten * t.end.md;
    block.Add(f);
  } else {
    f.Begin(RowKind::kSpeed, 1);
    f.r[0] = t.end.speed / kUnknownSpeed;
    f.Column(next + speed)[0] = 1 / kUnknownSpeed;
    block.Add(f);
  }
  // Where the tool begins to speed up by a at a share s of the knot, the trapezoid errs by
  //   a dt^2 s (1 - s) / 2 <= a dt^2 / 8.
  // Such errors do not cancel: all pull up the speed behind a start, as at rest it is held at zero.
  const double bend = along.known ? t.dt * t.dt * kTrapezoid * std::abs(along.acceleration) : 0;
  const double way = 1 / (kLeastWay + bend);
  f.Begin(RowKind::kSpeed, 1);
  f.r[0] = way * (t.end.md - t.begin.md - 0.5 * t.dt * (t.begin.speed + t.end.speed));
  f.Column(depth)[0] = -way;
  f.Column(next + depth)[0] = way;
  f.Column(speed)[0] = f.Column(next + speed)[0] = -0.5 * t.dt * way;
  block.Add(f);
  const double walk = 1 / (kSpeedWalk * std::sqrt(t.dt));
  f.Begin(RowKind::kSpeed, 1);
  f.r[0] = walk * (t.end.speed - t.begin.speed);
  f.Column(speed)[0] = -walk;
  f.Column(next + speed)[0] = walk;
  block.Add(f);
}

void KnotRows::AddDrift(const Terms& t, NormalBlock& block) {
  const auto add = [&](int column, double keep, double sigma, const Vector3d& from,
                       const Vector3d& to) {
    Factor& f = factor_;
    f.Begin(RowKind::kDrift, layout_.gyros);
    f.r = (to - keep * from) / sigma;
    for (int i = 0; i < layout_.gyros; ++i) {
      f.Column(column + i) = -keep / sigma * Vector3d::Unit(i);
      f.Column(block.next() + column + i) = Vector3d::Unit(i) / sigma;
    }
    block.Add(f);
  };
  if (layout_.walk != kAbsent) {
    add(layout_.walk, 1, setup_.gyro.rate_random_walk * std::sqrt(t.dt), t.begin.walk_T,
        t.end.walk_T);
  }
  if (layout_.markov != kAbsent) {
    const double span = t.dt / *setup_.gyro.bias_instability_correlation_time;
    const double sigma = kMarkovSigmaPerInstability * setup_.gyro.bias_instability;
    add(layout_.markov, std::exp(-span), sigma * std::sqrt(-std::expm1(-2 * span)),
        t.begin.markov_T, t.end.markov_T);
  }
}

/// A clamped tool does not move in L.
void KnotRows::AddRest(const Terms& t, NormalBlock& block) {
  const double whiten = 1 / (kNothing * TurnNoise(t.dt));
  const Vector3d r = Log(t.begin.R_LT.transpose() * t.end.R_LT);
  const LogSlopes slopes(r);
  Factor& f = factor_;
  f.Begin(RowKind::kRest, 3);
  f.per_unit = whiten;
  f.r = whiten * r;
  for (int i = 0; i < 3; ++i) f.Column(layout_.phi + i) = -whiten * slopes.left.col(i);
  for (int i = 0; i < 3; ++i) {
    f.Column(block.next() + layout_.phi + i) = whiten * slopes.right.col(i);
  }
  block.Add(f);
  for (const int at : {layout_.speed, block.next() + layout_.speed}) {
    f.Begin(RowKind::kRest, 1);
    f.r[0] = (at == layout_.speed ? t.begin.speed : t.end.speed) / kRestSpeed;
    f.Column(at)[0] = 1 / kRestSpeed;
    block.Add(f);
  }
}

}  // namespace wellgyro

#include "wellgyro/estimate/knot_terms.h"

#include <cmath>

#include <Eigen/Geometry>

#include "wellgyro/estimate/roll_change.h"
#include "wellgyro/estimate/second_order.h"
#include "wellgyro/math/plane.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/math/sinc.h"

namespace wellgyro {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// The temperature's share in the errors' changes.
double WarmthOf(const EstimateSetup& setup, const RunKnot& knot) {
  if (!setup.cov_errors) return 0;
  return (static_cast<double>(knot.temperature) - setup.cov_errors->reference) /
         setup.cov_errors->span;
}

/// Errors as they stand: the border has what they are beside what is known of them.
ErrorVector ErrorsAt(const KnotModel& model, const BorderVector& border, double warmth) {
  const Layout& layout = model.layout;
  ErrorVector error = model.known;
  for (int i = 0; i < kErrorSources; ++i) {
    const int at = layout.source[static_cast<std::size_t>(i)];
    const int change = layout.change[static_cast<std::size_t>(i)];
    if (at != kAbsent) error[i] += border[at];
    if (change != kAbsent) error[i] += warmth * border[change];
  }
  return error;
}

/// The increment without what is known of the sensors' errors in psi.
void TakeWobble(KnotTerms& t) {
  t.wobble = WobbleOf(t.knot.increment);
  const PhaseErrors errors = PhaseErrorsIn(t.error, t.inc.force_M.z());
  if (!errors.isZero(0)) t.inc = WithoutWobble(t.knot.increment, t.wobble, errors);
}

/// What is fixed in the tool goes round with it: mean over the knot of e^{i psi}, of a straight psi
/// a sinc, and the integral of psi' e^{i psi}, which skewed axes see. In place of psi's own roll
/// that with what the tool turned beyond it, a radian where no gravity shows the roll.
void TurnWithTool(KnotTerms& t) {
  const double of_psi = t.inc.roll(), roll = of_psi + t.delta;
  t.fixed_beyond = Sinc(0.5 * roll) - Sinc(0.5 * of_psi);
  t.turn_by_error.middleCols<2>(kGyroBiasX) += t.dt * t.fixed_beyond * Matrix2d::Identity();
  const double skewed = 2 * (std::sin(0.5 * roll) - std::sin(0.5 * of_psi));
  t.turn_by_error.middleCols<2>(kMisalignmentX) += skewed * Matrix2d::Identity();
  const Vector2d skew(t.error[kMisalignmentX], t.error[kMisalignmentY]);
  t.skew_per_roll = -std::cos(0.5 * roll) * skew;
}

/// The turn without what is known of the errors, and what each of them makes of it.
void CorrectTurn(KnotTerms& t) {
  const Increment& inc = t.inc;
  TurnWithTool(t);
  // Of psi by the high side the gyros' turn is late against the forces; by a third axis it is with
  // the gyros, and the forces are late: see AddForce().
  const double psi_rate = (inc.roll() + t.delta) / t.dt;
  const double late = inc.has_axial ? 0 : psi_rate;
  if (inc.has_axial) {
    t.turn_by_error.col(kTimeSkew).setZero();
    t.axial_rate = psi_rate;
  } else {
    t.turn_by_error.col(kTimeSkew) += t.delta / t.dt * Vector2d(-inc.turn_M.y(), inc.turn_M.x());
  }
  for (std::size_t k = 0; k < kTurns.size(); ++k) {
    const double error = t.error[kTurns[k]];
    if (error != 0) t.turn -= error * t.turn_by_error.col(static_cast<Eigen::Index>(k));
  }
  // A toolface error `twist` rotates the measured turn by e^{i twist}. turn_by_error has the first
  // order; the cosine is the second, twist^2 / 2: of 0.05 s at 10 rpm 1.4e-3 of every turn.
  const double twist = t.error[kToolfaceOffset] + late * t.error[kTimeSkew];
  t.turn -= 0.5 * twist * twist * inc.turn_M;
  t.turn_by_error.col(kToolfaceOffset) += twist * inc.turn_M;
  t.turn_by_error.col(kTimeSkew) += late * twist * inc.turn_M;
}

}  // namespace

ErrorVector KnownErrors(const EstimateSetup& setup) {
  ErrorVector known = ErrorVector::Zero();
  known[kMisalignmentX] = setup.errors.gyro_misalignment_x;
  known[kMisalignmentY] = setup.errors.gyro_misalignment_y;
  return known;
}

KnotTerms TermsOf(const KnotModel& model, const RunKnot& knot, const KnotPlace& place,
                  const BorderVector& border, const Node& begin, const Node& end) {
  const Layout& layout = model.layout;
  KnotTerms t{.knot = knot,
              .inc = knot.increment,
              .place = place,
              .begin = begin,
              .end = end,
              .dt = knot.increment.seconds,
              .w_IL_L = place.w_IL_L,
              .border = border,
              .warmth = WarmthOf(model.setup, knot)};
  t.error = ErrorsAt(model, border, t.warmth);
  TakeWobble(t);
  const Increment& inc = t.inc;
  t.turn_by_error = TurnBy(inc);
  t.turn = inc.turn_M;
  if (layout.second_order) t.by_second_order = ForceBySecondOrder(inc);
  if (layout.latitude != kAbsent) t.w_IL_L += border[layout.latitude] * place.dw_by_latitude_L;
  double rate = begin.roll_rate;
  if (layout.swing != kAbsent) {
    t.frequency = *FrequencyOf(model.setup, layout, border);
    t.of_swing = MeanOfSwing(t.frequency, t.dt);
    rate += t.of_swing.dot(begin.swing);
  }
  t.delta = rate * t.dt - inc.roll();
  t.turn_per_roll = inc.turn_per_roll - t.delta / 12 * inc.turn_M;
  CorrectTurn(t);
  t.drift_T = 0.5 * (begin.walk_T + end.walk_T) + 0.5 * (begin.markov_T + end.markov_T);
  if (layout.ramp != kAbsent) {
    t.drift_T.head(layout.gyros) += place.since_start * border.segment(layout.ramp, layout.gyros);
  }
  t.turn -= t.turn_by_error.middleCols<2>(kGyroBiasX) * t.drift_T.head<2>();
  // Roll error delta that grows evenly over the knot: integral of e^{i delta (tau - 1/2)} over tau
  // in (0, 1), to the third order for a steady turn. The square counts where the roll was
  // unobserved and the tool turned by delta more than psi.
  t.turn += t.delta * (inc.turn_per_roll - t.delta / 24 * inc.turn_M);
  t.R_TM_begin = RotationZ(inc.roll_before + 0.5 * t.delta + place.roll_bow);
  t.R_MT_end = RotationZ(inc.roll_after + 0.5 * t.delta - place.roll_bow);
  // Up to the middle the line is behind it by delta / 4 in the mean.
  t.R_MM_half = Exp(
      Flat(inc.turn_before_M + 0.5 * (t.turn - inc.turn_M) - t.delta / 8 * QuarterTurned(t.turn)));
  t.R_LM = Exp(-0.5 * t.dt * t.w_IL_L) * begin.R_LT * t.R_TM_begin * t.R_MM_half;
  return t;
}

Vector3d ForceBy(const KnotTerms& t, int source) {
  const Increment& inc = t.inc;
  const double along = inc.force_M.z();
  switch (source) {
    case kAccelBiasX:
      return inc.ForceBy(source) + t.fixed_beyond * Vector3d::UnitX();
    case kAccelBiasY:
      return inc.ForceBy(source) + t.fixed_beyond * Vector3d::UnitY();
    case kAccelMisalignmentX:
      return inc.ForceBy(source) + t.fixed_beyond * along * Vector3d::UnitX();
    case kAccelMisalignmentY:
      return inc.ForceBy(source) + t.fixed_beyond * along * Vector3d::UnitY();
    default:
      return inc.ForceBy(source);
  }
}

Vector3d ForceOf(const KnotTerms& t, const Layout& layout, const Vector3d& by_skew_M) {
  const Increment& inc = t.inc;
  Vector3d force = inc.force_M;
  for (int i = kAccelBiasX; i <= kAccelMisalignmentZY; ++i) {
    if (t.error[i] != 0) force -= t.error[i] * inc.ForceBy(i);
  }
  for (int i = 0; layout.second_order && i < kSecondOrderSources; ++i) {
    force -= t.error[kAccelSecondOrder + i] * t.by_second_order.col(i);
  }
  return force - t.error[kTimeSkew] * by_skew_M;
}

}  // namespace wellgyro

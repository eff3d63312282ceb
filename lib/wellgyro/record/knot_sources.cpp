#include "wellgyro/record/knot_sources.h"

#include <algorithm>
#include <cmath>

namespace wellgyro {

Knot::SourceVector SourceSigmas(const ErrorPriors& errors) {
  Knot::SourceVector sigma = Knot::SourceVector::Zero();
  sigma[Knot::kMassUnbalance] = errors.mass_unbalance_sigma;
  sigma[Knot::kQuadrature] = errors.quadrature_sigma;
  sigma[Knot::kGyroScaleX] = sigma[Knot::kGyroScaleY] = errors.gyro_scale_sigma;
  sigma[Knot::kMisalignmentX] = sigma[Knot::kMisalignmentY] = errors.gyro_misalignment_sigma;
  sigma[Knot::kToolfaceOffset] = errors.roll_offset_sigma;
  sigma[Knot::kTimeSkew] = errors.time_skew_sigma;
  sigma[Knot::kAccelBiasX] = sigma[Knot::kAccelBiasY] = sigma[Knot::kAccelBiasZ] =
      errors.accel_bias_sigma;
  return sigma;
}

namespace {

// Integral over the knot of l l', l = d toolface / d source without what moves all toolfaces alike.
// The errors across the tool turn in l as u cos T + v sin T, of which the knot has the integrals of
// l cos T and l sin T; where T turns too little for these to tell u from v, l does not change.
SourceForm SquareOfLeaning(const Knot& knot, double sampled) {
  constexpr double kTurnsEnough = 0.1;
  const auto leaning = [](Knot::SourceVector d) {
    d[Knot::kToolfaceOffset] = d[Knot::kTimeSkew] = 0;
    return d;
  };
  const Knot::SourceVector c = leaning(knot.rolled_toolface.row(0).transpose());
  const Knot::SourceVector s = leaning(knot.rolled_toolface.row(1).transpose());
  const double half = std::abs(knot.roll) > 1e-9 ? std::sin(knot.roll) / knot.roll : 1;
  const std::complex<double> twice = std::polar(half, 2 * knot.toolface - knot.roll);
  const double cc = sampled / 2 * (1 + twice.real()), ss = sampled / 2 * (1 - twice.real());
  const double cs = sampled / 2 * twice.imag(), det = cc * ss - cs * cs;
  if (det < kTurnsEnough * sampled * sampled / 4) {
    const Knot::SourceVector end = leaning(knot.d_toolface);
    return sampled * end * end.transpose();
  }
  const Knot::SourceVector u = (ss * c - cs * s) / det, v = (cc * s - cs * c) / det;
  return u * c.transpose() + v * s.transpose();
}

}  // namespace

Knot::SourceVector LevelSlopes(std::complex<double> rolled, double sine, double cosine,
                               double gravity) {
  Knot::SourceVector d = Knot::SourceVector::Zero();
  d[Knot::kAccelBiasX] = cosine / gravity * rolled.real();
  d[Knot::kAccelBiasY] = -cosine / gravity * rolled.imag();
  d[Knot::kAccelBiasZ] = sine / gravity;
  return d;
}

SecondOrderShare SecondOrderOf(const Knot& knot) {
  SecondOrderShare second;
  const double sampled = knot.seconds - knot.gap_seconds;
  if (!(sampled > 0)) return second;
  const double spin = knot.roll / sampled;
  if (!knot.axial) {
    Knot::SourceVector toolface = Knot::SourceVector::Zero();
    toolface[Knot::kToolfaceOffset] = 1;
    toolface[Knot::kTimeSkew] = spin;
    const SourceForm half = 0.5 * toolface * toolface.transpose();
    second.turn = knot.turn * half;
    second.lift = knot.lift * half;
  }
  if (!knot.lifts) return second;
  const auto c = knot.rolled_toolface.row(0), s = knot.rolled_toolface.row(1);
  second.lift.row(Knot::kGyroBiasX) = -c;
  second.lift.row(Knot::kGyroBiasY) = s;
  second.lift.row(Knot::kMisalignmentX) = -spin * c;
  second.lift.row(Knot::kMisalignmentY) = spin * s;
  return second;
}

SourceForm SecondLevelOf(const Knot& knot) {
  const double sampled = knot.seconds - knot.gap_seconds;
  if (!knot.lifts || !(sampled > 0)) return SourceForm::Zero();
  // Where the toolface is read wrong, the force is seen turned with it.
  return -std::sin(knot.inclination) / 2 * SquareOfLeaning(knot, sampled);
}

VarBeyond VarBeyondOf(const Knot& knot, const ErrorPriors& priors, double gravity,
                      double horizontal) {
  constexpr double kAlike = 10;         // so long lasts what comes and goes [s]
  constexpr double kSecondAlike = 1e3;  // and what is of the second order
  constexpr double kShare = 0.1;        // of which a knot that knows it may be wrong
  const double sampled = knot.seconds - knot.gap_seconds;
  if (!(sampled > 0)) return {};
  const double sine = std::max(std::sin(knot.inclination), 1e-3);
  const double skewed = priors.gyro_misalignment_sigma * std::abs(knot.roll) / sampled;
  const double travel = knot.along.known ? knot.along.speed * skewed : 0;
  const double turns = std::abs(knot.turn) / sampled;
  if (!knot.axial) {
    const double toolface = std::hypot(priors.accel_bias_sigma, travel) / (gravity * sine);
    const double rate = skewed * toolface / 2;
    const double turn = rate / sine + turns * toolface * toolface;
    return {turn * turn * kSecondAlike * sampled, rate * rate * kSecondAlike * sampled};
  }
  if (!knot.lifts) return {};
  const double toolface = kShare * knot.d_toolface.cwiseProduct(SourceSigmas(priors)).norm();
  const double rate = skewed * toolface / 2, bends = turns * sine;
  const double comes_and_goes =
      horizontal * horizontal * knot.var_sum + bends * bends * knot.var_toolface;
  return {0, (rate * rate * kSecondAlike + 2 * kAlike * comes_and_goes) * sampled};
}

std::complex<double> RolledOver(const Knot& knot) {
  // A bias of y lifts by the integral of cos T, one of x by that of sin T.
  if (!knot.lifts) return {knot.d_lift[Knot::kGyroBiasY], knot.d_lift[Knot::kGyroBiasX]};
  return knot.rolled;
}

}  // namespace wellgyro

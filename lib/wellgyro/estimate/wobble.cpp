#include "wellgyro/estimate/wobble.h"

#include <complex>

#include "wellgyro/math/plane.h"

namespace wellgyro {
namespace {

using Complex = std::complex<double>;
using Eigen::Vector2d;
constexpr Complex kQuarterTurn(0, 1);

/// A wobble delta = -Im(u z e^{i n psi}) of psi, u = 1 and i, and what it makes of an increment:
/// what psi turns by e^{i psi} changes by i (delta - delta(middle)) of itself.
struct Harmonic {
  int n;
  Complex z;
  Complex mean;                  // of e^{i n psi}
  Complex turn_with, turn_back;  // of the rates turned by (1 + n) psi and (1 - n) psi

  void Fill(const Increment& inc, WobbleBy& by) const {
    const Complex force = ComplexOf(inc.force_M.head<2>()), turn = ComplexOf(inc.turn_M);
    const Complex begin = std::polar(1., -n * inc.roll_before),
                  end = std::polar(1., n * inc.roll_after);
    for (int k = 0; k < 2; ++k) {
      const Complex uz = (k == 0 ? Complex(1) : kQuarterTurn) * z;
      const double middle = -uz.imag();
      const Eigen::Index column = 2 * (n - 1) + k;
      by.turn_M.col(column) = VectorOf(-0.5 * (uz * turn_with - std::conj(uz) * turn_back) -
                                       kQuarterTurn * middle * turn);
      by.force_M.col(column) = VectorOf(kQuarterTurn * force * (-(uz * mean).imag() - middle));
      by.roll_before[column] = middle + (uz * begin).imag();
      by.roll_after[column] = -(uz * end).imag() - middle;
    }
  }
};

}  // namespace

PhaseErrors PhaseErrorsOf(int source, double along) {
  switch (source) {
    case kAccelBiasX:
      return {1, 0, 0, 0};
    case kAccelBiasY:
      return {0, 1, 0, 0};
    case kMisalignmentX:
      return {-along, 0, 0, 0};
    case kMisalignmentY:
      return {0, -along, 0, 0};
    case kAccelMisalignmentX:
      return {along, 0, 0, 0};
    case kAccelMisalignmentY:
      return {0, along, 0, 0};
    // f_x = (f + conj f) / 2, and i f_y = (f - conj f) / 2; the shear adds f_y + i f_x = i conj f.
    case kAccelScaleX:
      return {0, 0, 0.5, 0};
    case kAccelScaleY:
      return {0, 0, -0.5, 0};
    case kAccelShear:
      return {0, 0, 0, 1};
    default:
      return PhaseErrors::Zero();
  }
}

PhaseErrors PhaseErrorsIn(const ErrorVector& errors, double along) {
  PhaseErrors sum = PhaseErrors::Zero();
  for (const int source : kPhaseSources) sum += errors[source] * PhaseErrorsOf(source, along);
  return sum;
}

WobbleBy WobbleOf(const Increment& inc) {
  WobbleBy by;
  const Complex force = ComplexOf(inc.force_M.head<2>());
  if (!(inc.wobble_followed[0] > 0) || !(std::norm(force) > 0)) return by;
  // Turned, f_x = (G + conj(G) e^{2 i psi}) / 2.
  const Complex twice =
      (2. * ComplexOf(inc.ForceBy(kAccelScaleX).head<2>()) - force) / std::conj(force);
  const auto turned = [&](int i) { return ComplexOf(inc.turn_by_harmonic.col(i)); };
  Harmonic{1, inc.wobble_followed[0] / force, ComplexOf(inc.ForceBy(kAccelBiasX).head<2>()),
           turned(1), turned(0)}
      .Fill(inc, by);
  Harmonic{2, inc.wobble_followed[1] * std::conj(force) / force, twice, turned(3), turned(2)}.Fill(
      inc, by);
  return by;
}

Increment WithoutWobble(const Increment& increment, const WobbleBy& by, const PhaseErrors& errors) {
  Increment out = increment;
  const double before = by.roll_before * errors, after = by.roll_after * errors;
  out.roll_before -= before;
  out.roll_after -= after;
  out.turn_M -= by.turn_M * errors;
  out.force_M.head<2>() -= by.force_M * errors;
  // Skewed gyros see what their own psi turns: from end to end, (e^{i after} - e^{-i before}) / i.
  const Vector2d edge = VectorOf(-kQuarterTurn * (after * std::polar(1., increment.roll_after) +
                                                  before * std::polar(1., -increment.roll_before)));
  out.turn_by_error.col(kMisalignmentY) += edge;
  out.turn_by_error.col(kMisalignmentX) -= QuarterTurned(edge);
  return out;
}

}  // namespace wellgyro

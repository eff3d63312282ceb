#pragma once

#include <Eigen/Core>

#include "wellgyro/record/error_source.h"
#include "wellgyro/record/increment.h"

namespace wellgyro {

/// What of the sensors' errors turns the phase of gravity: e, a force fixed in T (x, y) [m/s^2],
/// and q, by which conj(f) adds to f (real, imaginary). Of f = G e^{-i psi}, psi errs by
///   delta = -Im[(h1 e e^{i psi} + h2 q conj(G) e^{2 i psi}) / G],
/// h the shares that psi follows (Increment::wobble_followed). Skewed gyros (m) make a steady roll
/// look as a circle of the axis, of which the phase is freed: e is f_z times the accelerometers'
/// misalignment less the gyros'. Linear in delta: its square, of an error a tenth of gravity across
/// .005, is left out.
using PhaseErrors = Eigen::Vector4d;

/// The sources that do; the accelerometers' second order is left out.
inline constexpr int kPhaseSources[] = {kMisalignmentX,      kMisalignmentY,      kAccelBiasX,
                                        kAccelBiasY,         kAccelScaleX,        kAccelScaleY,
                                        kAccelMisalignmentX, kAccelMisalignmentY, kAccelShear};
/// What a unit of one of them is, `along` being the force along the axis [m/s^2].
PhaseErrors PhaseErrorsOf(int source, double along);
/// Of all of them.
PhaseErrors PhaseErrorsIn(const ErrorVector& errors, double along);

/// d increment / d PhaseErrors.
struct WobbleBy {
  Eigen::Matrix<double, 2, 4> turn_M = Eigen::Matrix<double, 2, 4>::Zero();
  Eigen::Matrix<double, 2, 4> force_M = Eigen::Matrix<double, 2, 4>::Zero();
  Eigen::RowVector4d roll_before = Eigen::RowVector4d::Zero();
  Eigen::RowVector4d roll_after = Eigen::RowVector4d::Zero();
  Eigen::RowVector4d roll() const { return roll_before + roll_after; }
  /// By how much the middle lies behind a line from begin to end.
  Eigen::RowVector4d bow() const { return 0.5 * (roll_after - roll_before); }
};
WobbleBy WobbleOf(const Increment& increment);

/// The increment as it were of a psi without these errors.
Increment WithoutWobble(const Increment& increment, const WobbleBy& by, const PhaseErrors& errors);

}  // namespace wellgyro

#pragma once

#include <complex>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/record/knot.h"
#include "wellgyro/record/noise.h"

namespace wellgyro {

/// 1-sigma prior of every constant error that a knot knows, in its unit. Zero for the two gyro
/// biases: what they are takes the noise coefficients too.
WELLGYRO_EXPORT Knot::SourceVector SourceSigmas(const ErrorPriors& errors);

/// What d_lift and the sensitivities of inclination_accel leave out of an axial knot that lifts:
/// with e the errors, lift has e' lift e more, the integral of the accelerometers' inclination over
/// the knot e' level e [SI]. An error across the tool turns with it, as does the error of toolface
/// that it makes, and their product does not.
struct SecondOrder {
  using Form = Eigen::Matrix<double, Knot::kSources, Knot::kSources>;
  Form lift = Form::Zero(), level = Form::Zero();
};
WELLGYRO_EXPORT SecondOrder SecondOrderOf(const Knot& knot, double gravity);

/// Variance of the lift that neither noise nor the sensitivities hold, as if it were white. Of the
/// second order: axes that are skewed turn with a rolling tool, and so does the error of toolface
/// that the accelerometers make, in `priors`; of an axial knot, which knows its second order, a
/// share of that. Of an axial knot also what comes and goes in its azimuth and its toolface.
/// `horizontal`: the Earth's rate across [rad/s].
WELLGYRO_EXPORT double VarLiftBeyond(const Knot& knot, const ErrorPriors& priors, double gravity,
                                     double horizontal);

/// Integral of e^{iT} over the knot [s].
WELLGYRO_EXPORT std::complex<double> RolledOver(const Knot& knot);

}  // namespace wellgyro

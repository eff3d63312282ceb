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

/// Integral of e^{iT} over the knot [s].
WELLGYRO_EXPORT std::complex<double> RolledOver(const Knot& knot);

/// d(accelerometers' inclination) / d source, by their biases. `rolled`: the mean of e^{iT}; sine
/// and cosine of the inclination.
WELLGYRO_EXPORT Knot::SourceVector LevelSlopes(std::complex<double> rolled, double sine,
                                               double cosine, double gravity);

/// e' F e, of the errors e of all sources.
using SourceForm = Eigen::Matrix<double, Knot::kSources, Knot::kSources>;

/// What d_turn and d_lift, which hold where the readings stand, leave out: with e the errors, turn
/// has e' turn e more, lift e' lift e [SI]. A toolface that is off by a time skew sees less of how
/// the hole turns. Of an axial knot that lifts: an error across the tool turns with it, as does the
/// error of toolface that it makes, and their product does not; of other axial knots nothing is
/// known.
struct SecondOrderShare {
  SourceForm turn = SourceForm::Zero(), lift = SourceForm::Zero();
};
WELLGYRO_EXPORT SecondOrderShare SecondOrderOf(const Knot& knot);

/// Likewise of the integral of the accelerometers' inclination over a knot that lifts [rad s].
WELLGYRO_EXPORT SourceForm SecondLevelOf(const Knot& knot);

/// Variances that neither noise nor the sensitivities hold, as if they were white [rad^2].
struct VarBeyond {
  double turn = 0, lift = 0;
};
/// Of the second order in `priors`: axes that are skewed turn with a rolling tool, and so does the
/// error of toolface that the accelerometers make; of an axial knot that lifts, which knows its
/// second order, a share of that. Of such a knot also what comes and goes in its azimuth and its
/// toolface. `horizontal`: the Earth's rate across [rad/s]. The turn of an axial knot is its own.
WELLGYRO_EXPORT VarBeyond VarBeyondOf(const Knot& knot, const ErrorPriors& priors, double gravity,
                                      double horizontal);

}  // namespace wellgyro

#pragma once

#include <Eigen/Core>

#include "wellgyro/attitude/station_state.h"
#include "wellgyro/estimate/run_estimate.h"
#include "wellgyro/record/attitude_sample.h"
#include "wellgyro/record/noise.h"
#include "wellgyro/record/run_knot.h"

namespace wellgyro {

/// Inclination, azimuth and toolface at the end of `knot`, where the attitude R_LT Exp(phi) has
/// this covariance [rad^2]. An azimuth vaguer than kVagueAngle says that the hole is vertical as
/// far as is known; one vaguer than the circle knows nothing.
AttitudeSample AttitudeOf(const RunKnot& knot, const Eigen::Matrix3d& R_LT,
                          const Eigen::Matrix3d& cov_phi_T);

/// Of a run without north: inclination and toolface by what gravity says of the knot's middle.
AttitudeSample LevelOf(const RunKnot& knot, const ErrorPriors& errors, double gravity);

/// Of a run whose heading is not known: its axis has a direction only where the hole hardly leans.
void ForgetAzimuth(AttitudeSample& attitude);

/// The state of the station at the end of knot `index`.
StationState StateOf(std::size_t index, const RunKnot& knot, const AttitudeSample& attitude,
                     const Eigen::Matrix3d& R_LT, const LinkedErrors& errors);

/// The same where nothing but gravity tells an attitude.
StationState StateOf(std::size_t index, const RunKnot& knot, const AttitudeSample& level);

}  // namespace wellgyro

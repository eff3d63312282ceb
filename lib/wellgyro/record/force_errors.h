#pragma once

#include <Eigen/Core>

#include "wellgyro/record/noise.h"

namespace wellgyro {

inline constexpr int kForceErrors = 11;

/// What the constant errors of accelerometers, 1 sigma each and independent, add to a force `f`
/// that they read [m/s^2], in T or any frame turned from it about its axis alone: biases, scales,
/// axes that lean towards the other two. Near vertical an axis across that leans by 1e-4 rad reads
/// as much as one with a bias of 1e-3 m/s^2.
///
/// x and y lean towards each other by two angles: half of their sum shears, and stands here; half
/// of their difference turns T, which is the accelerometers' frame, see ToolfaceOffsetSigma().
Eigen::Matrix<double, 3, kForceErrors> ForceErrors(const ErrorPriors& errors,
                                                   const Eigen::Vector3d& f);
double ShearSigma(const ErrorPriors& errors);  ///< of that half [rad]

/// Of the gyros' axes across the tool against T [rad].
double ToolfaceOffsetSigma(const ErrorPriors& errors);

}  // namespace wellgyro

#pragma once

#include <optional>

#include <Eigen/Core>

#include "wellgyro/base/export.h"

namespace wellgyro {

/// Slow and white errors of one rate sensor, in the terms of IEEE 952. Units are those of a rate in
/// rad/s; any other quantity that is integrated over time serves as well.
struct DriftCoefficients {
  double angle_random_walk = 0;  ///< N, white noise [rad/sqrt(s)]
  double constant = 0;           ///< 1-sigma of a constant bias [rad/s]
  double bias_instability = 0;   ///< B [rad/s]
  /// Of B as a first-order Gauss-Markov process [s]; absent, B is a constant like the other.
  std::optional<double> correlation_time;
  double rate_random_walk = 0;  ///< K [rad/s/sqrt(s)]
  double rate_ramp = 0;         ///< R, 1-sigma of a constant slope [rad/s^2]
};

/// Where things stand in the drift's state: the integral of gain x rate, then the rate's parts. The
/// rate is level + Markov (+ white); the level gathers constant, random walk and ramp.
enum DriftState { kDriftIntegral, kDriftLevel, kDriftMarkov, kDriftRamp };

/// x(t + dt) = transition x(t) + noise of covariance `noise`.
struct DriftStep {
  Eigen::Matrix4d transition = Eigen::Matrix4d::Identity();
  Eigen::Matrix4d noise = Eigen::Matrix4d::Zero();
};

/// The standard deviation of a Gauss-Markov process whose Allan deviation has the same maximum as a
/// flicker floor 0.6643 B: sigma = 1.0760 B (with the maximum at 1.89 correlation times).
inline constexpr double kMarkovSigmaPerInstability = 1.0760;

/// Exact over `seconds` >= 0 while the gain [1] is constant: steps may be split at will. With a
/// zero gain the rate goes on and the integral rests. Throws std::domain_error when seconds is
/// negative or the correlation time is not positive.
WELLGYRO_EXPORT DriftStep DriftOver(const DriftCoefficients& drift, double gain, double seconds);

/// Covariance when the sensor starts; the integral is zero there.
WELLGYRO_EXPORT Eigen::Matrix4d DriftPrior(const DriftCoefficients& drift);

}  // namespace wellgyro

#pragma once

#include <optional>

/// @file
/// Noise coefficients of a sensor, and priors of a tool's other errors.
namespace wellgyro {

/// One sensor's noise coefficients, as IEEE 952 names them.
///
/// The Allan variance at averaging time tau is
///
/// ```
/// 3 Q^2/tau^2 + N^2/tau + (2 ln2/pi) B^2 + K^2 tau/3 + R^2 tau^2/2
/// ```
///
/// A term that is absent is zero here; whether it was measured as unobservable stands in its file.
struct NoiseCoefficients {
  double quantization = 0;       ///< Q [rad]
  double angle_random_walk = 0;  ///< N [rad/sqrt(s)]
  double bias_instability = 0;   ///< B [rad/s]
  double rate_random_walk = 0;   ///< K [rad/s/sqrt(s)]
  double rate_ramp = 0;          ///< R [rad/s^2]
  /// Correlation time of B as a Gauss-Markov process [s]; absent, B is a constant.
  std::optional<double> bias_instability_correlation_time = {};
};

/// What Allan coefficients do not carry: 1-sigma priors of a tool's other errors. Zero: none.
struct ErrorPriors {
  double gyro_bias_sigma = 0;           ///< per axis [rad/s]
  double mass_unbalance_sigma = 0;      ///< [rad/s per m/s^2]
  double quadrature_sigma = 0;          ///< [rad/s per m/s^2]
  double gyro_scale_sigma = 0;          ///< [1]
  double gyro_misalignment_sigma = 0;   ///< z into x and y [rad]
  double accel_bias_sigma = 0;          ///< per axis [m/s^2]
  double accel_scale_sigma = 0;         ///< per axis [1]
  double accel_misalignment_sigma = 0;  ///< of each axis towards each other [rad]
  double accel_noise = 0;               ///< [m/s^2/sqrt(Hz)]
  double roll_offset_sigma = 0;         ///< accelerometers against gyros about z [rad]
  double time_skew_sigma = 0;           ///< accelerometers against gyros [s]
  double depth_sigma = 0;               ///< [m]
  double depth_scale_sigma = 0;         ///< [1]
  double latitude_sigma = 0;            ///< [rad]
  /// What two gyros across the hole are known to see of the third axis, x and y: the misalignment's
  /// sigma is about it [rad].
  double gyro_misalignment_x = 0, gyro_misalignment_y = 0;
};

}  // namespace wellgyro

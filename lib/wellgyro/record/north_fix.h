#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "wellgyro/base/time.h"
#include "wellgyro/record/quality.h"

/// @file
/// North found, or given, at one stop.
namespace wellgyro {

/// The tool's attitude at one stop, north found from the Earth's rotation or given from outside.
struct NorthFix {
  ToolTime begin, end;  ///< of the window or windows it rests on
  UtcTime utc_begin, utc_end;
  std::int64_t seq_begin = 0;
  std::int64_t seq_end = 0;  ///< exclusive
  std::int32_t run = 0;
  std::int32_t tool = 0;
  std::optional<double> md;  ///< measured depth [m]
  bool external = false;     ///< the azimuth was given, not found
  bool from_samples = true;  ///< false: a window that the tool averaged itself
  double azimuth = 0;        ///< true azimuth of the tool axis [rad]
  double inclination = 0;    ///< [rad]
  double toolface = 0;       ///< from the high side to the reference mark [rad]
  /// Covariance of (inclination, azimuth, toolface) [rad^2].
  Eigen::Matrix3d cov_attitude = Eigen::Matrix3d::Zero();
  /// Azimuth of the axis, clockwise from magnetic north, where the tool has magnetometers [rad].
  /// Compared with `azimuth`, and never in it.
  std::optional<double> magnetic_azimuth;
  /// Second minimum of the cost, kept whenever the data cannot exclude it; where the two have run
  /// into one, `azimuth` lies between and its variance covers both. True azimuth [rad].
  std::optional<double> mirror_azimuth;
  double mirror_cost = 0;  ///< cost of the mirror less cost of the solution, chi-square units
  /// Chi-square of one degree of freedom of the azimuth against the adjusted run without it, before
  /// that against what was known when it came; absent where that tells no azimuth.
  std::optional<double> chi_square;
  /// The same as an angle, and its sigma [rad].
  double closure = 0, sigma_closure = 0;
  /// Biases of the gyros x and y as this stop alone tells them, whatever their prior; absent where
  /// it does not. With their sigmas [rad/s].
  std::optional<Eigen::Vector2d> gyro_bias;
  Eigen::Vector2d sigma_gyro_bias = Eigen::Vector2d::Zero();
  /// Rate of the toolface at rest, in the window where it is most for its sigma [rad/s].
  std::optional<double> roll_rate;
  double sigma_roll_rate = 0;  ///< [rad/s]
  int roll_windows = 1;        ///< that tell one, of which this is the most
  double gravity = 0;          ///< measured |f| [m/s^2]
  double gravity_ref = 0;      ///< of the Earth model at the place [m/s^2]
  double sigma_gravity = 0;    ///< [m/s^2]
  /// Rate at rest against the Earth's, in the direction the axes can still see [rad/s].
  std::optional<double> earth_rate;
  double earth_rate_ref = 0;    ///< [rad/s]
  double sigma_earth_rate = 0;  ///< [rad/s]
  Quality quality = Quality::kGood;
};

}  // namespace wellgyro

#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/time.h"
#include "wellgyro/record/noise.h"

/// @file
/// The tool model: from its converters' counts to SI units in tool axes.
namespace wellgyro {

/// A thermometer: t = offset + gain raw is what it reads, T = t + c0 + c1 t + c2 max(0, t - knee)^2
/// what is true.
struct ThermometerCalibration {
  int channel = 0;       ///< place in RawSample::temperature_raw
  double offset = 0;     ///< [degC]
  double gain = 1;       ///< [degC per unit of the channel]
  double c0 = 0;         ///< [degC]
  double c1 = 0;         ///< [1]
  double c2 = 0;         ///< [1/degC]
  double knee = 0;       ///< [degC]
  double min = -273.15;  ///< calibrated from here, as read [degC]
  double max = 1e3;      ///< to here [degC]
};

/// Estimated parameters of one group of sensors and how well they are known.
struct ParameterCovariance {
  std::vector<std::string> names;  ///< and units, as the calibration's [result] has them
  Eigen::MatrixXd cov;             ///< in those units, squared
};

/// Sensors of one kind, two to four channels that sense one vector u: the rate, the specific force
/// or the flux density.
///
/// Channel c gives, in its own unit (volt, pulses a second, deg/h ...),
///
/// ```
/// v_c = count_c unit_per_count_c           (divided by the period of the sample where per_second)
///     = b_c(tau) + S_c(tau) u + K_c q(u) + G_c(tau) f + N_c q(f) + h_c dT/dt
/// ```
///
/// with q(a) = (ax^2, ay^2, az^2, ax ay, ay az, az ax), u and f (the specific force) in the
/// sensors' axes, and tau = (T - reference) / half_range. b, S and G are polynomials in tau, their
/// power n in element n. Outside [min, max] tau stays at the end of the range.
struct SensorGroup {
  static constexpr int kChannels = 4;
  static constexpr int kPowers = 4;
  using Column = Eigen::Vector4d;
  using Rows = Eigen::Matrix<double, kChannels, 3>;
  using Squares = Eigen::Matrix<double, kChannels, 6>;

  int n_channels = 0;                      ///< 0: the tool has none; else 2 to 4
  std::array<int, kChannels> channel{};    ///< places in RawSample::counts
  Column unit_per_count = Column::Ones();  ///< [unit per count]
  std::string unit = "count";              ///< what the channels read, for people
  bool per_second = false;                 ///< the channel counts pulses
  std::array<Column, kPowers> bias{Column::Zero(), Column::Zero(), Column::Zero(),
                                   Column::Zero()};  ///< b [unit]
  std::array<Rows, kPowers> sensitivity{Rows::Zero(), Rows::Zero(), Rows::Zero(),
                                        Rows::Zero()};  ///< S [unit per SI unit]
  Squares second_order = Squares::Zero();               ///< K [unit per SI unit^2]
  std::array<Rows, kPowers> g_dependence{Rows::Zero(), Rows::Zero(), Rows::Zero(),
                                         Rows::Zero()};  ///< G, gyros [unit per m/s^2]
  Squares g_squared = Squares::Zero();                   ///< N, gyros [unit per (m/s^2)^2]
  Column heating = Column::Zero();                       ///< h [unit per degC/s]
  double heating_lag = 60;  ///< [s]; dT/dt = (T - lagged T) / lag, lagged T' = dT/dt

  /// Axes of the sensors in T: u_T = R_TS u_S. A signed permutation or rotation; of determinant -1
  /// where the sensors give gravity in place of specific force.
  Eigen::Matrix3d R_TS = Eigen::Matrix3d::Identity();

  int thermometer = -1;   ///< of ToolCalibration::thermometers; -1: temperature plays no part
  double reference = 20;  ///< [degC]
  double half_range = 1;  ///< [degC]
  double min = -273.15;   ///< calibrated from here, true temperature [degC]
  double max = 1e3;       ///< to here [degC]

  std::optional<ParameterCovariance> covariance;
};

/// What stands between a tool's converters and SI units in tool axes T: the tool model.
struct ToolCalibration {
  std::string asset_serial;
  std::string sensor_serials;         ///< separated by ;
  std::string note;                   ///< how it was made
  std::optional<UtcTime> calibrated;  ///< when
  std::optional<UtcTime> expires;     ///< from then on no longer to be relied on
  bool rests_on_prior = false;        ///< holds what another calibration or runs found as well
  /// SHA-256 of the readings that its covariance rests on: files of the bench, samples of runs.
  std::vector<std::string> rests_on;
  std::vector<ThermometerCalibration> thermometers;
  SensorGroup gyro;                      ///< SI unit rad/s; two channels: across the tool only
  SensorGroup accel;                     ///< SI unit m/s^2
  SensorGroup mag;                       ///< SI unit T; absent where the tool has none
  std::optional<ErrorPriors> errors;     ///< what remains of errors after it, 1-sigma
  std::vector<std::string> errors_none;  ///< of these the keys that are 0 because someone said so
};

}  // namespace wellgyro

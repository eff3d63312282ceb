#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/base/units.h"
#include "wellgyro/calibration/bench_table.h"
#include "wellgyro/calibration/fit_report.h"
#include "wellgyro/calibration/tool_update.h"
#include "wellgyro/fit/bench_reference.h"
#include "wellgyro/fit/gyro_fit.h"

namespace wellgyro {

/// What is known of the bench before its readings, 1-sigma; sigmas of readings that are absent are
/// found from their scatter.
struct ToolFitSetup {
  BenchReference reference;                ///< gravity; the latitude is needed for gyros
  std::optional<GyroForceModel> force;     ///< as GyroFitSetup's
  double sigma_level = 0.5 * units::kDeg;  ///< of a bench's tilt, each direction [rad]
  double sigma_north = 1 * units::kDeg;    ///< of its north [rad]
  /// Of a stand's zero of inclination, which moves all of a table: as a dial is set [rad].
  double sigma_inclination = 0.05 * units::kDeg;
  double sigma_latitude = 6e-4 * units::kDeg;  ///< [rad]: 67 m
  /// Of the tool on the rate table, each direction [rad].
  double sigma_axis = 60 * units::kArcsec;
  /// Of the scale of a rate table's rates, common to all its rows. Tables for inertial sensors are
  /// told from others by a rate stable within 0.05 % (Missile Technology Control Regime, annex,
  /// 9.B.2.c), of a uniform distribution between these bounds (JCGM 100:2008, 4.3.7). A latitude
  /// 0.01 deg off is as much at 60 deg: that a table checks it finer, its scale must be known
  /// finer.
  double sigma_rate_scale = 2.9e-4;
  /// Of a gyro from the middle to the end of a table [deg/h]; it may bend by as much as a walk
  /// does.
  double sigma_drift = 0.1;
  /// Of an accelerometer's second order where the positions do not tell it [gravity per gravity^2].
  /// Micromachined ones are off a line by 0.5 % of 8 g, K2 (8 g)^2 / 2 (data sheet of the ADXL350);
  /// servo accelerometers of quartz, some 3e-5, are to be stated so.
  double sigma_second_order = 1.25e-3;
  /// Of a gyro's anisoelasticity where the positions do not tell it [deg/h per gravity^2]: 0.1 to
  /// 0.3 of dynamically tuned gyros (Titterton and Weston, Strapdown Inertial Navigation
  /// Technology, 2004, ch. 4).
  double sigma_anisoelastic = 0.3;
  std::optional<double> sigma_wobble;      ///< of each reading's attitude, about each axis [rad]
  std::optional<double> sigma_accel;       ///< of a reading [its unit]
  std::optional<double> sigma_gyro;        ///< of a reading at rest [its unit]
  std::optional<double> sigma_gyro_table;  ///< of a reading on the rate table [its unit]
  int max_degree = 3;                      ///< of biases in temperature
};

/// Something of the bench, not of the tool.
struct BenchNuisance {
  std::string name;
  double value = 0, sigma = 0, prior_sigma = 0;  ///< [unit]; sigma near the prior's: not seen
  std::string unit;
};

/// Terms that the readings do not ask for.
struct LeftOutTerm {
  std::string name;
  double bound = 0;  ///< its largest coefficient lies below, 95 %; [the data's unit]
  bool seen = true;  ///< false: these readings cannot tell
};

/// "accel_hysteresis: below 1.2e-05".
WELLGYRO_EXPORT std::string TextOf(const LeftOutTerm& term);

struct ToolFit {
  BenchCalibration calibration;
  /// Values and covariance of everything that the tool model takes over, under the names and in the
  /// units of CalibrationMember (calibration/members.h).
  ParameterCovariance members;
  CovarianceParts members_by_source;  ///< members.cov
  Eigen::VectorXd member_values;
  std::vector<BenchNuisance> nuisances;
  std::vector<LeftOutTerm> left_out;
};

/// All bench data of a tool in one adjustment: tables of positions (inc, az, tf [deg], Gx.. or fx..
/// or vx.. and m_x1 .., in any order of attitudes and temperatures) and of a rate table (axis,
/// rate_deg_s, m_x1 ..), with T_C [degC] and t_s [s] where they were written down.
///
/// Channels as in SensorGroup, their polynomials in temperature, second order, force, heating and
/// hysteresis terms (a loop that heating and cooling open, not corrected by the tool model: its
/// size is in the biases' covariance). A term that the readings do not tell from the others is one
/// of size zero to a sigma of such terms of published sensors, or, of a power of the temperature,
/// as large as the power below it, so that what it does to the others is in their covariance. Of
/// the bench: level, north and zero of inclination of each
/// table, its drift in time, the tool's seat on the rate table, the latitude, each with its prior;
/// the wobble of every reading, which moves all channels together, is marginalised, its size found.
/// Terms are chosen by marginal likelihood, each bundle's prior variance found from it, at 1 %
/// against noise alone; other terms that explain nearly as much are told. What was left out may be
/// there, of even odds before the readings, and no larger than noise hides: everything is taken at
/// its mean over both, so that a term that is left out has a small value, and its doubt is in the
/// covariance. Outliers are found with Cauchy's loss (Ceres) and left out.
WELLGYRO_EXPORT Result<ToolFit> FitTool(std::span<const BenchTable> tables,
                                        const ToolFitSetup& setup);

/// Takes the joint fit into the tool model: both groups, the covariance of their members (in the
/// gyros' group where there are any) and the errors that it leaves (ErrorsLeft). `update.channels`
/// and `unit_per_count` name the accelerometers' and behind them the gyros'. Throws
/// std::invalid_argument when a list has another length.
WELLGYRO_EXPORT ToolCalibration Updated(ToolCalibration tool, const ToolFit& fit,
                                        const ToolUpdate& update);

}  // namespace wellgyro

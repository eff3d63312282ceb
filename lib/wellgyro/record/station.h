#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/base/time.h"
#include "wellgyro/record/quality.h"

/// @file
/// One survey station.
namespace wellgyro {

/// What a station rests on. Values are those of survey_station_t.
enum class StationKind : std::int32_t { kTieIn = 0, kGyrocompass = 1, kContinuous = 2, kStill = 3 };
/// How far a station is to be relied on. Values are those of survey_station_t.
enum class StationStatus : std::int32_t {
  kProvisional = 0,
  kField = 1,
  kDefinitive = 2,
  kRejected = 3,
  kSuperseded = 4,
};
/// A run holds passes; the number is that of survey_station_t.run_pass.
enum class Pass : std::int32_t { kStationary = 0, kIn = 1, kOut = 2, kRepeat = 3 };

/// One survey station: where the hole points, H's attitude, at one measured depth.
struct Station {
  std::int32_t run = 0;
  Pass pass = Pass::kStationary;
  std::int32_t pass_number = 0;  ///< counts the run's passes from 1, in time
  std::int32_t number = 0;       ///< in the survey, from 1
  std::int32_t revision = 0;     ///< counts up each time the station is sent again
  std::int32_t tool = 0;
  StationStatus status = StationStatus::kProvisional;
  StationKind kind = StationKind::kContinuous;
  Quality quality = Quality::kGood;
  UtcTime utc;  ///< when the tool was there
  ToolTime tool_time;
  double md = 0;  ///< measured depth [m]
  /// The hole's unit tangent (sin I cos A, sin I sin A, cos I).
  Eigen::Vector3d tangent_L = Eigen::Vector3d::UnitZ();
  /// Covariance of the tangent [rad^2]: no variance along it, so that its rank is two, and regular
  /// at every inclination. Of an unfit station, whose direction is not known, that of an unknown
  /// angle in all directions: rank three.
  Eigen::Matrix3d cov_tangent_L = Eigen::Matrix3d::Zero();
  double inclination = 0;  ///< I of the tangent [rad]; this, A and their covariance: DeriveAngles()
  double azimuth = 0;      ///< A, true [rad], [0, 2 pi); that of the tool where I is 0
  double toolface = 0;     ///< of the tool, high side to reference mark [rad]
  /// Covariance of (md, inclination, azimuth) [m, rad]: as written, at the edge. Near vertical an
  /// azimuth has no sigma that means much; what is known of the direction there is in
  /// `cov_tangent_L`.
  Eigen::Matrix3d cov_md_inc_azi = Eigen::Matrix3d::Zero();
  Eigen::Vector3d p_WT_W = Eigen::Vector3d::Zero();      ///< north, east, TVD in the well frame [m]
  Eigen::Matrix3d cov_p_WT_W = Eigen::Matrix3d::Zero();  ///< [m^2]
  double dogleg_severity = 0;                            ///< over the leg that ends here [rad/m]
  double gravity = 0;                                    ///< measured [m/s^2]; 0 where not
  double gravity_ref = 0;                                ///< [m/s^2]
  std::optional<double> earth_rate;                      ///< see NorthFix [rad/s]
  double earth_rate_ref = 0;                             ///< [rad/s]
  std::int64_t imu_seq_begin = 0;                        ///< the samples it rests on
  std::int64_t imu_seq_end = 0;                          ///< exclusive
  std::int64_t samples_lost = 0;                         ///< in that range
};

/// The edge at which a direction becomes angles: inclination, azimuth and their covariance of the
/// tangent and of its C, by e_I = dt/dI and e_A = dt/dA / sin I,
///   var I = e_I' C e_I,  var A = e_A' C e_A / sin^2 I,
/// to first order. An azimuth's variance is never more than pi^2/3, that of no knowledge at all,
/// and then goes with nothing. Vertical has no azimuth: there it is `azimuth_at_vertical` [rad].
WELLGYRO_EXPORT void DeriveAngles(double azimuth_at_vertical, Station& station);

/// The reverse, for a station that comes as angles: a message's or a listing's.
WELLGYRO_EXPORT void DeriveTangent(Station& station);

}  // namespace wellgyro

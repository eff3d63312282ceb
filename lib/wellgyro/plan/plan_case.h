#pragma once

#include <optional>
#include <span>
#include <vector>

#include "wellgyro/earth/earth.h"
#include "wellgyro/record/noise.h"
#include "wellgyro/trajectory/trajectory.h"

namespace wellgyro {

/// To which times at rest are found [s]: nobody stops to the second, and of 180 s it is 3 % in
/// sigma.
inline constexpr double kStopGrain = 10;

/// Ranges of what a plan is asked for.
namespace plan_range {
inline constexpr double kWayMost = 20'000;  ///< past the longest well drilled [m]
/// [m/s]: slower, a kilometre takes more than 5.6 h; faster is a jump to DepthTrack (speed_limit).
inline constexpr double kSlowest = 0.05, kFastest = 10;
inline constexpr double kRollMostRpm = 60;
inline constexpr double kSwingMostDeg = 360;
inline constexpr double kSwingPeriodLeast = 60;   ///< fifteen knots of KnotLength::seconds [s]
inline constexpr double kStopLeast = kStopGrain;  ///< that is sought [s]
inline constexpr double kStopMost = 7200;         ///< that is sought: eight times the usual [s]
inline constexpr double kStandMost = 86'400;      ///< that is stated: a day [s]
}  // namespace plan_range

/// How the tool is to go through the well: down from `begin_md` to `end_md`, and up again.
struct PlannedWay {
  double begin_md = 0, end_md = 0;  ///< of the sensor point [m]
  double speed_in = 0.8;            ///< [m/s]
  double speed_out = 0.8;           ///< 0: what comes after the deepest point is not surveyed [m/s]
  double roll_rate = 0;             ///< of the moving tool about its axis; 0: it slides [rad/s]
  double swing = 0.4;               ///< amplitude by which a sliding tool swings about it [rad]
  double swing_period = 900;        ///< [s]
  double toolface = 0.7;            ///< at the begin, or from north where that is vertical [rad]
};

/// The tool at rest.
struct PlannedStop {
  bool out = false;    ///< on the way up
  double md = 0;       ///< [m]
  double seconds = 0;  ///< [s]
  /// Turned to before, and back after it, so that a stop changes nothing but by what it measures;
  /// absent: as it comes [rad].
  std::optional<double> toolface = {};
};

/// How long a knot of the moving tool may be where a run is reckoned: on smooth wells the end's
/// covariance is that of 1 s knots within 1 %.
struct KnotLength {
  double seconds = 4;
  double roll = 0.6;  ///< of the tool about its axis [rad]
};
/// Of live advice, which is to be quick: within 2 %.
inline constexpr KnotLength kAdviceKnots{.seconds = 12, .roll = 1.6};

/// What a plan rests on.
struct PlanCase {
  Trajectory well;         ///< true azimuths
  Site site;               ///< of its origin
  NoiseCoefficients gyro;  ///< of every axis
  ErrorPriors errors;
  bool third_axis = false;
  PlannedWay way;
  /// An azimuth told at the begin, 1-sigma [rad]; absent: the run finds north by itself.
  std::optional<double> sigma_start_azimuth = {};
};

/// Stops every `spacing` on the way down from the begin, and one at the end, `seconds` each.
std::vector<PlannedStop> Practice(const PlannedWay& way, double spacing, double seconds);

/// Throws std::invalid_argument, naming the field and the value, where the case makes no sense:
/// depths that the well has not, speeds that are not positive, no noise, a stop off the way.
void CheckPlanCase(const PlanCase& c, std::span<const PlannedStop> stops);

}  // namespace wellgyro

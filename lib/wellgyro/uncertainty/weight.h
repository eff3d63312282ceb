#pragma once

#include <optional>
#include <span>
#include <string_view>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/base/units.h"

namespace wellgyro {

enum class GyroAxes { kXyz, kXy, kZ };

/// What the magnitude of a term is, and so in which SI unit it is held.
enum class Dimension {
  kLength,            ///< [m]
  kRatio,             ///< [1]
  kPerLength,         ///< [1/m]
  kAcceleration,      ///< [m/s^2]
  kAccelerationPerG,  ///< at 1 g [m/s^2]
  kAngle,             ///< [rad]
  kRate,              ///< [rad/s]
  kRatePerG,          ///< at 1 g [rad/s]
  kAngleWalk,         ///< [rad/sqrt(s)]
  kRateWalk,          ///< [rad/s/sqrt(s)]
  kRateRamp,          ///< [rad/s^2]
  kField,             ///< [T]
  kAngleField,        ///< [rad T]
};

/// What a weight needs from the model, the place or the mode of the tool, beside the station.
enum class WeightRole {
  kPlain,            ///< nothing
  kCantedAccel,      ///< the cant of the x accelerometer
  kMagnetic,         ///< field and dip
  kShortCourse,      ///< Lmin
  kCourse,           ///< the tortuosity; gives a position error at once
  kStationary,       ///< a gyrocompass fix: live at rest, carried in a continuous section
  kStationaryNoise,  ///< the same, averaged when initialising
  kDrift,            ///< time in the continuous section
  kWalk,             ///< square root of it
  kRateWalk,         ///< root of the sum of a third of its cubes, leg by leg
  kRamp,             ///< sum of half its squares, leg by leg
  kExternal,         ///< an azimuth brought to the tool
  kExternalAtTie,    ///< the same, with the inclination of the first station
};

/// Everything a weighting function is a function of, at one station.
struct WeightPlace {
  double md = 0, tvd = 0;           ///< [m]
  double course = 0;                ///< MD since the station before [m]
  double inclination = 0;           ///< [rad]
  double previous_inclination = 0;  ///< [rad]
  double sin_inc = 0, cos_inc = 1;
  double sin_azi = 0, cos_azi = 1;    ///< true azimuth
  double sin_mag = 0, cos_mag = 1;    ///< magnetic azimuth
  double sin_hole = 0, cos_hole = 1;  ///< azimuth in the survey's own frame
  double azimuth_change = 0;          ///< since the station before [rad]; 0 from a vertical one
  double sin_convergence = 0, cos_convergence = 1;  ///< true = survey azimuth + convergence
  double horizontal_earth_rate = 1;                 ///< [rad/s]
  double cos_latitude = 1, tan_latitude = 0;
  double gravity = units::kStandardGravity;  ///< [m/s^2]
  double horizontal_field = 1;               ///< [T]
  double tan_dip = 0;
  double cant = 0;                ///< [rad]
  double min_course_length = 0;   ///< [m]
  double tortuosity = 0;          ///< [rad/m]
  double tie_sin_inc = 0;         ///< at the first station
  std::span<const double> named;  ///< for formula_weight.h, where the model has formulas
};

/// Error of (measured depth, inclination, azimuth) for a unit of the magnitude.
struct Weights {
  double md = 0, inclination = 0, azimuth = 0;
};

/// A weighting function under its published code.
struct WeightFunction {
  std::string_view code;  ///< as "GXY-B1"
  Dimension dimension = Dimension::kRatio;
  WeightRole role = WeightRole::kPlain;
  std::optional<GyroAxes> axes;                 ///< of gyro terms
  Weights (*at)(const WeightPlace&) = nullptr;  ///< null for course terms and continuous ones
  /// Position error (north, east, down; [m] per [m] of course, of kCourse [m]): in place of `at` at
  /// a vertical station, and always for course terms. Null where `at` serves everywhere.
  Eigen::Vector3d (*vector)(const WeightPlace&) = nullptr;
  /// Denominator that must not vanish; null where there is none.
  double (*denominator)(const WeightPlace&) = nullptr;
};

/// The function of a published code: SPE 67616 (depth, sag, magnetic), SPE 90408 tables 1 to 10
/// (gyro), SPE 187249 (course length), OWSG Set A Rev 5.1. Null when there is none.
WELLGYRO_EXPORT const WeightFunction* FindWeight(std::string_view code);

}  // namespace wellgyro

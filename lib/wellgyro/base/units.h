#pragma once

#include "wellgyro/base/angle.h"

/// Units of the trade in SI. Multiply to come in, divide to go out:
///   bias = 0.1 * units::kDegPerHour;   text = bias / units::kDegPerHour;
namespace wellgyro::units {

inline constexpr double kHour = 3600;                                      ///< [s]
inline constexpr double kDay = 24 * kHour;                                 ///< [s]
inline constexpr double kDeg = kPi / 180;                                  ///< [rad]
inline constexpr double kArcsec = kDeg / 3600;                             ///< [rad]
inline constexpr double kDegPerHour = kDeg / kHour;                        ///< [rad/s]
inline constexpr double kDegPerSqrtHour = kDeg / 60;                       ///< [rad/sqrt(s)]
inline constexpr double kDegPerHourSqrtHour = kDeg / kHour / 60;           ///< [rad/s/sqrt(s)]
inline constexpr double kDegPerHour2 = kDeg / kHour / kHour;               ///< [rad/s^2]
inline constexpr double kStandardGravity = 9.80665;                        ///< [m/s^2]
inline constexpr double kMilliG = kStandardGravity * 1e-3;                 ///< [m/s^2]
inline constexpr double kDegPerHourPerG = kDegPerHour / kStandardGravity;  ///< [rad/s per m/s^2]
inline constexpr double kFoot = 0.3048;                                    ///< international [m]
inline constexpr double kUsSurveyFoot = 1200.0 / 3937.0;                   ///< [m]
inline constexpr double kStand = 30;                          ///< of pipe: three joints [m]
inline constexpr double kDegPer30m = kDeg / 30;               ///< dogleg severity [rad/m]
inline constexpr double kDegPer100ft = kDeg / (100 * kFoot);  ///< dogleg severity [rad/m]
inline constexpr double kNanotesla = 1e-9;                    ///< [T]

}  // namespace wellgyro::units

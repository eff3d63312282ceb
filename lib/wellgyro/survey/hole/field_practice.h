#pragma once

/// What operators ask of the in-run of a gyro survey against its out-run, whatever the error model
/// says. Source: drillingforgas.com, "Gyro surveys QA/QC".
namespace wellgyro::field_practice {

inline constexpr double kInclinationDeg = 0.23;  ///< largest difference of inclinations [deg]
inline constexpr double kAzimuthDeg = 1;         ///< of azimuths, at kSteepDeg and more [deg]
inline constexpr double kLowAzimuthDeg = 5;      ///< below it [deg]
inline constexpr double kSteepDeg = 10;          ///< inclination [deg]
inline constexpr int kDepths = 10;               ///< to be compared, at least
/// Depth lost on the way there and back, over the way: 1 ft in 1000 ft.
inline constexpr double kSlippage = 1e-3;

}  // namespace wellgyro::field_practice

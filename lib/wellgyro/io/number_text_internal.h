#pragma once

#include <string>

namespace wellgyro {

/// Number texts for files: locale-free, never a negative zero.
std::string Fixed(double value, int decimals);
std::string Significant(double value);   ///< 9 significant digits
std::string Metres(double value);        ///< to 1e-4
std::string AngleDeg(double radians);    ///< degrees to 1e-6
std::string AzimuthDeg(double radians);  ///< degrees to 1e-6, from 0 up to 359.999999
/// Degrees in [0, 360) to that many decimals; 360 itself is never written.
std::string AzimuthText(double radians, int decimals);

}  // namespace wellgyro

#pragma once

#include "wellgyro/record/error_source.h"

namespace wellgyro {

/// Unknowns of the whole run that are no tool's, beside ErrorSource.
inline constexpr int kLatitudeError = kErrorSources;     ///< [rad]
inline constexpr int kGravityError = kErrorSources + 1;  ///< [m/s^2]
/// Depth marks read (1 + error) of the way that the accelerometers feel [1].
inline constexpr int kDepthScaleError = kErrorSources + 2;
/// Of the gyros x, y and z, from the begin of the run on [rad/s^2].
inline constexpr int kRampX = kErrorSources + 3, kRampY = kErrorSources + 4,
                     kRampZ = kErrorSources + 5;
/// Of their biases, over the largest difference of the temperature from its mean [rad/s].
inline constexpr int kWarmthX = kErrorSources + 6, kWarmthY = kErrorSources + 7,
                     kWarmthZ = kErrorSources + 8;

/// A fault that is looked for.
struct CauseSpec {
  enum class Kind {
    kConstant,    ///< `unknown` is beyond its prior all the while
    kGiven,       ///< the same by `size` exactly, as a sign is wrong by twice its number
    kOnset,       ///< from some node on `unknown` is another
    kGyroSpike,   ///< one knot's turn, of one axis across [rad]
    kAccelSpike,  ///< one knot's mean force, of one axis [m/s^2]
    kRestMotion,  ///< a tool at rest turned within one knot [rad]
    kTie,         ///< one azimuth from outside [rad]
    kGyroNoise,   ///< all turns scatter more: a factor
    kAccelNoise,  ///< all forces scatter more: a factor
    kOther,       ///< anything: a stretch of the run, or all of it, scatters more
  };
  Kind kind = Kind::kConstant;
  int unknown = 0;  ///< of the first three: an ErrorSource, or one of the above
  double size = 0;  ///< its 1-sigma where the fault is there; unused of noise and kOther
};

/// Normal quantile of the power, 80 %, with which a fault counts as noticed, as geodesy has it
/// (Baarda, A testing procedure for use in geodetic networks, 1968).
inline constexpr double kNoticedPower = 0.8416212335729143;
/// No fault is larger than so many of its sizes: five sigmas, one of 1.7 million.
inline constexpr double kLargestFault = 5;
/// Prior sigma, in its sizes, of what is an unknown for the test alone: with a millionth of a
/// fault's variance it moves no solution.
inline constexpr double kTestedPrior = 1e-3;

}  // namespace wellgyro

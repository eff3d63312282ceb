#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "wellgyro/base/time.h"

namespace wellgyro {

/// How a running survey stands at one moment, for a line on a screen. What is not known is absent.
struct Glance {
  UtcTime utc;  ///< of the newest sample
  std::int64_t seq = 0;
  std::int32_t session = 0;
  std::int32_t run = 0;
  std::optional<double> md;           ///< of the depth reference [m]
  std::optional<double> speed;        ///< down-hole positive [m/s]
  std::optional<double> inclination;  ///< of the last station [rad]
  std::optional<double> azimuth;      ///< true [rad]
  double sigma_azimuth = 0;           ///< [rad]
  std::int64_t stations = 0;          ///< told so far
  std::optional<double> still;        ///< how long the tool has been at rest [s]; absent: it moves
  double still_needed = 0;            ///< what a gyrocompass takes [s]
  std::int64_t samples_lost = 0;
  std::int32_t checks_warned = 0, checks_failed = 0;
  std::string turned;  ///< the code of the check whose verdict changed last
};

}  // namespace wellgyro

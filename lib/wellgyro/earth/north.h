#pragma once

#include <optional>
#include <string>

#include "wellgyro/base/export.h"

namespace wellgyro {

/// What an azimuth counts from.
enum class North { kUnknown, kTrue, kGrid, kMagnetic };

/// How the azimuths of one survey hang together.
struct AzimuthReference {
  North north = North::kUnknown;      ///< of the survey's azimuths
  std::optional<double> convergence;  ///< true azimuth less grid azimuth [rad]
  std::optional<double> declination;  ///< true azimuth less magnetic azimuth [rad]
  std::string declination_source;     ///< model, as "BGGM 2023"
  std::string declination_date;       ///< day it holds for, YYYY-MM-DD
};

/// `azimuth` [rad], given from `from`, as it counts from `to`, in [0, 2 pi). Throws
/// std::invalid_argument saying what is missing: convergence, declination, or which north it is.
WELLGYRO_EXPORT double AzimuthFrom(const AzimuthReference& reference, double azimuth, North from,
                                   North to);

}  // namespace wellgyro

#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/record/station.h"

namespace wellgyro {

/// Two stations no further apart than this are at one depth [m]: half of the least spacing that a
/// job may ask for, and what depths typed to the decimetre differ by.
inline constexpr double kSameDepth = 0.1;
/// A depth typed by hand is off by no more [m]: to the decimetre at best, more often to the metre.
inline constexpr double kTypedDepth = 0.5;

/// Indices of the chosen station of each depth among `stations` of any runs and passes, depth
/// increasing: at each depth that of the smallest azimuth variance, the earlier on a tie. Rejected
/// and superseded stations are never chosen.
WELLGYRO_EXPORT std::vector<std::size_t> ChooseStations(std::span<const Station> stations);

}  // namespace wellgyro

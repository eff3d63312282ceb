#pragma once

#include <cstdint>
#include <tuple>

#include "wellgyro/record/station.h"

namespace wellgyro {

/// What stays of a station from revision to revision: tool, run, and when the tool was there. Of
/// its kind no more than whether samples tell of it: a stop makes a continuous station one of
/// gyrocompass after it was told.
using StationKey = std::tuple<std::int32_t, std::int32_t, std::int64_t, StationKind>;

inline StationKey KeyOf(const Station& station) {
  const bool sampled = station.kind == StationKind::kGyrocompass;
  return {station.tool, station.run, station.utc.ns,
          sampled ? StationKind::kContinuous : station.kind};
}

}  // namespace wellgyro

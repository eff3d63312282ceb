#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/noise/sample_series.h"

namespace wellgyro {

/// Which samples of a log are wanted.
struct SeriesChannel {
  std::string name;         ///< gx gy gz [rad/s], ax ay az [m/s^2], or the number of a raw channel
  std::string bus_channel;  ///< where they were published; empty: wherever their type is found
  std::optional<std::int32_t> tool;  ///< in the string; absent: the first that comes
};

/// One channel of an LCM log as an even sequence, from imu_batch_t or raw_batch_t. Sequence numbers
/// say what is missing; what a later batch repeats is skipped. Where the source restarted or its
/// period changed the longest stretch is taken, and the notes say so. Faults: kRange for a channel
/// that there is not, kForeign when no sample is in the log, and those of LogReader.
WELLGYRO_EXPORT Result<SampleSeries> ReadLcmSeries(
    const std::string& path, const SeriesChannel& channel,
    const std::function<void(double)>& progress = {});

}  // namespace wellgyro

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "wellgyro/calibration/group_kernel_internal.h"
#include "wellgyro/record/sample.h"

namespace wellgyro {

using Counts = std::array<OfRun<std::int32_t>, RawSample::kChannelsMax>;

/// counts[c][at + k] of raw[k], of the first `channels`, whole fours of them.
void Transpose(Lanes lanes, std::span<const RawSample> raw, std::size_t channels, std::size_t at,
               Counts& counts);

/// What samples are made of besides what the tool said: numbers beside each other.
struct Columns {
  const Vectors &w_IT_T, &f_T, &b_T;
  bool has_gz = false, has_mag = false;
  const OfRun<double>& temperature;
  const OfRun<std::int64_t>& inside;  ///< 0: beyond the calibrated temperatures
};
void Write(Lanes lanes, std::span<const RawSample> raw, const Columns& from, ImuSample* out);

}  // namespace wellgyro

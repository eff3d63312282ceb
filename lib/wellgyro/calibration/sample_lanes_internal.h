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

/// out[k] of raw[k]: all but its vectors.
void Stamp(Lanes lanes, std::span<const RawSample> raw, const double* temperature, bool has_gz,
           bool has_mag, ImuSample* out);

/// Vectors that stand beside each other to where samples have theirs.
void Put(Lanes lanes, const Vectors& w_IT_T, const Vectors& f_T, const Vectors& b_T,
         std::span<ImuSample> out);

}  // namespace wellgyro

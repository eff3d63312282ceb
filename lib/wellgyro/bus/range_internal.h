#pragma once

#include <cmath>
#include <cstdint>

#include "wellgyro/record/limits.h"

/// What fields may hold beyond what their type says; the same on the way in and out.
namespace wellgyro {

inline constexpr std::int32_t kBatchMax = limits::kBatch;  ///< N_MAX of imu_batch_t and raw_batch_t

inline constexpr std::int32_t kKeyMax = 128;        ///< [bytes] of a key or signature
inline constexpr std::int32_t kContentMax = 32768;  ///< [bytes] of a signed message

// Differences and sums of two stay inside 64 bits, as those of limits::kUtcUs and limits::kCount.
inline constexpr std::int64_t kToolTimeMax = std::int64_t{1} << 61;  ///< [ns] 73 years

/// Whether a field of a message can be taken: its UTC or its number is one that reckoning with two
/// of them cannot overflow. A tool time is held within +-kToolTimeMax where the two clocks of a
/// message are read and written (batch_internal.h).
constexpr bool IsUtc(std::int64_t us) { return us >= 0 && us <= limits::kUtcUs; }
constexpr bool IsCount(std::int64_t n) { return n >= 0 && n <= limits::kCount; }

}  // namespace wellgyro

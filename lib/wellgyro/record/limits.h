#pragma once

#include <cstddef>
#include <cstdint>

/// What values from outside can be at most, whether they come in a message, in the job or from a
/// vendor's program. Beyond it they are refused, so that nothing that follows has to ask again.
namespace wellgyro::limits {

inline constexpr double kMd = 1e5;                    ///< along hole, either sign [m]
inline constexpr double kSensorBelowReference = 100;  ///< either sign [m]
inline constexpr double kSigma = 1e3;                 ///< of a depth [m] or an angle [rad]
inline constexpr double kSpeed = 100;                 ///< of a string, either sign [m/s]
inline constexpr double kDuration = 1e6;              ///< that a command asks for [s]
inline constexpr double kAngle = 100;                 ///< of a direction, either sign [rad]
inline constexpr double kCorrection = 1e4;            ///< of a depth, either sign [m]
inline constexpr std::size_t kText = 4096;            ///< of one text [bytes]
inline constexpr std::int32_t kBatch = 1000;          ///< N_MAX, samples of one message
inline constexpr std::size_t kChannel = 63;           ///< LCM_MAX_CHANNEL_NAME_LENGTH [bytes]

// Differences and sums of two of these stay inside 64 bits.
inline constexpr std::int64_t kUtcUs = 4'000'000'000'000'000;  ///< UTC since 1970: year 2096 [us]
inline constexpr std::int64_t kCount = std::int64_t{1} << 61;  ///< of messages or samples

}  // namespace wellgyro::limits

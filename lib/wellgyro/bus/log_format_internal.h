#pragma once

#include <cstddef>
#include <cstdint>

/// LCM's log format: events one after the other, each a head, the channel's name without NUL, the
/// data. All numbers big-endian. (LCM documentation, "LCM log file format".)
namespace wellgyro::log_format {

/// Begins every event of an LCM log (lcm/eventlog.h).
inline constexpr std::uint32_t kSync = 0xEDA1DA01;
inline constexpr std::size_t kSyncSize = 4;
inline constexpr std::size_t kNumberAt = 4;    ///< int64
inline constexpr std::size_t kTimeAt = 12;     ///< int64 [us]
inline constexpr std::size_t kChannelAt = 20;  ///< int32, length of the channel
inline constexpr std::size_t kDataAt = 24;     ///< int32, length of the data
inline constexpr std::size_t kHeadSize = 28;

inline constexpr std::size_t kChannelMax = 999;  ///< of what is read; LCM sends 63 at most
/// [bytes], of one event: 32 times what is put together of fragments (Reassembly::kMessageMax);
/// more is a damaged length.
inline constexpr std::size_t kDataMax = std::size_t{1} << 28;

}  // namespace wellgyro::log_format

#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "wellgyro/base/export.h"
#include "wellgyro/record/channels.h"

namespace wellgyro {

/// The types of proto/, in the order of Message's alternatives.
enum class MessageType {
  kRawBatch,
  kImuBatch,
  kStillWindow,
  kDepth,
  kToolMode,
  kToolInfo,
  kEvent,
  kCommand,
  kStation,
  kStatus,
  kOperation,
  kGlance,
  kRequest,
  kAdvice,
};
inline constexpr int kMessageTypes = 14;

/// The struct's name in proto/, as "imu_batch_t".
WELLGYRO_EXPORT std::string_view TypeName(MessageType type);

/// The first eight bytes of every message of the type: LCM's hash over field names, types, order
/// and dimensions.
WELLGYRO_EXPORT std::uint64_t Fingerprint(MessageType type);

/// What the bytes say they are by their fingerprint; nothing when it is none of ours.
WELLGYRO_EXPORT std::optional<MessageType> TypeOf(std::span<const std::byte> message);

/// The channel's name for a type.
WELLGYRO_EXPORT const std::string& NameOf(const Channels& channels, MessageType type);

/// The type that belongs on a channel; nothing when the channel is none of ours.
WELLGYRO_EXPORT std::optional<MessageType> TypeOn(const Channels& channels, std::string_view name);

/// The same of a message: a channel carries later types beside the one it was made for, told apart
/// by their fingerprint.
WELLGYRO_EXPORT std::optional<MessageType> TypeOn(const Channels& channels, std::string_view name,
                                                  std::span<const std::byte> bytes);

/// Throws std::invalid_argument, naming the field, when a name is empty, longer than the 63 bytes
/// that LCM takes, holds a control character, or stands twice.
WELLGYRO_EXPORT void Validate(const Channels& channels);

}  // namespace wellgyro

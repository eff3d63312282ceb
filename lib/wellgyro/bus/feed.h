#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/record/channels.h"
#include "wellgyro/record/depth.h"
#include "wellgyro/record/operations.h"
#include "wellgyro/record/sample.h"

/// @file
/// Messages, live or of a log, to records.
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
inline constexpr int kMessageTypes = 14;  ///< of MessageType

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

// Of pages, consoles and the survey's own answers: defined in record/ and bus/message.h, for our
// own program. A listener from outside need not know them.
struct Advice;
struct Glance;
struct SentStation;

/// Who wants what comes in. Override what you want to hear; spans hold during the call only.
class WELLGYRO_EXPORT Listener {
 public:
  virtual ~Listener();
  virtual void OnRaw(std::span<const RawSample> /*batch*/) {}
  virtual void OnImu(std::span<const ImuSample> /*batch*/) {}
  virtual void OnStill(const StillWindow& /*window*/) {}
  virtual void OnDepth(const DepthMark& /*mark*/) {}
  virtual void OnMode(const ToolMode& /*mode*/) {}
  virtual void OnTool(const ToolInfo& /*info*/) {}
  virtual void OnEvent(const Event& /*event*/) {}
  virtual void OnCommand(const Command& /*command*/) {}
  virtual void OnStation(const SentStation& /*station*/) {}
  virtual void OnStatus(const Status& /*status*/) {}
  virtual void OnOperation(const SignedOperation& /*operation*/) {}
  virtual void OnGlance(const Glance& /*glance*/) {}
  virtual void OnAdvice(const Advice& /*advice*/) {}
  virtual void OnRequest(const StationRequest& /*request*/) {}
  virtual void OnFault(const Fault& /*fault*/) {}
};

/// What came on one of our channels.
struct ChannelCount {
  std::int64_t messages = 0;   ///< accepted
  std::int64_t bytes = 0;      ///< of the accepted
  std::int64_t malformed = 0;  ///< refused, or accepted less what is no number
};

/// What came on a channel that is none of ours.
struct ForeignCount {
  std::int64_t messages = 0;
  std::optional<MessageType> type;  ///< of ours, by its fingerprint: a channel renamed, perhaps
};

/// The one way in for messages, live or from a log: tells by the channel what the bytes must be,
/// decodes, counts, and hands on records. Which of the two it was makes no difference to what the
/// listener hears.
///
/// What is refused, or left out of a message, becomes a Fault; of each code on each channel the
/// first kFaultsHeard reach the listener, the others are counted only. Batches allocate nothing
/// once the buffers have grown.
class WELLGYRO_EXPORT Feed {
 public:
  static constexpr int kFaultsHeard = 10;  ///< of a kind of message and of fault; the rest counted
  static constexpr std::size_t kForeignChannelsMax = 100;  ///< by name; the rest under ""

  /// Called for each accepted message before the listener, with the bytes as they came.
  using Accepted =
      std::function<void(MessageType, std::string_view channel, std::span<const std::byte>)>;

  /// Throws std::invalid_argument when the channels' names make no sense. `listener` must outlive
  /// this object.
  Feed(const Channels& channels, Listener& listener, Accepted on_accepted = {});

  /// `offset`: of the message's first byte in its log, so that faults name the place; -1: no log.
  /// Throws only what the listener throws.
  void Take(std::string_view channel, std::span<const std::byte> bytes, std::int64_t offset = -1);

  const Channels& channels() const { return channels_; }
  const ChannelCount& count(MessageType type) const;
  std::int64_t malformed() const;  ///< on all channels
  const std::map<std::string, ForeignCount, std::less<>>& foreign() const { return foreign_; }

 private:
  std::optional<Fault> Hand(MessageType type, std::string_view channel,
                            std::span<const std::byte> bytes);
  void Accept(MessageType type, std::string_view channel, std::span<const std::byte> bytes);
  void Complain(MessageType type, Fault fault, std::int64_t offset);
  void Ignore(std::string_view channel, std::span<const std::byte> bytes);

  Channels channels_;
  Listener* listener_;
  Accepted on_accepted_;
  std::vector<ImuSample> imu_;
  std::vector<RawSample> raw_;
  std::array<ChannelCount, kMessageTypes> counts_{};
  std::array<std::map<FaultCode, int>, kMessageTypes> heard_;
  std::map<std::string, ForeignCount, std::less<>> foreign_;
};

}  // namespace wellgyro

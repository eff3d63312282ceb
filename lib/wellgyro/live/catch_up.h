#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/bus/lcm_live.h"
#include "wellgyro/bus/message.h"
#include "wellgyro/bus/splice.h"
#include "wellgyro/live/notices.h"
#include "wellgyro/live/observer.h"
#include "wellgyro/record/channels.h"

namespace wellgyro {

/// A message with its own storage.
struct HeldMessage {
  std::string channel;
  std::vector<std::byte> bytes;
  std::int64_t received_us = 0;
};

/// Brings a survey that was cut off up to the live stream: its own log first, then what other
/// recorders have beyond that, then what the bus has brought meanwhile, each message once.
class WELLGYRO_EXPORT CatchUp {
 public:
  /// `fresh`: the message is in no log of ours yet.
  using Use = std::function<void(std::string_view channel, std::span<const std::byte> bytes,
                                 std::int64_t received_us, bool fresh)>;

  /// All but `use` must outlive this object.
  CatchUp(const Channels& channels, const LiveClock& clock, Notices& notices, Use use)
      : channels_(channels), clock_(clock), notices_(notices), use_(std::move(use)) {}

  /// The log that the survey itself wrote. Of other logs what they heard before `begun_us` is left
  /// out: the survey did not listen yet.
  [[nodiscard]] std::optional<Fault> OwnLog(const std::string& path, std::int64_t begun_us);

  /// A live message that comes while the logs are read.
  void Hold(std::string_view channel, std::span<const std::byte> bytes, std::int64_t received_us);

  /// Other recorders' logs, the oldest first; the last may still grow, and is followed until it
  /// reaches the live stream, or ten seconds. Then uses what was held. True when it was stopped.
  Result<bool> FillAndJoin(LiveBus& bus, const std::vector<std::string>& logs);

 private:
  struct Follower;
  /// By which a message is known again in another recorder's log.
  MessageKey Key(std::string_view channel, std::span<const std::byte> bytes) const;
  /// Into the survey, and noted as the last of its channel.
  void UseOne(const HeldMessage& message, bool fresh);
  /// One message of a fill log: used once the place where the log before ended has come.
  void TakeFill(const HeldMessage& message);
  void UseUnheard(std::vector<HeldMessage> before);
  /// What has been added to a log since it was read; how many messages.
  Result<std::int64_t> ReadOn(Follower& log);
  /// Reads on until the log reaches the live stream; true: stopped meanwhile.
  Result<bool> Follow(LiveBus& bus, Follower& log);
  void NoteUsed(std::string_view channel, const MessageKey& key);
  std::vector<MessageKey> HeldKeys() const;
  std::map<std::string_view, std::size_t> Joints(const std::vector<MessageKey>& keys) const;
  bool Reached(bool quiet) const;
  /// Uses what is held beyond what was used, each message once.
  void Join();

  const Channels& channels_;
  const LiveClock& clock_;
  Notices& notices_;
  Use use_;
  Splice splice_;
  std::set<std::string, std::less<>> heard_;  ///< channels of which anything was used
  /// Of each channel whose messages are sent once, the last one used: every recorder has a channel
  /// in its order, but not the channels among each other, while their sender was not yet known.
  std::map<std::string, MessageKey, std::less<>> last_;
  std::int64_t begun_us_ = 0;
  std::int64_t last_received_us_ = 0;          ///< of what was used
  std::optional<std::int64_t> fill_begun_us_;  ///< first message of the fill log
  bool joined_fill_ = false;                   ///< behind the place where the log before ended
  std::vector<HeldMessage> before_;  ///< of a fill log, as long as that place has not come
  std::deque<HeldMessage> held_;
};

}  // namespace wellgyro

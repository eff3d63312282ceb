#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "wellgyro/base/export.h"

namespace wellgyro {

/// A message for comparing: the same channel and bytes give the same key.
struct MessageKey {
  std::uint64_t hash = 0;
  /// Each is sent once, as samples and depths are; commands and events are sent again unchanged.
  bool once = true;
};

/// Continues a stream of messages that came from one source with the same stream from another (a
/// log, then a recorder's log, then the bus), so that none is used twice and none between is left
/// out where the second reaches back far enough.
///
/// Both must give the messages in the same order, which is so where one sender's datagrams reach
/// two receivers on one network.
class WELLGYRO_EXPORT Splice {
 public:
  /// Messages looked back at: what the two sources may differ by around their meeting.
  static constexpr std::size_t kKept = 4096;

  /// Every message used, in order.
  void Used(const MessageKey& key);
  /// Here another source begins.
  void Turn();

  /// Of the new source's messages `next`, in order: where the last one used that is sent once
  /// stands. Nothing: it is not among them.
  std::optional<std::size_t> Find(std::span<const MessageKey> next) const;

  /// Whether `key`, of a message behind the place that Find gave, was used before the turn: only
  /// those that are sent again can be. Asking uses it up.
  bool WasUsed(const MessageKey& key);

  bool empty() const { return used_.empty(); }

 private:
  std::deque<MessageKey> used_;
  std::vector<MessageKey> before_turn_;  ///< sent again, behind the last one sent once
};

WELLGYRO_EXPORT MessageKey KeyOf(std::string_view channel, std::span<const std::byte> bytes,
                                 bool once);

}  // namespace wellgyro

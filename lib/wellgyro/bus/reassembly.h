#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/record/limits.h"

namespace wellgyro {

/// Messages out of LCM's datagrams, "LC02" (whole) and "LC03" (fragments), whoever sent them. All
/// numbers are checked before they are used, in 64 bits; what waits for its other fragments is
/// bounded in number and in bytes, and the oldest of a sender gives way.
///
/// Layout: LCM documentation, "UDP Multicast Protocol Description".
class WELLGYRO_EXPORT Reassembly {
 public:
  static constexpr std::size_t kChannelMax = limits::kChannel;
  static constexpr std::size_t kMessageMax = std::size_t{8} << 20;   ///< of fragments
  static constexpr std::size_t kWaitingMax = std::size_t{16} << 20;  ///< bytes of unfinished ones
  static constexpr std::ptrdiff_t kWaitingOfSender = 4;              ///< unfinished messages
  static constexpr std::size_t kWaiting = 64;                        ///< of all senders

  /// Valid until the next Take, and no longer than the datagram.
  struct Whole {
    std::string_view channel;
    std::span<const std::byte> data;
    std::uint32_t number = 0;  ///< that the sender gave it
  };

  /// `sender`: any number that tells senders apart. The message that `datagram` is, or is the last
  /// missing part of.
  std::optional<Whole> Take(std::uint64_t sender, std::span<const std::byte> datagram);

  std::int64_t refused() const { return refused_; }      ///< datagrams that are none of LCM's
  std::int64_t abandoned() const { return abandoned_; }  ///< messages of which parts never came
  std::size_t waiting() const { return messages_.size(); }
  std::size_t waiting_bytes() const { return bytes_; }

 private:
  struct Fragment {
    std::uint32_t message = 0, size = 0, offset = 0;
    std::uint16_t number = 0, count = 0;
    std::string_view channel;  ///< of the first
    std::span<const std::byte> data;
  };
  struct Piece {
    std::uint32_t offset, size;
  };
  /// Of its size only what came is held: a sender pays for memory in bytes sent.
  struct Message {
    std::uint64_t sender = 0;
    std::uint32_t number = 0, size = 0;
    std::string channel;
    std::vector<std::byte> bytes;  ///< in the order in which they came
    std::vector<Piece> pieces;     ///< of these bytes
    std::vector<bool> has;         ///< by fragment
    std::size_t cost() const {
      return bytes.size() + pieces.size() * sizeof(Piece) + has.size() / 8;
    }
  };
  using Place = std::list<Message>::iterator;

  std::optional<Whole> Refuse();
  static std::optional<Fragment> Parse(std::span<const std::byte> datagram);
  std::optional<Whole> Add(std::uint64_t sender, const Fragment& fragment);
  std::optional<Whole> Finish(Place at);
  Place Begin(std::uint64_t sender, const Fragment& fragment);
  void MakeRoom(Place at, std::size_t more);
  void Drop(Place at);

  std::list<Message> messages_;  ///< the oldest first
  std::string channel_;          ///< handed out last, with ...
  std::vector<std::byte> whole_;
  std::size_t bytes_ = 0;  ///< cost of all messages
  std::int64_t refused_ = 0, abandoned_ = 0;
};

}  // namespace wellgyro

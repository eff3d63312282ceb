#include "wellgyro/bus/reassembly.h"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <utility>

#include "wellgyro/bus/bytes_internal.h"

namespace wellgyro {
namespace {

constexpr std::uint32_t kWhole = 0x4c433032;      // "LC02"
constexpr std::uint32_t kFragments = 0x4c433033;  // "LC03"
constexpr std::size_t kWholeHead = 8;             // magic, number
constexpr std::size_t kFragmentHead = 20;         // magic, number, size, offset, part, parts

/// Takes the channel's name with its NUL off `rest`; empty where there is none that is possible.
std::string_view TakeChannel(std::span<const std::byte>& rest) {
  const std::size_t within = std::min(rest.size(), Reassembly::kChannelMax + 1);
  const auto* chars = reinterpret_cast<const char*>(rest.data());
  const void* end = within > 0 ? std::memchr(chars, '\0', within) : nullptr;
  if (end == nullptr) return {};
  const auto length = static_cast<std::size_t>(static_cast<const char*>(end) - chars);
  rest = rest.subspan(length + 1);
  return {chars, length};
}

std::uint16_t Short(const std::byte* from) {
  return static_cast<std::uint16_t>(std::to_integer<unsigned>(from[0]) << 8 |
                                    std::to_integer<unsigned>(from[1]));
}

}  // namespace

std::optional<Reassembly::Whole> Reassembly::Refuse() {
  ++refused_;
  return std::nullopt;
}

std::optional<Reassembly::Whole> Reassembly::Take(std::uint64_t sender,
                                                  std::span<const std::byte> datagram) {
  if (datagram.size() < kWholeHead) return Refuse();
  const auto magic = Load<std::uint32_t>(datagram.data());
  if (magic == kWhole) {
    std::span<const std::byte> rest = datagram.subspan(kWholeHead);
    const std::string_view channel = TakeChannel(rest);
    if (channel.empty()) return Refuse();
    return Whole{channel, rest, Load<std::uint32_t>(datagram.data() + 4)};
  }
  if (magic != kFragments) return Refuse();
  const std::optional<Fragment> fragment = Parse(datagram);
  return fragment ? Add(sender, *fragment) : Refuse();
}

std::optional<Reassembly::Fragment> Reassembly::Parse(std::span<const std::byte> datagram) {
  if (datagram.size() <= kFragmentHead) return std::nullopt;
  const std::byte* head = datagram.data();
  Fragment f;
  f.message = Load<std::uint32_t>(head + 4);
  f.size = Load<std::uint32_t>(head + 8);
  f.offset = Load<std::uint32_t>(head + 12);
  f.number = Short(head + 16);
  f.count = Short(head + 18);
  f.data = datagram.subspan(kFragmentHead);
  if (f.number == 0) {
    f.channel = TakeChannel(f.data);
    if (f.channel.empty()) return std::nullopt;
  }
  const std::uint64_t end = std::uint64_t{f.offset} + f.data.size();
  const bool good = f.size <= kMessageMax && end <= f.size && f.number < f.count &&
                    (f.number != 0 || f.offset == 0) && f.count <= f.size + std::uint64_t{1};
  return good ? std::optional(f) : std::nullopt;
}

std::optional<Reassembly::Whole> Reassembly::Add(std::uint64_t sender, const Fragment& fragment) {
  Place at = std::find_if(messages_.begin(), messages_.end(), [&](const Message& m) {
    return m.sender == sender && m.number == fragment.message;
  });
  if (at == messages_.end()) at = Begin(sender, fragment);
  Message& message = *at;
  if (message.size != fragment.size || message.has.size() != fragment.count) return Refuse();
  if (message.has[fragment.number]) return std::nullopt;  // the network doubles now and then
  if (message.bytes.size() + fragment.data.size() > message.size) return Refuse();
  MakeRoom(at, fragment.data.size() + sizeof(Piece));
  message.has[fragment.number] = true;
  message.pieces.push_back({fragment.offset, static_cast<std::uint32_t>(fragment.data.size())});
  message.bytes.insert(message.bytes.end(), fragment.data.begin(), fragment.data.end());
  if (fragment.number == 0) message.channel = fragment.channel;
  if (message.pieces.size() < message.has.size()) return std::nullopt;
  return Finish(at);
}

/// All fragments of the message have come.
std::optional<Reassembly::Whole> Reassembly::Finish(Place at) {
  const Message message = std::move(*at);
  bytes_ -= message.cost();
  messages_.erase(at);
  if (message.bytes.size() != message.size) return Refuse();
  channel_ = message.channel;
  whole_.assign(message.size, std::byte{});
  const std::byte* from = message.bytes.data();
  for (const Piece& piece : message.pieces) {
    std::copy_n(from, piece.size, whole_.data() + piece.offset);
    from += piece.size;
  }
  return Whole{channel_, whole_, message.number};
}

Reassembly::Place Reassembly::Begin(std::uint64_t sender, const Fragment& fragment) {
  const auto of_sender = [sender](const Message& m) { return m.sender == sender; };
  if (std::ranges::count_if(messages_, of_sender) >= kWaitingOfSender) {
    Drop(std::ranges::find_if(messages_, of_sender));
  }
  if (messages_.size() >= kWaiting) Drop(messages_.begin());
  Message message;
  message.sender = sender;
  message.number = fragment.message;
  message.size = fragment.size;
  message.has.resize(fragment.count);
  MakeRoom(messages_.end(), message.cost());
  messages_.push_back(std::move(message));
  return std::prev(messages_.end());
}

/// Takes `more` bytes of what may wait; for them the oldest messages but `at` give way.
void Reassembly::MakeRoom(Place at, std::size_t more) {
  while (bytes_ + more > kWaitingMax) {
    Place oldest = messages_.begin();
    if (oldest != messages_.end() && oldest == at) ++oldest;
    if (oldest == messages_.end()) break;
    Drop(oldest);
  }
  bytes_ += more;
}

void Reassembly::Drop(Place at) {
  bytes_ -= at->cost();
  messages_.erase(at);
  ++abandoned_;
}

}  // namespace wellgyro

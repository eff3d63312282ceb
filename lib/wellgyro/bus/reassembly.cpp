#include "wellgyro/bus/reassembly.h"

#include <algorithm>
#include <cstring>
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
    return Whole{channel, rest};
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
  if (at == messages_.end()) {
    const std::optional<Place> begun = Begin(sender, fragment);
    if (!begun) return Refuse();
    at = *begun;
  }
  Message& message = *at;
  if (message.data.size() != fragment.size || message.has.size() != fragment.count) {
    return Refuse();
  }
  if (message.has[fragment.number]) return std::nullopt;  // the network doubles now and then
  message.has[fragment.number] = true;
  std::copy(fragment.data.begin(), fragment.data.end(), message.data.begin() + fragment.offset);
  if (fragment.number == 0) message.channel = fragment.channel;
  message.filled += fragment.data.size();
  if (--message.missing > 0) return std::nullopt;
  const bool complete = message.filled == message.data.size();
  bytes_ -= message.data.size();
  whole_ = std::move(message);
  messages_.erase(at);
  if (!complete) return Refuse();
  return Whole{whole_.channel, whole_.data};
}

std::optional<Reassembly::Place> Reassembly::Begin(std::uint64_t sender, const Fragment& fragment) {
  const auto of_sender = std::count_if(messages_.begin(), messages_.end(),
                                       [sender](const Message& m) { return m.sender == sender; });
  if (of_sender >= static_cast<std::ptrdiff_t>(kWaitingOfSender)) DropOldest(sender);
  while (messages_.size() >= kWaiting || bytes_ + fragment.size > kWaitingMax) {
    if (!DropOldest(std::nullopt)) return std::nullopt;
  }
  Message message;
  message.sender = sender;
  message.number = fragment.message;
  message.data.resize(fragment.size);
  message.has.resize(fragment.count);
  message.missing = fragment.count;
  bytes_ += message.data.size();
  messages_.push_back(std::move(message));
  return std::prev(messages_.end());
}

bool Reassembly::DropOldest(std::optional<std::uint64_t> sender) {
  const Place oldest = std::find_if(messages_.begin(), messages_.end(), [&](const Message& m) {
    return !sender || m.sender == *sender;
  });
  if (oldest == messages_.end()) return false;
  bytes_ -= oldest->data.size();
  messages_.erase(oldest);
  ++abandoned_;
  return true;
}

}  // namespace wellgyro

#include "wellgyro/bus/feed.h"

#include <utility>

#include <fmt/format.h>

#include "wellgyro/bus/decode.h"
#include "wellgyro/bus/message.h"

namespace wellgyro {
namespace {

struct Telling {
  Listener& listener;

  void operator()(const RawBatch& batch) const { listener.OnRaw(batch.samples); }
  void operator()(const ImuBatch& batch) const { listener.OnImu(batch.samples); }
  void operator()(const StillWindow& window) const { listener.OnStill(window); }
  void operator()(const DepthMark& mark) const { listener.OnDepth(mark); }
  void operator()(const ToolMode& mode) const { listener.OnMode(mode); }
  void operator()(const ToolInfo& info) const { listener.OnTool(info); }
  void operator()(const Event& event) const { listener.OnEvent(event); }
  void operator()(const Command& command) const { listener.OnCommand(command); }
  void operator()(const SentStation& station) const { listener.OnStation(station); }
  void operator()(const Status& status) const { listener.OnStatus(status); }
  void operator()(const SignedOperation& operation) const { listener.OnOperation(operation); }
  void operator()(const Glance& glance) const { listener.OnGlance(glance); }
  void operator()(const Advice& advice) const { listener.OnAdvice(advice); }
  void operator()(const StationRequest& request) const { listener.OnRequest(request); }
};

std::size_t Index(MessageType type) { return static_cast<std::size_t>(type); }

}  // namespace

Listener::~Listener() = default;

Feed::Feed(const Channels& channels, Listener& listener, Accepted on_accepted)
    : channels_(channels), listener_(&listener), on_accepted_(std::move(on_accepted)) {
  Validate(channels_);
}

void Feed::Take(std::string_view channel, std::span<const std::byte> bytes, std::int64_t offset) {
  const std::optional<MessageType> type = TypeOn(channels_, channel, bytes);
  if (!type) return Ignore(channel, bytes);
  if (std::optional<Fault> fault = Hand(*type, channel, bytes)) {
    Complain(*type, *std::move(fault), offset);
  }
}

std::optional<Fault> Feed::Hand(MessageType type, std::string_view channel,
                                std::span<const std::byte> bytes) {
  // The two frequent types go through buffers that stay.
  if (type == MessageType::kImuBatch) {
    std::optional<Fault> damage;
    const auto batch = DecodeImuBatch(bytes, imu_, channel, &damage);
    if (!batch) return batch.fault();
    Accept(type, channel, bytes);
    listener_->OnImu(*batch);
    return damage;
  } else if (type == MessageType::kRawBatch) {
    const auto batch = DecodeRawBatch(bytes, raw_, channel);
    if (!batch) return batch.fault();
    Accept(type, channel, bytes);
    listener_->OnRaw(*batch);
  } else {
    const Result<Message> message = Decode(type, bytes, channel);
    if (!message) return message.fault();
    Accept(type, channel, bytes);
    std::visit(Telling{*listener_}, *message);
  }
  return std::nullopt;
}

void Feed::Accept(MessageType type, std::string_view channel, std::span<const std::byte> bytes) {
  ChannelCount& count = counts_[Index(type)];
  ++count.messages;
  count.bytes += static_cast<std::int64_t>(bytes.size());
  if (on_accepted_) on_accepted_(type, channel, bytes);
}

void Feed::Complain(MessageType type, Fault fault, std::int64_t offset) {
  ++counts_[Index(type)].malformed;
  int& heard = heard_[Index(type)][fault.code];
  if (heard >= kFaultsHeard) return;
  ++heard;
  if (heard == kFaultsHeard) {
    fault.text += fmt::format(" (the {}th of its kind; further ones are counted only)", heard);
  }
  if (offset >= 0) fault.offset += offset;
  listener_->OnFault(fault);
}

void Feed::Ignore(std::string_view channel, std::span<const std::byte> bytes) {
  auto place = foreign_.find(channel);
  if (place == foreign_.end()) {
    const bool full = foreign_.size() >= kForeignChannelsMax;
    place = foreign_.try_emplace(full ? std::string() : std::string(channel)).first;
  }
  ++place->second.messages;
  if (const std::optional<MessageType> type = TypeOf(bytes)) place->second.type = type;
}

const ChannelCount& Feed::count(MessageType type) const { return counts_.at(Index(type)); }

std::int64_t Feed::malformed() const {
  std::int64_t sum = 0;
  for (const ChannelCount& count : counts_) sum += count.malformed;
  return sum;
}

}  // namespace wellgyro

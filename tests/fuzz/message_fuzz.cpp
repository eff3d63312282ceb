#include <cstdlib>
#include <span>

#include "wellgyro/bus/decode.h"
#include "wellgyro/bus/encode.h"

#include "fuzz/fuzz.h"

// The first byte chooses the type that is expected, the rest is the message. Whatever is accepted
// must encode, and decode again to the same bytes.

namespace wellgyro {
namespace {

using Bytes = std::vector<std::byte>;

/// One message of every type, by our own encoder.
std::vector<Message> Messages() {
  ImuSample imu;
  imu.stamp.period_ns = 10;
  imu.has_gz = imu.has_mag = true;
  ImuSample next = imu;
  next.stamp.seq = 1;
  next.stamp.tool_time.ns = 10;
  RawSample raw;
  raw.stamp.period_ns = 1;
  raw.n_channels = 9;
  raw.n_temperatures = 2;
  ToolInfo info;
  info.asset_serial = "A";
  Event event;
  event.what = "shoe";
  Status status;
  status.text = "well";
  return {
      RawBatch{{raw}}, ImuBatch{{imu, next}}, StillWindow{}, DepthMark{}, ToolMode{}, info, event,
      Command{},       SentStation{},         status};
}

void Require(bool good) {
  if (!good) std::abort();
}

void Check(int choice, std::span<const std::byte> bytes) {
  const auto type = static_cast<MessageType>(choice % kMessageTypes);
  const Result<Message> message = Decode(type, bytes, "CHANNEL");
  if (!message) return Require(!message.fault().text.empty() && message.fault().offset >= 0);
  Bytes again;
  Encode(*message, again);
  const Result<Message> twice = Decode(type, again, "CHANNEL");
  Require(twice.has_value());
  Bytes thrice;
  Encode(*twice, thrice);
  Require(again == thrice && again.size() == bytes.size());
}

}  // namespace

namespace fuzz {

std::vector<std::vector<std::uint8_t>> Seeds() {
  std::vector<std::vector<std::uint8_t>> seeds;
  for (const Message& message : Messages()) {
    Bytes bytes;
    Encode(message, bytes);
    auto& seed = seeds.emplace_back(1, static_cast<std::uint8_t>(message.index()));
    for (const std::byte b : bytes) seed.push_back(static_cast<std::uint8_t>(b));
  }
  return seeds;
}

}  // namespace fuzz
}  // namespace wellgyro

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size > 0) wellgyro::Check(data[0], std::as_bytes(std::span(data, size)).subspan(1));
  return 0;
}

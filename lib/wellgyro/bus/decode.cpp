#include "wellgyro/bus/decode.h"

#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "wellgyro/bus/batch_internal.h"
#include "wellgyro/bus/said_fields_internal.h"

namespace wellgyro {
namespace {

template <class Record, class... Extra>
std::optional<Fault> Read(std::span<const std::byte> bytes, Record& record, Extra&... extra) {
  FieldReader reader(bytes, kFingerprintSize);
  Fields(reader, record, extra...);
  return reader.Finish();
}

template <class Record>
Result<Message> Plain(std::span<const std::byte> bytes) {
  Record record;
  if (std::optional<Fault> fault = Read(bytes, record)) return *std::move(fault);
  return Message(std::move(record));
}

Result<Message> Still(std::span<const std::byte> bytes) {
  StillWindow window;
  std::int64_t duration_ns = 0;
  if (std::optional<Fault> fault = Read(bytes, window, duration_ns)) return *std::move(fault);
  window.utc_end = window.utc_begin + Duration{duration_ns};
  window.seq_end = window.seq_begin;
  return Message(std::move(window));
}

void MirrorUpper(Eigen::Matrix3d& cov) {
  for (int row = 1; row < 3; ++row) {
    for (int column = 0; column < row; ++column) cov(row, column) = cov(column, row);
  }
}

Result<Message> SurveyStation(std::span<const std::byte> bytes) {
  SentStation sent;
  std::int32_t quality = 0;
  if (std::optional<Fault> fault = Read(bytes, sent, quality)) return *std::move(fault);
  sent.station.quality = static_cast<Quality>(quality);
  MirrorUpper(sent.station.cov_md_inc_azi);
  MirrorUpper(sent.station.cov_p_WT_W);
  DeriveTangent(sent.station);
  return Message(std::move(sent));
}

Result<Message> Operation(std::span<const std::byte> bytes) {
  SignedOperation operation;
  std::int32_t n_key = 0, n_content = 0, n_signature = 0;
  if (std::optional<Fault> fault = Read(bytes, operation, n_key, n_content, n_signature)) {
    return *std::move(fault);
  }
  return Message(std::move(operation));
}

Result<Message> Imu(std::span<const std::byte> bytes, std::string_view channel) {
  ImuBatch batch;
  auto samples = DecodeImuBatch(bytes, batch.samples, channel);
  if (!samples) return samples.fault();
  return Message(std::move(batch));
}

Result<Message> Raw(std::span<const std::byte> bytes, std::string_view channel) {
  RawBatch batch;
  auto samples = DecodeRawBatch(bytes, batch.samples, channel);
  if (!samples) return samples.fault();
  return Message(std::move(batch));
}

Result<Message> DecodeCold(MessageType type, std::span<const std::byte> bytes) {
  switch (type) {
    case MessageType::kStillWindow:
      return Still(bytes);
    case MessageType::kDepth:
      return Plain<DepthMark>(bytes);
    case MessageType::kToolMode:
      return Plain<ToolMode>(bytes);
    case MessageType::kToolInfo:
      return Plain<ToolInfo>(bytes);
    case MessageType::kEvent:
      return Plain<Event>(bytes);
    case MessageType::kCommand:
      return Plain<Command>(bytes);
    case MessageType::kStation:
      return SurveyStation(bytes);
    case MessageType::kStatus:
      return Plain<Status>(bytes);
    case MessageType::kOperation:
      return Operation(bytes);
    case MessageType::kGlance:
      return Plain<Glance>(bytes);
    case MessageType::kAdvice:
      return Plain<Advice>(bytes);
    case MessageType::kRequest:
      return Plain<StationRequest>(bytes);
    case MessageType::kRawBatch:
    case MessageType::kImuBatch:
      break;
  }
  return Fault{FaultCode::kForeign, "is of no type of ours", {}};
}

}  // namespace

std::optional<Fault> CheckFingerprint(MessageType expected, std::span<const std::byte> bytes) {
  if (bytes.size() < kFingerprintSize) {
    return Fault{
        FaultCode::kSize,
        fmt::format("has {} bytes, its fingerprint alone needs {}", bytes.size(), kFingerprintSize),
        {},
        0};
  }
  const auto found = Load<std::uint64_t>(bytes.data());
  if (found == Fingerprint(expected)) return std::nullopt;
  const std::optional<MessageType> type = TypeOf(bytes);
  return Fault{FaultCode::kFingerprint,
               fmt::format("is expected with fingerprint 0x{:016x}, the message has 0x{:016x}{}",
                           Fingerprint(expected), found,
                           type ? fmt::format(" and is a {}", TypeName(*type))
                                : ", a type or a version of a type that is unknown here"),
               {},
               0};
}

Fault Placed(Fault fault, MessageType type, std::string_view channel) {
  fault.text = channel.empty() ? fmt::format("{} {}", TypeName(type), fault.text)
                               : fmt::format("{}: {} {}", channel, TypeName(type), fault.text);
  fault.source = channel;
  return fault;
}

Result<Message> Decode(MessageType expected, std::span<const std::byte> bytes,
                       std::string_view channel) {
  if (expected == MessageType::kImuBatch) return Imu(bytes, channel);
  if (expected == MessageType::kRawBatch) return Raw(bytes, channel);
  if (std::optional<Fault> fault = CheckFingerprint(expected, bytes)) {
    return Placed(*std::move(fault), expected, channel);
  }
  Result<Message> message = DecodeCold(expected, bytes);
  if (!message) return Placed(message.fault(), expected, channel);
  return message;
}

}  // namespace wellgyro

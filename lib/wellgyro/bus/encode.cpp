#include "wellgyro/bus/encode.h"

#include <type_traits>

#include "wellgyro/bus/bytes_internal.h"
#include "wellgyro/bus/field_writer_internal.h"
#include "wellgyro/bus/said_fields_internal.h"

namespace wellgyro {
namespace {

template <class Record, class... Extra>
void Write(MessageType type, const Record& record, std::vector<std::byte>& bytes,
           const Extra&... extra) {
  bytes.clear();
  bytes.resize(sizeof(std::uint64_t));
  Store(bytes.data(), Fingerprint(type));
  FieldWriter writer(bytes);
  Fields(writer, record, extra...);
}

}  // namespace

void Encode(const StillWindow& window, std::vector<std::byte>& bytes) {
  const Duration duration =
      window.samples > 0 ? window.end - window.begin : window.utc_end - window.utc_begin;
  Write(MessageType::kStillWindow, window, bytes, duration.ns);
}

void Encode(const DepthMark& mark, std::vector<std::byte>& bytes) {
  Write(MessageType::kDepth, mark, bytes);
}

void Encode(const ToolMode& mode, std::vector<std::byte>& bytes) {
  Write(MessageType::kToolMode, mode, bytes);
}

void Encode(const ToolInfo& info, std::vector<std::byte>& bytes) {
  Write(MessageType::kToolInfo, info, bytes);
}

void Encode(const Event& event, std::vector<std::byte>& bytes) {
  Write(MessageType::kEvent, event, bytes);
}

void Encode(const Command& command, std::vector<std::byte>& bytes) {
  Write(MessageType::kCommand, command, bytes);
}

void Encode(const SentStation& station, std::vector<std::byte>& bytes) {
  Write(MessageType::kStation, station, bytes, static_cast<std::int32_t>(station.station.quality));
}

void Encode(const Status& status, std::vector<std::byte>& bytes) {
  Write(MessageType::kStatus, status, bytes);
}

void Encode(const SignedOperation& operation, std::vector<std::byte>& bytes) {
  const auto size = [](const std::vector<std::byte>& part) {
    return static_cast<std::int32_t>(part.size());
  };
  Write(MessageType::kOperation, operation, bytes, size(operation.key), size(operation.content),
        size(operation.signature));
}

void Encode(const Glance& glance, std::vector<std::byte>& bytes) {
  Write(MessageType::kGlance, glance, bytes);
}

void Encode(const Advice& advice, std::vector<std::byte>& bytes) {
  Write(MessageType::kAdvice, advice, bytes);
}

void Encode(const StationRequest& request, std::vector<std::byte>& bytes) {
  Write(MessageType::kRequest, request, bytes);
}

void Encode(const Message& message, std::vector<std::byte>& bytes) {
  std::visit(
      [&bytes](const auto& record) {
        using Record = std::remove_cvref_t<decltype(record)>;
        if constexpr (std::is_same_v<Record, ImuBatch> || std::is_same_v<Record, RawBatch>) {
          Encode(std::span(record.samples), bytes);
        } else {
          Encode(record, bytes);
        }
      },
      message);
}

}  // namespace wellgyro

#include <array>

#include "wellgyro/advice_t.hpp"
#include "wellgyro/bus/bytes_internal.h"
#include "wellgyro/bus/message.h"
#include "wellgyro/depth_t.hpp"
#include "wellgyro/event_t.hpp"
#include "wellgyro/glance_t.hpp"
#include "wellgyro/imu_batch_t.hpp"
#include "wellgyro/operation_t.hpp"
#include "wellgyro/raw_batch_t.hpp"
#include "wellgyro/request_t.hpp"
#include "wellgyro/status_t.hpp"
#include "wellgyro/still_window_t.hpp"
#include "wellgyro/survey_cmd_t.hpp"
#include "wellgyro/survey_station_t.hpp"
#include "wellgyro/tool_info_t.hpp"
#include "wellgyro/tool_mode_t.hpp"

namespace wellgyro {
namespace {

struct Identity {
  std::string_view name;
  std::uint64_t fingerprint;
};

template <class T>
Identity IdentityOf() {
  return {T::getTypeName(), static_cast<std::uint64_t>(T::getHash())};
}

const std::array<Identity, kMessageTypes>& Identities() {
  static const std::array<Identity, kMessageTypes> identities = {
      IdentityOf<raw_batch_t>(), IdentityOf<imu_batch_t>(),  IdentityOf<still_window_t>(),
      IdentityOf<depth_t>(),     IdentityOf<tool_mode_t>(),  IdentityOf<tool_info_t>(),
      IdentityOf<event_t>(),     IdentityOf<survey_cmd_t>(), IdentityOf<survey_station_t>(),
      IdentityOf<status_t>(),    IdentityOf<operation_t>(),  IdentityOf<glance_t>(),
      IdentityOf<request_t>(),   IdentityOf<advice_t>(),
  };
  return identities;
}

}  // namespace

std::string_view TypeName(MessageType type) {
  return Identities().at(static_cast<std::size_t>(type)).name;
}

std::uint64_t Fingerprint(MessageType type) {
  return Identities().at(static_cast<std::size_t>(type)).fingerprint;
}

std::optional<MessageType> TypeOf(std::span<const std::byte> message) {
  if (message.size() < sizeof(std::uint64_t)) return std::nullopt;
  const auto fingerprint = Load<std::uint64_t>(message.data());
  for (std::size_t i = 0; i < kMessageTypes; ++i) {
    if (Identities()[i].fingerprint == fingerprint) return static_cast<MessageType>(i);
  }
  return std::nullopt;
}

}  // namespace wellgyro

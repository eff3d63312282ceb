#include "wellgyro/bus/message.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include <fmt/format.h>

#include "wellgyro/bus/glance_channel.h"
#include "wellgyro/record/limits.h"

namespace wellgyro {
namespace {

struct Place {
  std::string Channels::*name;
  const char* field;
};

constexpr std::size_t kChannels = 10;  // all members of Channels

// In the order of MessageType. Later types share the channel of an older one.
constexpr std::array<Place, kChannels> kPlaces = {{
    {&Channels::raw, "raw"},
    {&Channels::imu, "imu"},
    {&Channels::still, "still"},
    {&Channels::depth, "depth"},
    {&Channels::mode, "mode"},
    {&Channels::tool, "tool"},
    {&Channels::event, "event"},
    {&Channels::command, "command"},
    {&Channels::station, "station"},
    {&Channels::status, "status"},
}};

bool IsControl(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }

}  // namespace

std::string GlanceChannel(const Channels& channels) { return channels.status + "_GLANCE"; }
std::string AdviceChannel(const Channels& channels) { return channels.status + "_ADVICE"; }

const std::string& NameOf(const Channels& channels, MessageType type) {
  if (type == MessageType::kGlance || type == MessageType::kAdvice) return channels.status;
  if (type == MessageType::kOperation || type == MessageType::kRequest) return channels.command;
  return channels.*kPlaces.at(static_cast<std::size_t>(type)).name;
}

std::optional<MessageType> TypeOn(const Channels& channels, std::string_view name) {
  for (std::size_t i = 0; i < kPlaces.size(); ++i) {
    if (channels.*kPlaces[i].name == name) return static_cast<MessageType>(i);
  }
  return std::nullopt;
}

std::optional<MessageType> TypeOn(const Channels& channels, std::string_view name,
                                  std::span<const std::byte> bytes) {
  const std::optional<MessageType> type = TypeOn(channels, name);
  if (!type && name == GlanceChannel(channels)) return MessageType::kGlance;
  if (!type && name == AdviceChannel(channels)) return MessageType::kAdvice;
  if (type != MessageType::kCommand) return type;
  const std::optional<MessageType> said = TypeOf(bytes);
  return said && NameOf(channels, *said) == name ? said : type;
}

void Validate(const Channels& channels) {
  for (std::size_t i = 0; i < kPlaces.size(); ++i) {
    const std::string& name = channels.*kPlaces[i].name;
    if (name.empty() || name.size() > limits::kChannel ||
        std::any_of(name.begin(), name.end(), IsControl)) {
      throw std::invalid_argument(
          fmt::format("channels.{} = \"{}\": a channel name has 1 to {} bytes and no control "
                      "characters",
                      kPlaces[i].field, name, limits::kChannel));
    }
    for (std::size_t k = 0; k < i; ++k) {
      if (channels.*kPlaces[k].name != name) continue;
      throw std::invalid_argument(fmt::format("channels.{} and channels.{} are both \"{}\"",
                                              kPlaces[k].field, kPlaces[i].field, name));
    }
  }
}

}  // namespace wellgyro

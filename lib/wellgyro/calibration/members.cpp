#include "wellgyro/calibration/members.h"

#include <charconv>
#include <stdexcept>
#include <string_view>

#include <fmt/core.h>

namespace wellgyro {
namespace {

using Kind = CalibrationMember::Kind;

struct KindName {
  Kind kind;
  std::string_view name;
  bool powers, columns;
  int n_columns;
};
constexpr KindName kKinds[] = {
    {Kind::kBias, "bias", true, false, 1},
    {Kind::kSensitivity, "sensitivity", true, true, 3},
    {Kind::kForce, "g_dependence", true, true, 3},
    {Kind::kSecondOrder, "second_order", false, true, 6},
    {Kind::kForceSquare, "g_squared", false, true, 6},
    {Kind::kHeating, "heating", false, false, 1},
};

// Takes `text` off the begin of what is left.
bool Take(std::string_view& left, std::string_view text) {
  if (!left.starts_with(text)) return false;
  left.remove_prefix(text.size());
  return true;
}

bool TakeNumber(std::string_view& left, int limit, int& number) {
  const auto [end, error] = std::from_chars(left.data(), left.data() + left.size(), number);
  if (error != std::errc() || number < 0 || number >= limit) return false;
  left.remove_prefix(static_cast<std::size_t>(end - left.data()));
  return true;
}

}  // namespace

std::string NameOf(const CalibrationMember& member) {
  for (const KindName& kind : kKinds) {
    if (kind.kind != member.kind) continue;
    return fmt::format("{}.{}{}[{}{}]", member.is_gyro ? "gyro" : "accel", kind.name,
                       kind.powers ? fmt::format(".p{}", member.power) : "", member.channel,
                       kind.columns ? fmt::format(",{}", member.column) : "");
  }
  return {};
}

CalibrationMember MemberOf(const std::string& name) {
  CalibrationMember member;
  std::string_view left = name;
  member.is_gyro = Take(left, "gyro.");
  if (member.is_gyro || Take(left, "accel.")) {
    for (const KindName& kind : kKinds) {
      std::string_view rest = left;
      if (!Take(rest, kind.name)) continue;
      member.kind = kind.kind;
      const bool whole =
          (!kind.powers ||
           (Take(rest, ".p") && TakeNumber(rest, SensorGroup::kPowers, member.power))) &&
          Take(rest, "[") && TakeNumber(rest, SensorGroup::kChannels, member.channel) &&
          (!kind.columns || (Take(rest, ",") && TakeNumber(rest, kind.n_columns, member.column))) &&
          rest == "]";
      if (whole) return member;
    }
  }
  throw std::invalid_argument(fmt::format("\"{}\" names no number of a tool model", name));
}

double& ValueOf(ToolCalibration& tool, const CalibrationMember& member) {
  SensorGroup& group = member.is_gyro ? tool.gyro : tool.accel;
  const auto power = static_cast<std::size_t>(member.power);
  switch (member.kind) {
    case Kind::kBias:
      return group.bias[power][member.channel];
    case Kind::kSensitivity:
      return group.sensitivity[power](member.channel, member.column);
    case Kind::kForce:
      return group.g_dependence[power](member.channel, member.column);
    case Kind::kSecondOrder:
      return group.second_order(member.channel, member.column);
    case Kind::kForceSquare:
      return group.g_squared(member.channel, member.column);
    case Kind::kHeating:
      break;
  }
  return group.heating[member.channel];
}

double ValueOf(const ToolCalibration& tool, const CalibrationMember& member) {
  // Nothing is written through it.
  return ValueOf(const_cast<ToolCalibration&>(tool), member);
}

}  // namespace wellgyro

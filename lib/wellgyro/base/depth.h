#pragma once

#include <cstdint>

namespace wellgyro {

/// What measured a depth. A measured depth without its kind is half a number: wireline and
/// driller's depths of one bed differ by metres.
enum class DepthKind : std::int32_t {
  kIndicated = 0,
  kWireline = 1,
  kDrillPipe = 2,
  kTubing = 3,
  kOther = 4,
};

}  // namespace wellgyro

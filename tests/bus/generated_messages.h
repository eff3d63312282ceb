#pragma once

#include <cstddef>
#include <ostream>
#include <string>
#include <vector>

#include "wellgyro/advice_t.hpp"
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

/// Messages made with the classes that lcm-gen writes: the oracle for our own readers and writers.
/// Every field has a value of its own, so that two exchanged fields do not go unseen.
namespace wellgyro::test {

inline constexpr std::int64_t kUtimeUs = 1'760'000'000'123'456;

using Bytes = std::vector<std::byte>;

template <class Generated>
Bytes BytesOf(const Generated& message) {
  Bytes bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

imu_batch_t GeneratedImu(int n, bool gz, bool mag);
raw_batch_t GeneratedRaw(int n, int channels, int temperatures);
still_window_t GeneratedStill();
depth_t GeneratedDepth();
tool_mode_t GeneratedMode();
tool_info_t GeneratedTool();
event_t GeneratedEvent();
survey_cmd_t GeneratedCommand();
survey_station_t GeneratedStation();
status_t GeneratedStatus();
operation_t GeneratedOperation();
glance_t GeneratedGlance();
advice_t GeneratedAdvice();
request_t GeneratedRequest();

struct Sample {
  MessageType type;
  Bytes bytes;

  friend void PrintTo(const Sample& sample, std::ostream* out) {
    *out << TypeName(sample.type) << " of " << sample.bytes.size() << " bytes";
  }
};

/// One good message of every type.
std::vector<Sample> OneOfEach();

}  // namespace wellgyro::test

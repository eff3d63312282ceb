#pragma once

#include <cstdint>
#include <variant>
#include <vector>

#include "wellgyro/bus/feed.h"
#include "wellgyro/record/advice.h"
#include "wellgyro/record/depth.h"
#include "wellgyro/record/glance.h"
#include "wellgyro/record/operations.h"
#include "wellgyro/record/sample.h"
#include "wellgyro/record/station.h"

namespace wellgyro {

struct RawBatch {
  std::vector<RawSample> samples;
};

struct ImuBatch {
  std::vector<ImuSample> samples;
};

/// A station as it travels. `tool`, `tool_time`, `pass_number` and `dogleg_severity` of the record
/// do not; they are zero on arrival.
struct SentStation {
  Station station;
  std::int64_t seq = 0;
  std::int32_t session = 0;
};

/// Any message of proto/ as a record. Of a StillWindow that travelled, `seq_begin` and `seq_end`
/// are the message's number and `samples` is zero.
using Message =
    std::variant<RawBatch, ImuBatch, StillWindow, DepthMark, ToolMode, ToolInfo, Event, Command,
                 SentStation, Status, SignedOperation, Glance, StationRequest, Advice>;

}  // namespace wellgyro

#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "wellgyro/base/time.h"

namespace wellgyro {

/// Health of one program, sent once a second. Values are those of status_t.
struct Status {
  enum class State : std::int32_t { kOk = 0, kDegraded = 1, kFault = 2 };
  UtcTime utc;
  std::int64_t seq = 0;
  std::int32_t session = 0;
  State state = State::kOk;
  std::int32_t last_command_id = 0;  ///< acknowledges that command; 0 if none
  std::int64_t samples_received = 0;
  std::int64_t samples_lost = 0;  ///< by sequence number
  std::int64_t gaps = 0;
  std::int64_t duplicates = 0;
  std::int64_t malformed = 0;                ///< messages of wrong fingerprint, size or range
  std::optional<std::int64_t> kernel_drops;  ///< datagrams that the system threw away
  double latency_p99 = 0;                    ///< [s]
  double data_age = 0;                       ///< [s]
  std::string text;
};

}  // namespace wellgyro

#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "wellgyro/base/result.h"
#include "wellgyro/bus/lcm_live.h"

/// What the commands that speak with a live bus share.
namespace wellgyro::apps {

/// Whether an option's value means a live bus: an LCM URL, or nothing for the default one.
bool IsLive(const std::string& from);

/// `from`, or LCM_DEFAULT_URL, or LCM's own default.
std::string UrlOr(const std::string& from);

std::int64_t NowUs();        ///< UTC since 1970 [us]
std::int64_t MonotonicUs();  ///< for lengths of time [us]

/// Says on standard error what is listened to and what buffer the system grants for it.
void SayHowHeard(const LiveBus& bus);

/// After a stop: hands on what had come, until nothing more does for `quiet_ms`, for `most_us` at
/// most.
void DrainStopped(LiveBus& bus, int quiet_ms, std::int64_t most_us);

/// While it lives, SIGINT and SIGTERM stop the bus, and SIGPIPE does nothing. One at a time.
class StopOnSignals {
 public:
  explicit StopOnSignals(LiveBus& bus);
  ~StopOnSignals();
  StopOnSignals(const StopOnSignals&) = delete;
  StopOnSignals& operator=(const StopOnSignals&) = delete;
};

/// Says faults as they come: the first ten of each code, then one a second with how many there
/// were.
class FaultTeller {
 public:
  void Tell(const Fault& fault);

 private:
  struct Count {
    std::int64_t told = 0, untold = 0;
    std::int64_t last_us = 0;
  };
  std::map<FaultCode, Count> counts_;
};

}  // namespace wellgyro::apps

#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "wellgyro/base/result.h"
#include "wellgyro/bus/lcm_live.h"
#include "wellgyro/live/observer.h"
#include "wellgyro/record/channels.h"

/// What the commands that speak with a live bus share.
namespace wellgyro::apps {

/// Whether an option's value means a live bus: an LCM URL, or nothing for the default one.
bool IsLive(const std::string& from);

/// `from`, or LCM_DEFAULT_URL, or LCM's own default.
std::string UrlOr(const std::string& from);

/// The channels of this job, the usual ones where none is named; nothing where it cannot be read,
/// which is said.
std::optional<Channels> ChannelsOf(const std::string& job);

std::int64_t NowUs();        ///< UTC since 1970 [us]
std::int64_t MonotonicUs();  ///< for lengths of time [us]
LiveClock ThisClock();       ///< both

/// Tells the service manager that started this program, if one did (sd_notify(3)): "READY=1".
void NotifyManager(std::string_view state);

/// Says on standard error what is listened to and what buffer the system grants for it.
void SayHowHeard(const LiveBus& bus);

/// After a stop: hands on what had come, until nothing more does for `quiet_ms`, for `most_us` at
/// most.
void DrainStopped(LiveBus& bus, int quiet_ms, std::int64_t most_us);

/// While it lives, SIGINT and SIGTERM call `stop`, which must be fit for a signal handler; SIGPIPE
/// and the SIGHUP of a terminal that goes away do nothing. One at a time.
class StopOnSignals {
 public:
  explicit StopOnSignals(std::function<void()> stop);
  explicit StopOnSignals(LiveBus& bus) : StopOnSignals([&bus] { bus.Stop(); }) {}
  ~StopOnSignals();
  StopOnSignals(const StopOnSignals&) = delete;
  StopOnSignals& operator=(const StopOnSignals&) = delete;

 private:
  std::function<void()> stop_;
};

}  // namespace wellgyro::apps

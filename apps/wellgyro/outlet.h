#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "wellgyro/base/result.h"
#include "wellgyro/record/channels.h"

namespace wellgyro::apps {

/// Where simulated messages go: a log, or a live bus at the pace of its receivers.
class Outlet {
 public:
  virtual ~Outlet() = default;
  /// `utime_us`: when the message is known, by the clock of the simulation.
  virtual std::optional<Fault> Write(const std::string& channel, std::span<const std::byte> bytes,
                                     std::int64_t utime_us) = 0;
  virtual std::optional<Fault> Close() = 0;
  virtual bool stopped() const { return false; }  ///< by a signal

  /// How many samples, overlaps counted once, the next Write brings it to.
  void CountSamples(std::int64_t samples) { samples_ = samples; }

  std::int64_t events() const { return events_; }
  std::int64_t bytes() const { return bytes_; }

 protected:
  std::int64_t events_ = 0, bytes_ = 0, samples_ = 0;
};

Result<std::unique_ptr<Outlet>> OpenLogOutlet(const std::string& path);

/// `speed`: simulated seconds a second; 0: as fast as receivers keep up, which is when the
/// messages have come back to us and no survey that sends its status is far behind.
Result<std::unique_ptr<Outlet>> OpenLiveOutlet(const std::string& url, const Channels& channels,
                                               double speed);

}  // namespace wellgyro::apps

#include "outlet.h"

#include <algorithm>
#include <functional>
#include <set>
#include <string>
#include <utility>

#include "wellgyro/bus/feed.h"
#include "wellgyro/bus/lcm_live.h"
#include "wellgyro/bus/log_writer.h"

#include "live.h"

namespace wellgyro::apps {
namespace {

// Messages on their way at most: 64 of 4 kB are half of what the smallest receive buffer holds.
constexpr std::int64_t kInFlight = 15;
constexpr std::int64_t kEchoPatienceUs = 1'000'000;
constexpr std::int64_t kStatusPatienceUs = 3'000'000;
constexpr std::int64_t kAhead = 2'000'000;  // samples that a survey may lag behind

class LogOutlet : public Outlet {
 public:
  explicit LogOutlet(LogWriter log) : log_(std::move(log)) {}
  std::optional<Fault> Write(const std::string& channel, std::span<const std::byte> bytes,
                             std::int64_t utime_us) override {
    auto fault = log_.Write(channel, bytes, utime_us);
    events_ = log_.events();
    bytes_ = log_.bytes();
    return fault;
  }
  std::optional<Fault> Close() override { return log_.Close(); }

 private:
  LogWriter log_;
};

/// Hears our own messages come back, and how far surveys have got.
class LiveOutlet : public Outlet, private Listener {
 public:
  LiveOutlet(LiveBus bus, const Channels& channels, double speed)
      : bus_(std::move(bus)), stop_(bus_), speed_(speed), feed_(channels, *this) {}

  std::optional<Fault> Begin() {
    return bus_.Subscribe(
        {}, [this](std::string_view channel, std::span<const std::byte> data, std::int64_t) {
          if (channel == feed_.channels().status) {
            feed_.Take(channel, data);
          } else if (ours_.contains(channel)) {
            ++echoes_;
          }
        });
  }

  std::optional<Fault> Write(const std::string& channel, std::span<const std::byte> bytes,
                             std::int64_t utime_us) override {
    if (auto fault = speed_ > 0 ? Pace(utime_us) : KeepUp()) return fault;
    if (stopped_) return std::nullopt;
    ours_.insert(channel);
    if (auto fault = bus_.Publish(channel, bytes)) return fault;
    ++events_;
    bytes_ += static_cast<std::int64_t>(bytes.size());
    return std::nullopt;
  }
  /// A connection that is closed with echoes unread is reset, and what the broker has not yet read
  /// of ours goes with it.
  std::optional<Fault> Close() override {
    std::int64_t begin = MonotonicUs();
    while (!stopped_ && echoes_ < events_ && MonotonicUs() - begin < kEchoPatienceUs) {
      const std::int64_t before = echoes_;
      if (auto fault = Wait(10)) return fault;
      if (echoes_ > before) begin = MonotonicUs();
    }
    return std::nullopt;
  }
  bool stopped() const override { return stopped_; }

 private:
  void OnStatus(const Status& status) override {
    status_us_ = MonotonicUs();
    if (!first_received_) first_received_ = status.samples_received - samples_;
    survey_samples_ = status.samples_received - *first_received_;
  }

  std::optional<Fault> Pace(std::int64_t utime_us) {
    if (events_ == 0) {
      begin_us_ = MonotonicUs();
      begin_utime_us_ = utime_us;
    }
    const auto due = begin_us_ + static_cast<std::int64_t>(
                                     static_cast<double>(utime_us - begin_utime_us_) / speed_);
    while (!stopped_) {
      const std::int64_t ahead = due - MonotonicUs();
      // Nothing must gather on our own side, however fast we are.
      if (auto fault = Wait(ahead > 0 ? static_cast<int>(ahead / 1000) : 0)) return fault;
      if (due - MonotonicUs() < 1000) break;
    }
    return std::nullopt;
  }

  std::optional<Fault> KeepUp() {
    const std::int64_t begin = MonotonicUs();
    while (!stopped_) {
      const std::int64_t now = MonotonicUs();
      const bool echo = events_ - echoes_ < kInFlight || now - begin > kEchoPatienceUs;
      const bool survey =
          samples_ - survey_samples_ < kAhead || now - status_us_ > kStatusPatienceUs;
      if (echo && survey) break;
      if (auto fault = Wait(echo ? 10 : 1)) return fault;
    }
    return std::nullopt;
  }

  std::optional<Fault> Wait(int ms) {
    const auto woken = bus_.Wait(ms);
    if (!woken) return woken.fault();
    stopped_ = stopped_ || *woken == LiveBus::Woken::kStopped;
    return std::nullopt;
  }

  LiveBus bus_;
  StopOnSignals stop_;
  double speed_;
  Feed feed_;
  bool stopped_ = false;
  std::set<std::string, std::less<>> ours_;  ///< channels
  std::int64_t begin_us_ = 0, begin_utime_us_ = 0;
  std::int64_t echoes_ = 0;
  std::int64_t survey_samples_ = 0, status_us_ = -kStatusPatienceUs;
  std::optional<std::int64_t> first_received_;
};

}  // namespace

Result<std::unique_ptr<Outlet>> OpenLogOutlet(const std::string& path) {
  Result<LogWriter> log = LogWriter::Open(path, IfExists::kReplace);
  if (!log) return log.fault();
  return std::unique_ptr<Outlet>(std::make_unique<LogOutlet>(std::move(*log)));
}

Result<std::unique_ptr<Outlet>> OpenLiveOutlet(const std::string& url, const Channels& channels,
                                               double speed) {
  Result<LiveBus> bus = LiveBus::Open(url);
  if (!bus) return bus.fault();
  auto outlet = std::make_unique<LiveOutlet>(std::move(*bus), channels, speed);
  if (auto fault = outlet->Begin()) return *std::move(fault);
  return std::unique_ptr<Outlet>(std::move(outlet));
}

}  // namespace wellgyro::apps

#include "live.h"

#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>

#include <fmt/core.h>

#include "report.h"

namespace wellgyro::apps {
namespace {

constexpr std::int64_t kToldAtOnce = 10;
constexpr std::int64_t kSecond = 1'000'000;

constexpr std::array<int, 2> kSignals = {SIGINT, SIGTERM};

// A signal handler has no other way to know whom it concerns.
std::atomic<LiveBus*> to_stop = nullptr;

void Stop(int /*signal*/) {
  if (LiveBus* bus = to_stop.load()) bus->Stop();
}

void Handle(int signal, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  sigaction(signal, &action, nullptr);
}

template <class Clock>
std::int64_t Microseconds() {
  using std::chrono::duration_cast, std::chrono::microseconds;
  return duration_cast<microseconds>(Clock::now().time_since_epoch()).count();
}

}  // namespace

bool IsLive(const std::string& from) {
  return from.empty() || from.find("://") != std::string::npos;
}

std::string UrlOr(const std::string& from) {
  if (!from.empty()) return from;
  const char* set = std::getenv("LCM_DEFAULT_URL");
  return set != nullptr && *set != '\0' ? set : kDefaultLcmUrl;
}

std::int64_t NowUs() { return Microseconds<std::chrono::system_clock>(); }
std::int64_t MonotonicUs() { return Microseconds<std::chrono::steady_clock>(); }

void SayHowHeard(const LiveBus& bus) {
  fmt::print(stderr, "listening on {}\n", bus.url());
  const std::optional<int> granted = bus.granted_receive_buffer();
  if (!granted) return;
  const int asked = bus.asked_receive_buffer();
  fmt::print(stderr, "receive buffer: {} bytes asked, {} granted\n", asked, *granted);
  if (*granted >= asked) return;
  fmt::print(stderr,
             "a longer stall than that buffer lasts loses messages; as root: "
             "sysctl -w net.core.rmem_max={}\n",
             asked);
}

void DrainStopped(LiveBus& bus, int quiet_ms, std::int64_t most_us) {
  const std::int64_t end = MonotonicUs() + most_us;
  while (MonotonicUs() < end) {
    const auto drained = bus.Drain(1, quiet_ms);
    if (!drained || *drained == 0) return;
  }
}

StopOnSignals::StopOnSignals(LiveBus& bus) {
  to_stop = &bus;
  for (const int signal : kSignals) Handle(signal, Stop);
  Handle(SIGPIPE, SIG_IGN);
}

StopOnSignals::~StopOnSignals() {
  for (const int signal : kSignals) Handle(signal, SIG_DFL);
  to_stop = nullptr;
}

void FaultTeller::Tell(const Fault& fault) {
  Count& count = counts_[fault.code];
  const std::int64_t now = MonotonicUs();
  if (count.told >= kToldAtOnce && now - count.last_us < kSecond) {
    ++count.untold;
    return;
  }
  Complain(fault);
  if (count.untold > 0) Complain(fmt::format("and {} more of this kind before", count.untold));
  count.untold = 0;
  ++count.told;
  count.last_us = now;
}

}  // namespace wellgyro::apps

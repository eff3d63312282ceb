#include "live.h"

#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <utility>

#include <fmt/core.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "wellgyro/io/toml/job_file.h"

#include "report.h"

namespace wellgyro::apps {
namespace {

constexpr std::array<int, 2> kSignals = {SIGINT, SIGTERM};

// A signal handler has no other way to know whom it concerns.
std::atomic<const std::function<void()>*> to_call = nullptr;

void Stop(int /*signal*/) {
  if (const auto* stop = to_call.load()) (*stop)();
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

std::optional<Channels> ChannelsOf(const std::string& job) {
  if (job.empty()) return Channels{};
  const Result<JobFile> read = ReadJob(job);
  if (read) return read->job.channels;
  Complain(read.fault());
  return std::nullopt;
}

std::int64_t NowUs() { return Microseconds<std::chrono::system_clock>(); }
std::int64_t MonotonicUs() { return Microseconds<std::chrono::steady_clock>(); }

LiveClock ThisClock() { return {NowUs, MonotonicUs}; }

void NotifyManager(std::string_view state) {
  const char* name = std::getenv("NOTIFY_SOCKET");
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (name == nullptr || std::strlen(name) >= sizeof address.sun_path) return;
  std::strcpy(address.sun_path, name);
  const std::size_t size = offsetof(sockaddr_un, sun_path) + std::strlen(name);
  // A name that begins with @ is in no file system.
  if (address.sun_path[0] == '@') address.sun_path[0] = '\0';
  const int descriptor = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (descriptor < 0) return;
  ::sendto(descriptor, state.data(), state.size(), MSG_NOSIGNAL | MSG_DONTWAIT,
           reinterpret_cast<const sockaddr*>(&address), static_cast<socklen_t>(size));
  ::close(descriptor);
}

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

StopOnSignals::StopOnSignals(std::function<void()> stop) : stop_(std::move(stop)) {
  to_call = &stop_;
  for (const int signal : kSignals) Handle(signal, Stop);
  for (const int signal : {SIGPIPE, SIGHUP}) Handle(signal, SIG_IGN);
}

StopOnSignals::~StopOnSignals() {
  for (const int signal : kSignals) Handle(signal, SIG_DFL);
  to_call = nullptr;
}

}  // namespace wellgyro::apps

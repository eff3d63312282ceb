#include "wellgyro/bus/lcm_live.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <exception>
#include <list>
#include <stdexcept>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <lcm/lcm.h>
#include <poll.h>
#include <unistd.h>

#include "wellgyro/bus/lcm_url_internal.h"
#include "wellgyro/bus/log_format_internal.h"
#include "wellgyro/bus/udp_receiver_internal.h"
#include "wellgyro/record/limits.h"

namespace wellgyro {
namespace {

// Messages to ourselves, and how long each is waited for: a second in all, before what LCM hears of
// its own is said to be nothing. One alone may be lost.
constexpr int kSelfTests = 10;
constexpr int kSelfTestMs = 100;

/// LCM takes channels as regular expressions.
std::string Escaped(std::string_view channel) {
  std::string escaped;
  for (const char c : channel) {
    if (std::strchr(R"(\^$.|?*+()[]{})", c) != nullptr) escaped += '\\';
    escaped += c;
  }
  return escaped;
}

void RequireChannel(std::string_view channel) {
  if (!channel.empty() && channel.size() <= limits::kChannel) return;
  throw std::invalid_argument(
      fmt::format("channel \"{}\": a name has 1 to {} bytes", channel, limits::kChannel));
}

/// poll(2), begun again after a signal.
int Poll(std::span<pollfd> ends, int timeout_ms) {
  int ready = ::poll(ends.data(), ends.size(), timeout_ms);
  while (ready < 0 && errno == EINTR) ready = ::poll(ends.data(), ends.size(), timeout_ms);
  return ready;
}

}  // namespace

struct LiveBus::Core {
  explicit Core(LcmUrl parsed) : url(std::move(parsed)) {}
  ~Core() {
    if (lcm != nullptr) lcm_destroy(lcm);
    for (const int end : stop_pipe) {
      if (end >= 0) ::close(end);
    }
  }
  Core(const Core&) = delete;
  Core& operator=(const Core&) = delete;

  struct Subscription {
    Core* core;
    Handler handler;
    std::vector<std::string> channels;  ///< udpm only; none: every one
  };

  /// Called by liblcm, through which no exception may pass.
  static void OnMessage(const lcm_recv_buf_t* message, const char* channel, void* subscription) {
    auto& [core, handler, channels] = *static_cast<Subscription*>(subscription);
    // A datagram without the channel's NUL comes with a size of nearly 4 GiB.
    if (message->data_size > log_format::kDataMax) {
      ++core->refused;
      return;
    }
    if (core->thrown) return;  // one more message of the same lcm_handle
    try {
      const auto* data = static_cast<const std::byte*>(message->data);
      handler(channel, {data, message->data_size}, message->recv_utime);
    } catch (...) {
      core->thrown = std::current_exception();
    }
  }

  Fault Gone(const char* what) const {
    return {FaultCode::kIo, fmt::format("{}: {}", url.full, what), url.full};
  }

  /// Of what is heard; negative where nothing can be. On udpm liblcm is never asked for its own,
  /// with which it would begin to listen.
  int Descriptor() const {
    if (url.provider == "udpm") return receiver ? receiver->descriptor() : -1;
    return lcm_get_fileno(lcm);
  }

  bool Readable(int within_ms) const {
    pollfd bus{Descriptor(), POLLIN, 0};
    return bus.fd >= 0 && Poll({&bus, 1}, within_ms) > 0 && (bus.revents & POLLIN) != 0;
  }

  /// The next message of our own receiver; false: there is none.
  bool HandleHeld() {
    UdpReceiver::Held held;
    if (!receiver->Next(held)) return false;
    held_is_local = held.local;
    held_by = held.by;
    for (Subscription& subscription : subscriptions) {
      const auto& channels = subscription.channels;
      const bool wanted = channels.empty() || std::find(channels.begin(), channels.end(),
                                                        held.channel) != channels.end();
      if (wanted) subscription.handler(held.channel, held.data, held.received_us);
    }
    return true;
  }

  /// One message, which must be there: liblcm's own waiting breaks on signals.
  bool HandleOne() {
    const int result = lcm_handle(lcm);
    if (thrown) std::rethrow_exception(std::exchange(thrown, nullptr));
    return result >= 0;
  }

  std::optional<Fault> Hear(const std::vector<std::string>& channels);
  std::optional<Fault> HearByLcm(const std::vector<std::string>& channels);

  LcmUrl url;
  lcm_t* lcm = nullptr;
  std::array<int, 2> stop_pipe = {-1, -1};
  std::list<Subscription> subscriptions;
  std::optional<UdpReceiver> receiver;  ///< udpm: liblcm's own takes what would end it
  bool held_is_local = false;
  SentBy held_by;
  std::exception_ptr thrown;
  std::int64_t refused = 0;
};

/// Our own receiver, started where it is not and tested with a message as LCM's would be.
std::optional<Fault> LiveBus::Core::Hear(const std::vector<std::string>& channels) {
  if (!receiver) receiver.emplace(url);
  for (const std::string& channel : channels) receiver->Want(channel);
  if (channels.empty()) receiver->Want({});
  if (receiver->started()) return std::nullopt;
  if (auto fault = receiver->Start()) return fault;
  // Where only certain senders are heard, this one need not be among them.
  if (!url.senders.empty() || !url.interface.empty()) return std::nullopt;
  receiver->Await(kSelfTest);
  for (int i = 0; i < kSelfTests; ++i) {
    lcm_publish(lcm, kSelfTest, "", 0);
    if (receiver->Came(kSelfTestMs)) return std::nullopt;
  }
  return Gone("LCM hears none of its own messages; a firewall may drop multicast");
}

std::optional<Fault> LiveBus::Core::HearByLcm(const std::vector<std::string>& channels) {
  std::vector<std::string> patterns;
  for (const std::string& channel : channels) patterns.push_back(Escaped(channel));
  if (channels.empty()) patterns.emplace_back(".*");
  std::sort(patterns.begin(), patterns.end());
  patterns.erase(std::unique(patterns.begin(), patterns.end()), patterns.end());
  for (const std::string& pattern : patterns) {
    auto* subscription =
        lcm_subscribe(lcm, pattern.c_str(), &Core::OnMessage, &subscriptions.back());
    if (subscription == nullptr) return Gone("LCM refuses to subscribe");
    lcm_subscription_set_queue_capacity(subscription, 0);
  }
  return std::nullopt;
}

LiveBus::LiveBus(std::unique_ptr<Core> core) : core_(std::move(core)) {}
LiveBus::~LiveBus() = default;
LiveBus::LiveBus(LiveBus&&) noexcept = default;
LiveBus& LiveBus::operator=(LiveBus&&) noexcept = default;

Result<LiveBus> LiveBus::Open(const std::string& url, int receive_buffer) {
  Result<LcmUrl> parsed = ParseLcmUrl(url, receive_buffer);
  if (!parsed) return parsed.fault();
  if (parsed->provider == "udpm") {
    if (auto fault = CheckMulticastRoute(*parsed)) return *std::move(fault);
  }
  auto core = std::make_unique<Core>(std::move(*parsed));
  if (::pipe2(core->stop_pipe.data(), O_NONBLOCK | O_CLOEXEC) != 0) {
    return core->Gone(std::strerror(errno));
  }
  core->lcm = lcm_create(core->url.for_lcm.c_str());
  const bool tcpq = core->url.provider == "tcpq";
  // LCM 1.3 makes a bus even where no broker answers, and ends the process when it is used.
  if (core->lcm == nullptr || (tcpq && lcm_get_fileno(core->lcm) < 0)) {
    return core->Gone(tcpq ? "no broker answers; start one, as "
                             "java -cp lcm.jar lcm.lcm.TCPService 7700"
                           : "LCM cannot use this URL");
  }
  return LiveBus(std::move(core));
}

std::optional<Fault> LiveBus::Subscribe(const std::vector<std::string>& channels, Handler handler) {
  for (const std::string& channel : channels) RequireChannel(channel);
  core_->subscriptions.push_back({core_.get(), std::move(handler), channels});
  return core_->url.provider == "udpm" ? core_->Hear(channels) : core_->HearByLcm(channels);
}

Result<LiveBus::Woken> LiveBus::Wait(int timeout_ms, std::int64_t most) {
  std::array<pollfd, 2> ends = {
      {{core_->stop_pipe[0], POLLIN, 0}, {core_->Descriptor(), POLLIN, 0}}};
  const std::size_t count = ends[1].fd < 0 ? 1 : 2;
  if (Poll(std::span(ends).first(count), timeout_ms) < 0) {
    return core_->Gone(std::strerror(errno));
  }
  if (ends[0].revents != 0) return Woken::kStopped;
  if ((ends[1].revents & POLLIN) != 0) {
    const Result<std::int64_t> handled = Drain(most);
    if (!handled) return handled.fault();
    return Woken::kMessages;
  }
  if (ends[1].revents != 0) return core_->Gone("the connection is lost");
  return Woken::kIdle;
}

Result<std::int64_t> LiveBus::Drain(std::int64_t most, int quiet_ms) {
  std::int64_t handled = 0;
  while (handled < most && core_->Readable(quiet_ms)) {
    if (core_->receiver) {
      // As many as there are without asking the system again for each.
      while (handled < most && core_->HandleHeld()) ++handled;
      continue;
    }
    if (!core_->HandleOne()) return core_->Gone("the connection is lost");
    ++handled;
  }
  return handled;
}

void LiveBus::Stop() noexcept {
  // Only write(2): this may run in a signal handler. A full pipe says the same as one byte.
  const int before = errno;
  [[maybe_unused]] const ssize_t written = ::write(core_->stop_pipe[1], "x", 1);
  errno = before;
}

std::optional<Fault> LiveBus::Publish(std::string_view channel, std::span<const std::byte> data) {
  RequireChannel(channel);
  if (data.size() > log_format::kDataMax) {
    throw std::invalid_argument(fmt::format("channel \"{}\": {} bytes of data are more than {}",
                                            channel, data.size(), log_format::kDataMax));
  }
  const std::string name(channel);
  const int result =
      lcm_publish(core_->lcm, name.c_str(), data.data(), static_cast<unsigned int>(data.size()));
  if (result >= 0) return std::nullopt;
  return core_->Gone("a message could not be sent");
}

const std::string& LiveBus::url() const { return core_->url.full; }

std::optional<int> LiveBus::granted_receive_buffer() const {
  if (core_->url.provider != "udpm") return std::nullopt;
  return GrantedReceiveBuffer(core_->url.receive_buffer);
}

int LiveBus::asked_receive_buffer() const { return core_->url.receive_buffer; }

std::optional<std::int64_t> LiveBus::kernel_drops() const {
  if (core_->url.provider != "udpm") return std::nullopt;
  return core_->receiver ? core_->receiver->kernel_drops() : 0;
}

bool LiveBus::heard_here() const {
  if (core_->receiver) return core_->held_is_local;
  const std::string& host = core_->url.host;
  return core_->url.provider == "memq" || host == "localhost" || host.starts_with("127.");
}

SentBy LiveBus::heard_from() const {
  return core_->receiver && !core_->url.mixed ? core_->held_by : SentBy{};
}

std::string NameOf(const SentBy& by) {
  const std::uint64_t s = by.sender;
  return fmt::format("{}.{}.{}.{}:{}", s >> 40 & 255, s >> 32 & 255, s >> 24 & 255, s >> 16 & 255,
                     s & 65535);
}

std::int64_t LiveBus::refused() const {
  return core_->refused + (core_->receiver ? core_->receiver->refused() : 0);
}

std::int64_t LiveBus::strangers() const {
  return core_->receiver ? core_->receiver->foreign_senders() : 0;
}

}  // namespace wellgyro

#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"

namespace wellgyro {

/// LCM's own default, for this machine only.
inline constexpr const char* kDefaultLcmUrl = "udpm://239.255.76.67:7667?ttl=0";

/// Who sent a message, as far as the transport says.
struct SentBy {
  std::uint64_t sender = 0;  ///< IPv4 address << 16 | port, host's order; 0: it does not say
  std::uint32_t number = 0;  ///< of the message, LCM's: one more for each of a sender's
};

/// "10.0.0.5:40001".
WELLGYRO_EXPORT std::string NameOf(const SentBy& by);

/// A live LCM bus, to hear and to speak. One thread uses it; only Stop may come from elsewhere.
///
/// URLs: `udpm://GROUP:PORT` (multicast), `tcpq://HOST:PORT` (a broker), `memq://` (this process:
/// what is published waits until the same thread calls Wait or Drain). To a udpm URL that does not
/// say otherwise, `ttl=0` is added, so that nothing leaves the machine unasked, and
/// `recv_buf_size`: at 10 kHz of single samples 4 MiB outlast a stall of a second, the system's
/// default 25 ms. Multicast is heard with a socket of our own, bound to the group and the interface
/// of the route to it: what is sent to this machine alone is not heard unless the URL has
/// `unicast=1`; `interface=NAME` hears on another; `from=ADDRESS,ADDRESS` hears these senders only.
/// Whatever comes, no more than 40 MiB of it are held. liblcm does the sending, tcpq and memq.
///
/// tcpq: a broker that goes away raises SIGPIPE at the next Publish; a program should ignore it.
class WELLGYRO_EXPORT LiveBus {
 public:
  static constexpr int kReceiveBuffer = 4 << 20;  ///< [bytes]
  static constexpr int kBurst = 1000;             ///< messages that one Wait hands on at most

  /// `received_us`: when LCM got the message, for diagnostics only. What the handler throws comes
  /// out of Wait or Drain.
  using Handler = std::function<void(std::string_view channel, std::span<const std::byte> data,
                                     std::int64_t received_us)>;
  enum class Woken {
    kMessages,  ///< the handler has been called
    kIdle,      ///< nothing came within the time
    kStopped,   ///< Stop was called; Drain for what had come before
  };

  /// A Fault says what to do: where the route for multicast is missing, the command that adds it;
  /// where no broker answers, its address.
  static Result<LiveBus> Open(const std::string& url, int receive_buffer = kReceiveBuffer);
  ~LiveBus();
  LiveBus(LiveBus&&) noexcept;
  LiveBus& operator=(LiveBus&&) noexcept;

  /// From now on `handler` gets what comes on `channels`, taken literally; with none, everything.
  [[nodiscard]] std::optional<Fault> Subscribe(const std::vector<std::string>& channels,
                                               Handler handler);

  /// Waits for a message, for Stop, or for the time to pass (negative: for ever), then hands on
  /// `most` messages at most of what has come. A Fault: the bus is gone.
  Result<Woken> Wait(int timeout_ms, std::int64_t most = kBurst);
  /// Hands on what has come until nothing more does for `quiet_ms`, at most `most` messages; how
  /// many it was. Without waiting (0), what LCM's own thread has not yet fetched from the system
  /// stays there.
  Result<std::int64_t> Drain(std::int64_t most = 1'000'000, int quiet_ms = 0);

  /// While a handler is called: its message came from this machine, or from one that the URL's
  /// `from` names. Of a broker it counts where the broker is.
  bool heard_here() const;
  /// And by whom it was sent; nobody where the transport does not say, or the URL has `mixed=1`.
  SentBy heard_from() const;

  /// Ends the present and every later Wait. May be called from a signal handler or another thread.
  void Stop() noexcept;

  /// Throws std::invalid_argument for a channel of other than 1 to 63 bytes.
  [[nodiscard]] std::optional<Fault> Publish(std::string_view channel,
                                             std::span<const std::byte> data);

  /// As handed to LCM.
  const std::string& url() const;
  /// Of the system, in the URL or by default [bytes]; 0 where the transport is not udpm.
  int asked_receive_buffer() const;
  /// What the system grants of the receive buffer asked for [bytes]; nothing where the transport is
  /// not udpm. Less than asked: raise net.core.rmem_max.
  std::optional<int> granted_receive_buffer() const;
  /// Datagrams that the system threw away because the buffer was full; nothing where not known.
  std::optional<std::int64_t> kernel_drops() const;
  /// Datagrams that are no messages of LCM's, and messages of an impossible size.
  std::int64_t refused() const;
  /// Datagrams of senders that the URL's `from` does not name.
  std::int64_t strangers() const;

 private:
  struct Core;
  explicit LiveBus(std::unique_ptr<Core> core);
  std::unique_ptr<Core> core_;
};

}  // namespace wellgyro

#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "wellgyro/base/result.h"
#include "wellgyro/bus/lcm_live.h"
#include "wellgyro/bus/lcm_url_internal.h"
#include "wellgyro/bus/reassembly.h"

namespace wellgyro {

/// The channel of the message by which LCM's own programs test that they hear themselves.
inline constexpr const char* kSelfTest = "LCM_SELF_TEST";

/// Hears LCM's multicast with a socket of its own, bound to the group and to the interface that
/// leads to it: liblcm 1.3 takes what comes to the port from anywhere, and is ended by two
/// datagrams. A thread reads as fast as the system delivers, so that a consumer may stand for
/// seconds; it holds kHeldMax bytes at most, then the system's buffer fills, which is counted.
class UdpReceiver {
 public:
  static constexpr std::size_t kHeldMax = std::size_t{24} << 20;  ///< bytes
  static constexpr std::size_t kBlock = std::size_t{1} << 18;     ///< bytes, allocated at once

  explicit UdpReceiver(const LcmUrl& url) : url_(url) {}
  ~UdpReceiver();
  UdpReceiver(const UdpReceiver&) = delete;
  UdpReceiver& operator=(const UdpReceiver&) = delete;

  /// Opens the socket and starts the thread.
  [[nodiscard]] std::optional<Fault> Start();
  bool started() const { return thread_.joinable(); }
  /// From now on messages on this channel are held; an empty name: on every one.
  void Want(const std::string& channel);

  /// Readable while a message is held.
  int descriptor() const { return ready_; }

  /// Valid until the next Next.
  struct Held {
    std::string_view channel;
    std::span<const std::byte> data;
    std::int64_t received_us = 0;  ///< by the system's clock, when the datagram came
    bool local = false;            ///< from an address of this machine, or one that the URL names
    SentBy by;
  };
  bool Next(Held& held);

  /// Notes when a message on this channel comes, wanted or not ...
  void Await(const std::string& channel);
  /// ... and says whether it has, within so long.
  bool Came(int timeout_ms);

  std::int64_t refused() const { return refused_; }            ///< datagrams, by what they hold
  std::int64_t foreign_senders() const { return strangers_; }  ///< datagrams, by who sent them
  std::int64_t kernel_drops() const { return drops_; }
  int granted() const { return granted_; }  ///< receive buffer [bytes]

 private:
  struct Block {
    std::vector<std::byte> bytes;
    std::size_t read = 0;
  };
  struct Buffers;
  Fault Refused(const std::string& doing) const;
  /// Socket on group and port, shared with other receivers, its buffer as the URL asks.
  std::optional<Fault> Bind();
  /// Joins the group on the URL's interface, or the one that its route leads to.
  std::optional<Fault> JoinGroup();
  /// By which messages of this machine are told from others.
  void FindOwnAddresses();
  /// `address` in the host's order; true also of senders that the URL names.
  bool IsLocal(std::uint32_t address) const;
  /// The thread: reads until told to stop, and waits while kHeldMax bytes are held.
  void Work();
  /// As many datagrams as there are, in one call of the system.
  void Read(Buffers& buffers);
  /// One datagram, a message or a fragment of one.
  void Take(std::uint64_t sender, std::span<const std::byte> datagram, std::int64_t received_us);
  /// A whole message for the consumer, where its channel is wanted.
  void Hold(const Reassembly::Whole& whole, std::int64_t received_us, std::uint64_t sender);
  bool Wanted(std::string_view channel) const;

  const LcmUrl& url_;
  int socket_ = -1, ready_ = -1, ending_ = -1;
  int granted_ = 0;
  std::vector<std::uint32_t> own_;  ///< addresses of this machine, host's order
  Reassembly reassembly_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::set<std::string, std::less<>> wanted_;
  bool all_ = false;
  std::deque<Block> blocks_;
  Block reading_;                 ///< the consumer's
  std::vector<std::byte> spare_;  ///< storage of one that was read
  bool signalled_ = false;
  std::size_t held_ = 0;
  bool stop_ = false;
  std::string awaited_;
  std::atomic<std::int64_t> refused_ = 0, strangers_ = 0, drops_ = 0;
  std::thread thread_;
};

}  // namespace wellgyro

#include "wellgyro/bus/udp_receiver_internal.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <memory>
#include <utility>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include "wellgyro/bus/bytes_internal.h"

namespace wellgyro {
namespace {

constexpr std::size_t kDatagramsAtOnce = 16;   // datagrams that one system call brings
constexpr std::size_t kDatagramMax = 1 << 16;  // [bytes]
constexpr std::size_t kControl = 128;          // [bytes] time and drops of one datagram

// Before each message that is held: when it came, from whom, the length of its channel, of its
// data, whether it is of this machine, its number.
constexpr std::size_t kHead = 2 * sizeof(std::int64_t) + 4 * sizeof(std::uint32_t);

void Signal(int event) {
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = ::write(event, &one, sizeof one);
}

void Quench(int event) {
  std::uint64_t count = 0;
  [[maybe_unused]] const ssize_t read = ::read(event, &count, sizeof count);
}

template <class Option>
bool Set(int socket, int level, int name, const Option& value) {
  return ::setsockopt(socket, level, name, &value, sizeof value) == 0;
}

}  // namespace

struct UdpReceiver::Buffers {
  Buffers() : bytes(kDatagramsAtOnce * kDatagramMax), control(kDatagramsAtOnce * kControl) {
    for (std::size_t i = 0; i < kDatagramsAtOnce; ++i) {
      parts[i] = {bytes.data() + i * kDatagramMax, kDatagramMax};
    }
  }
  void Reset() {
    for (std::size_t i = 0; i < kDatagramsAtOnce; ++i) {
      msghdr& head = heads[i].msg_hdr;
      head = {};
      head.msg_name = &senders[i];
      head.msg_namelen = sizeof senders[i];
      head.msg_iov = &parts[i];
      head.msg_iovlen = 1;
      head.msg_control = control.data() + i * kControl;
      head.msg_controllen = kControl;
    }
  }
  std::vector<std::byte> bytes, control;
  std::array<iovec, kDatagramsAtOnce> parts{};
  std::array<sockaddr_in, kDatagramsAtOnce> senders{};
  std::array<mmsghdr, kDatagramsAtOnce> heads{};
};

UdpReceiver::~UdpReceiver() {
  if (thread_.joinable()) {
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
      changed_.notify_all();
    }
    Signal(ending_);
    thread_.join();
  }
  for (const int descriptor : {socket_, ready_, ending_}) {
    if (descriptor >= 0) ::close(descriptor);
  }
}

Fault UdpReceiver::Refused(const std::string& doing) const {
  return {FaultCode::kIo, fmt::format("{}: {}: {}", url_.full, doing, std::strerror(errno)),
          url_.full};
}

std::optional<Fault> UdpReceiver::Bind() {
  socket_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  ready_ = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  ending_ = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (socket_ < 0 || ready_ < 0 || ending_ < 0) return Refused("no socket");
  const int yes = 1;
  if (!Set(socket_, SOL_SOCKET, SO_REUSEADDR, yes)) return Refused("the port cannot be shared");
  Set(socket_, SOL_SOCKET, SO_RCVBUF, url_.receive_buffer);
  Set(socket_, SOL_SOCKET, SO_TIMESTAMP, yes);
  Set(socket_, SOL_SOCKET, SO_RXQ_OVFL, yes);
  socklen_t size = sizeof granted_;
  ::getsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &granted_, &size);
  granted_ /= 2;  // Linux doubles it for its own book-keeping
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(url_.port);
  // Bound to the group, the socket gets nothing that was sent to this machine alone.
  if (!url_.unicast) ::inet_pton(AF_INET, url_.host.c_str(), &address.sin_addr);
  if (::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    return Refused("the port cannot be used");
  }
  return std::nullopt;
}

std::optional<Fault> UdpReceiver::JoinGroup() {
  ip_mreqn member{};
  ::inet_pton(AF_INET, url_.host.c_str(), &member.imr_multiaddr);
  if (!url_.interface.empty()) {
    member.imr_ifindex = static_cast<int>(::if_nametoindex(url_.interface.c_str()));
    const bool named = member.imr_ifindex > 0;
    if (!named && ::inet_pton(AF_INET, url_.interface.c_str(), &member.imr_address) != 1) {
      return Refused("interface " + url_.interface);
    }
  }
  // What others on this machine have joined, on another interface perhaps, is not for us.
  const int no = 0;
  Set(socket_, IPPROTO_IP, IP_MULTICAST_ALL, no);
  if (!Set(socket_, IPPROTO_IP, IP_ADD_MEMBERSHIP, member)) {
    return Refused("the group cannot be joined");
  }
  return std::nullopt;
}

std::optional<Fault> UdpReceiver::Start() {
  if (auto fault = Bind()) return fault;
  if (auto fault = JoinGroup()) return fault;
  FindOwnAddresses();
  thread_ = std::thread([this] { Work(); });
  return std::nullopt;
}

void UdpReceiver::FindOwnAddresses() {
  ifaddrs* all = nullptr;
  if (::getifaddrs(&all) != 0) return;
  for (const ifaddrs* one = all; one != nullptr; one = one->ifa_next) {
    if (one->ifa_addr == nullptr || one->ifa_addr->sa_family != AF_INET) continue;
    sockaddr_in address{};
    std::memcpy(&address, one->ifa_addr, sizeof address);
    own_.push_back(ntohl(address.sin_addr.s_addr));
  }
  ::freeifaddrs(all);
}

bool UdpReceiver::IsLocal(std::uint32_t address) const {
  const auto in = [address](const std::vector<std::uint32_t>& list) {
    return std::find(list.begin(), list.end(), address) != list.end();
  };
  // Where only the loopback has a route a sender has no address. From outside the system lets none
  // in without one, but to groups of the form 224.0.0.x.
  const bool nobody = address == 0 && !url_.host.starts_with("224.0.0.");
  return address >> 24 == 127 || nobody || in(own_) || in(url_.senders);
}

void UdpReceiver::Want(const std::string& channel) {
  const std::lock_guard lock(mutex_);
  if (channel.empty()) {
    all_ = true;
  } else {
    wanted_.insert(channel);
  }
}

void UdpReceiver::Work() {
  const auto buffers = std::make_unique<Buffers>();
  for (;;) {
    {
      // A consumer that stands lets the system's buffer fill, whose drops are counted.
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return stop_ || held_ < kHeldMax; });
      if (stop_) return;
    }
    std::array<pollfd, 2> ends = {{{socket_, POLLIN, 0}, {ending_, POLLIN, 0}}};
    if (::poll(ends.data(), ends.size(), -1) > 0 && ends[0].revents != 0) Read(*buffers);
  }
}

void UdpReceiver::Read(Buffers& buffers) {
  buffers.Reset();
  const int count =
      ::recvmmsg(socket_, buffers.heads.data(), kDatagramsAtOnce, MSG_DONTWAIT, nullptr);
  for (int n = 0; n < count; ++n) {
    const auto i = static_cast<std::size_t>(n);
    msghdr& head = buffers.heads[i].msg_hdr;
    std::int64_t received_us = 0;
    for (cmsghdr* c = CMSG_FIRSTHDR(&head); c != nullptr; c = CMSG_NXTHDR(&head, c)) {
      if (c->cmsg_level != SOL_SOCKET) continue;
      if (c->cmsg_type == SCM_TIMESTAMP) {
        timeval time{};
        std::memcpy(&time, CMSG_DATA(c), sizeof time);
        received_us = std::int64_t{time.tv_sec} * 1'000'000 + time.tv_usec;
      } else if (c->cmsg_type == SO_RXQ_OVFL) {
        std::uint32_t drops = 0;
        std::memcpy(&drops, CMSG_DATA(c), sizeof drops);
        drops_ = drops;
      }
    }
    const std::uint32_t address = ntohl(buffers.senders[i].sin_addr.s_addr);
    const bool known = url_.senders.empty() || std::find(url_.senders.begin(), url_.senders.end(),
                                                         address) != url_.senders.end();
    if (!known) {
      ++strangers_;
    } else if ((head.msg_flags & MSG_TRUNC) != 0) {
      ++refused_;
    } else {
      const std::uint64_t sender =
          std::uint64_t{address} << 16 | ntohs(buffers.senders[i].sin_port);
      Take(sender, {buffers.bytes.data() + i * kDatagramMax, buffers.heads[i].msg_len},
           received_us);
    }
  }
}

void UdpReceiver::Take(std::uint64_t sender, std::span<const std::byte> datagram,
                       std::int64_t received_us) {
  const std::int64_t before = reassembly_.refused();
  const auto whole = reassembly_.Take(sender, datagram);
  refused_ += reassembly_.refused() - before;
  if (whole) Hold(*whole, received_us, sender);
}

bool UdpReceiver::Wanted(std::string_view channel) const {
  return all_ || wanted_.find(channel) != wanted_.end();
}

void UdpReceiver::Hold(const Reassembly::Whole& whole, std::int64_t received_us,
                       std::uint64_t sender) {
  const bool local = IsLocal(static_cast<std::uint32_t>(sender >> 16));
  const std::lock_guard lock(mutex_);
  if (whole.channel == awaited_) {
    awaited_.clear();
    changed_.notify_all();
  }
  // What LCM's programs say to hear themselves is said to nobody else.
  if (!Wanted(whole.channel) || whole.channel == kSelfTest) return;
  const std::size_t size = kHead + whole.channel.size() + whole.data.size();
  if (blocks_.empty() || blocks_.back().bytes.size() + size > kBlock) {
    blocks_.emplace_back().bytes = std::exchange(spare_, {});
    blocks_.back().bytes.reserve(std::max(size, kBlock));
  }
  std::vector<std::byte>& bytes = blocks_.back().bytes;
  const std::size_t at = bytes.size();
  bytes.resize(at + kHead);
  Store(bytes.data() + at, received_us);
  Store(bytes.data() + at + 8, sender);
  Store(bytes.data() + at + 16, static_cast<std::uint32_t>(whole.channel.size()));
  Store(bytes.data() + at + 20, static_cast<std::uint32_t>(whole.data.size()));
  Store(bytes.data() + at + 24, std::uint32_t{local});
  Store(bytes.data() + at + 28, whole.number);
  const auto* channel = reinterpret_cast<const std::byte*>(whole.channel.data());
  bytes.insert(bytes.end(), channel, channel + whole.channel.size());
  bytes.insert(bytes.end(), whole.data.begin(), whole.data.end());
  held_ += size;
  if (!std::exchange(signalled_, true)) Signal(ready_);
}

bool UdpReceiver::Next(Held& held) {
  if (reading_.read == reading_.bytes.size()) {
    const std::lock_guard lock(mutex_);
    held_ -= reading_.bytes.size();
    changed_.notify_all();
    reading_.bytes.clear();
    if (reading_.bytes.capacity() <= kBlock) spare_ = std::move(reading_.bytes);
    reading_ = {};
    if (blocks_.empty()) {
      if (std::exchange(signalled_, false)) Quench(ready_);
      return false;
    }
    reading_ = std::move(blocks_.front());
    blocks_.pop_front();
  }
  const std::byte* at = reading_.bytes.data() + reading_.read;
  held.received_us = Load<std::int64_t>(at);
  const auto channel = Load<std::uint32_t>(at + 16), data = Load<std::uint32_t>(at + 20);
  held.local = Load<std::uint32_t>(at + 24) != 0;
  held.by = {Load<std::uint64_t>(at + 8), Load<std::uint32_t>(at + 28)};
  held.channel = {reinterpret_cast<const char*>(at + kHead), channel};
  held.data = {at + kHead + channel, data};
  reading_.read += kHead + channel + data;
  return true;
}

void UdpReceiver::Await(const std::string& channel) {
  const std::lock_guard lock(mutex_);
  awaited_ = channel;
}

bool UdpReceiver::Came(int timeout_ms) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, std::chrono::milliseconds(timeout_ms),
                           [this] { return awaited_.empty(); });
}

}  // namespace wellgyro

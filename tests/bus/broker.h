#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace wellgyro::test {

/// A broker for tcpq://, as LCM's Java TCPService, that gives every client every message: LCM's
/// clients sort out by channel themselves. On a port of its own, while it lives.
class Broker {
 public:
  Broker() : listener_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    if (::bind(listener_, reinterpret_cast<sockaddr*>(&address), size) != 0 ||
        ::listen(listener_, 8) != 0 ||
        ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size) != 0) {
      return;
    }
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this] { Serve(); });
  }
  ~Broker() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
    for (const auto& [client, bytes] : clients_) ::close(client);
    ::close(listener_);
  }
  Broker(const Broker&) = delete;
  Broker& operator=(const Broker&) = delete;

  std::string url() const { return "tcpq://127.0.0.1:" + std::to_string(port_); }

 private:
  static constexpr std::uint32_t kServer = 0x287617fa, kVersion = 0x0100;
  static constexpr std::uint32_t kPublish = 1;
  static constexpr std::size_t kHello = 8;

  /// What a client has sent and we have not used yet.
  struct Client {
    std::string bytes;
    bool greeted = false;
  };

  static std::uint32_t Number(const std::string& bytes, std::size_t at) {
    std::uint32_t number = 0;
    std::memcpy(&number, bytes.data() + at, sizeof number);
    return ntohl(number);
  }

  static bool SendAll(int client, const std::string& bytes) {
    std::size_t done = 0;
    while (done < bytes.size()) {
      const ssize_t n = ::send(client, bytes.data() + done, bytes.size() - done, MSG_NOSIGNAL);
      if (n <= 0) return false;
      done += static_cast<std::size_t>(n);
    }
    return true;
  }

  void Welcome() {
    const int client = ::accept(listener_, nullptr, nullptr);
    if (client < 0) return;
    const int yes = 1;
    ::setsockopt(client, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    const std::array<std::uint32_t, 2> hello = {htonl(kServer), htonl(kVersion)};
    SendAll(client, {reinterpret_cast<const char*>(hello.data()), sizeof hello});
    clients_[client];
  }

  /// Bytes of the whole message at the front; 0: not all there.
  static std::size_t Whole(const std::string& bytes) {
    if (bytes.size() < 8) return 0;
    std::size_t size = 8 + Number(bytes, 4);
    if (Number(bytes, 0) == kPublish) {
      if (bytes.size() < size + 4) return 0;
      size += 4 + Number(bytes, size);
    }
    return bytes.size() >= size ? size : 0;
  }

  void Use(Client& from) {
    if (!from.greeted) {
      if (from.bytes.size() < kHello) return;
      from.bytes.erase(0, kHello);
      from.greeted = true;
    }
    while (const std::size_t size = Whole(from.bytes)) {
      if (Number(from.bytes, 0) == kPublish) {
        const std::string message = from.bytes.substr(0, size);
        for (const auto& [client, unused] : clients_) SendAll(client, message);
      }
      from.bytes.erase(0, size);
    }
  }

  void Serve() {
    while (!stop_) {
      std::vector<pollfd> ends = {{listener_, POLLIN, 0}};
      for (const auto& [client, unused] : clients_) ends.push_back({client, POLLIN, 0});
      if (::poll(ends.data(), ends.size(), 20) <= 0) continue;
      if (ends[0].revents != 0) Welcome();
      for (std::size_t i = 1; i < ends.size(); ++i) {
        if (ends[i].revents == 0) continue;
        std::array<char, 65536> block{};
        const ssize_t n = ::recv(ends[i].fd, block.data(), block.size(), 0);
        if (n <= 0) {
          ::close(ends[i].fd);
          clients_.erase(ends[i].fd);
          continue;
        }
        Client& client = clients_[ends[i].fd];
        client.bytes.append(block.data(), static_cast<std::size_t>(n));
        Use(client);
      }
    }
  }

  int listener_;
  std::uint16_t port_ = 0;
  std::map<int, Client> clients_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

}  // namespace wellgyro::test

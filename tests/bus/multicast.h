#pragma once

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <string>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace wellgyro::test {

/// Why a plain socket of this machine does not hear what another says to LCM's group on `port`;
/// empty where it does. Knows nothing of LCM or of ours, so that only what the machine lacks lets
/// a test of multicast be skipped.
inline std::string NoMulticast(std::uint16_t port) {
  const int ear = ::socket(AF_INET, SOCK_DGRAM, 0), mouth = ::socket(AF_INET, SOCK_DGRAM, 0);
  const auto answer = [&]() -> std::string {
    const auto lacks = [](const char* what) {
      return std::string("no multicast here: ") + what + ": " + std::strerror(errno);
    };
    if (ear < 0 || mouth < 0) return lacks("a socket");
    sockaddr_in group{};
    group.sin_family = AF_INET;
    group.sin_port = htons(port);
    group.sin_addr.s_addr = ::inet_addr("239.255.76.67");
    const auto* const address = reinterpret_cast<const sockaddr*>(&group);
    const int yes = 1;
    ::setsockopt(ear, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    if (::bind(ear, address, sizeof group) != 0) return lacks("a port of the group");
    ip_mreq member{};
    member.imr_multiaddr = group.sin_addr;
    if (::setsockopt(ear, IPPROTO_IP, IP_ADD_MEMBERSHIP, &member, sizeof member) != 0) {
      return lacks("joining the group");
    }
    const unsigned char stay = 0;
    ::setsockopt(mouth, IPPROTO_IP, IP_MULTICAST_TTL, &stay, sizeof stay);
    if (::sendto(mouth, "x", 1, 0, address, sizeof group) != 1)
      return lacks("sending to the group");
    pollfd heard{ear, POLLIN, 0};
    if (::poll(&heard, 1, 2000) != 1) return "no multicast here: what is sent is not heard";
    return {};
  }();
  for (const int end : {ear, mouth}) {
    if (end >= 0) ::close(end);
  }
  return answer;
}

}  // namespace wellgyro::test

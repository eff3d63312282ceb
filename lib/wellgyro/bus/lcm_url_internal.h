#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "wellgyro/base/result.h"

namespace wellgyro {

/// The parts of an LCM URL that matter to us.
struct LcmUrl {
  std::string provider;  ///< udpm, tcpq or memq
  std::string host;
  std::uint16_t port = 0;
  std::string full;        ///< with our defaults added
  int receive_buffer = 0;  ///< asked for [bytes]; udpm only
};

/// `receive_buffer` [bytes] goes into a udpm URL that asks for none.
Result<LcmUrl> ParseLcmUrl(const std::string& url, int receive_buffer);

/// Whether a datagram to the group would find a way out: asked of the system, nothing is sent.
std::optional<Fault> CheckMulticastRoute(const LcmUrl& url);

/// What the system grants to a socket that asks for this receive buffer [bytes].
std::optional<int> GrantedReceiveBuffer(int asked);

/// Datagrams dropped by this process's UDP sockets on a port, from /proc.
std::optional<std::int64_t> UdpDrops(std::uint16_t port);

}  // namespace wellgyro

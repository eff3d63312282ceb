#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "wellgyro/base/result.h"

namespace wellgyro {

/// The parts of an LCM URL that matter to us.
struct LcmUrl {
  std::string provider;  ///< udpm, tcpq or memq
  std::string host;
  std::uint16_t port = 0;
  std::string full;        ///< with our defaults added
  std::string for_lcm;     ///< without the options that are ours alone
  int receive_buffer = 0;  ///< asked for [bytes]; udpm only
  // udpm only, of the options `interface=NAME|ADDRESS`, `unicast=1`, `mixed=1`,
  // `from=ADDRESS,ADDRESS`:
  std::string interface;               ///< to hear on; empty: the one of the route to the group
  bool unicast = false;                ///< hears what is sent to this machine alone, too
  bool mixed = false;                  ///< takes one stream from several senders
  std::vector<std::uint32_t> senders;  ///< IPv4 addresses to hear, host's order; none: all
};

/// `receive_buffer` [bytes] goes into a udpm URL that asks for none.
Result<LcmUrl> ParseLcmUrl(const std::string& url, int receive_buffer);

/// Whether a datagram to the group would find a way out: asked of the system, nothing is sent.
std::optional<Fault> CheckMulticastRoute(const LcmUrl& url);

/// What the system grants to a socket that asks for this receive buffer [bytes].
std::optional<int> GrantedReceiveBuffer(int asked);

}  // namespace wellgyro

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <string_view>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "wellgyro/bus/lcm_url_internal.h"

namespace wellgyro {
namespace {

/// A UDP socket that closes itself.
class Probe {
 public:
  Probe() : descriptor_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {}
  ~Probe() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  Probe(const Probe&) = delete;
  Probe& operator=(const Probe&) = delete;
  int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
};

Fault BadUrl(const std::string& url, const std::string& why) {
  return {FaultCode::kSyntax, fmt::format("{}: {}", url, why), url};
}

struct Parts {
  std::string_view provider, address, options;
};

std::optional<Parts> Split(std::string_view url) {
  const std::size_t colon = url.find("://");
  if (colon == std::string_view::npos) return std::nullopt;
  Parts parts;
  parts.provider = url.substr(0, colon);
  const std::string_view rest = url.substr(colon + 3);
  const std::size_t question = rest.find('?');
  parts.address = rest.substr(0, question);
  if (question != std::string_view::npos) parts.options = rest.substr(question + 1);
  return parts;
}

/// Takes the first option off `options`.
std::string_view TakeOption(std::string_view& options) {
  const std::string_view option = options.substr(0, options.find('&'));
  options.remove_prefix(std::min(options.size(), option.size() + 1));
  return option;
}

/// IPv4 addresses between commas; nothing where one of them is none.
std::optional<std::vector<std::uint32_t>> Addresses(std::string_view list) {
  std::vector<std::uint32_t> addresses;
  while (!list.empty()) {
    const std::string one(list.substr(0, list.find(',')));
    list.remove_prefix(std::min(list.size(), one.size() + 1));
    in_addr address{};
    if (::inet_pton(AF_INET, one.c_str(), &address) != 1) return std::nullopt;
    addresses.push_back(ntohl(address.s_addr));
  }
  return addresses;
}

std::optional<int> Number(std::string_view value) {
  int number = 0;
  const char* end = value.data() + value.size();
  const auto [stop, error] = std::from_chars(value.data(), end, number);
  if (error != std::errc() || stop != end || number < 0) return std::nullopt;
  return number;
}

/// Takes one option of a udpm URL, into `lcm` where LCM knows it too; what is wrong with it, which
/// LCM would pass over with a warning at most.
std::string WrongOption(std::string_view option, LcmUrl& parsed, std::vector<std::string>& lcm) {
  const std::string_view name = option.substr(0, option.find('='));
  const std::string_view value = option.substr(std::min(option.size(), name.size() + 1));
  if (name == "interface") {
    parsed.interface = value;
    return value.empty() ? "interface= has no name" : "";
  }
  if (name == "from") {
    const auto senders = Addresses(value);
    if (!senders || senders->empty()) return fmt::format("{} are no IPv4 addresses", option);
    parsed.senders = *senders;
    return {};
  }
  const std::optional<int> number = Number(value);
  const bool ttl = name == "ttl";
  const bool ours = name == "unicast" || name == "mixed";
  if (!ttl && !ours && name != "recv_buf_size" && name != "transmit_only") {
    return fmt::format(
        "the options are ttl, recv_buf_size, interface, from, mixed and unicast, not \"{}\"", name);
  }
  if (!number || (ttl && *number > 255)) {
    return fmt::format("{} is no number{}", option, ttl ? " from 0 to 255" : "");
  }
  if (ours) {
    (name == "unicast" ? parsed.unicast : parsed.mixed) = *number != 0;
    return {};
  }
  if (name == "recv_buf_size") parsed.receive_buffer = *number;
  lcm.emplace_back(option);
  return {};
}

/// HOST:PORT into `parsed`, with defaults for what is left out.
bool SplitAddress(std::string_view address, const char* host, std::uint16_t port, LcmUrl& parsed) {
  const std::size_t colon = address.rfind(':');
  parsed.host = address.substr(0, colon);
  parsed.port = port;
  if (parsed.host.empty()) parsed.host = host;
  if (colon == std::string_view::npos) return true;
  const std::string_view digits = address.substr(colon + 1);
  const char* end = digits.data() + digits.size();
  const auto [stop, error] = std::from_chars(digits.data(), end, parsed.port);
  return error == std::errc() && stop == end && parsed.port > 0;
}

/// All options of a udpm URL, with our defaults, into `parsed`; what is wrong with one of them.
std::string TakeOptions(std::string_view options, int receive_buffer, LcmUrl& parsed) {
  std::vector<std::string> lcm, ours;
  parsed.receive_buffer = receive_buffer;
  while (!options.empty()) {
    const std::string_view option = TakeOption(options);
    const std::size_t before = lcm.size();
    std::string wrong = WrongOption(option, parsed, lcm);
    if (!wrong.empty()) return wrong;
    if (lcm.size() == before) ours.emplace_back(option);
  }
  const auto add = [&lcm](std::string_view name, int value) {
    const bool given = std::any_of(lcm.begin(), lcm.end(), [name](const std::string& option) {
      return option.substr(0, option.find('=')) == name;
    });
    if (!given) lcm.push_back(fmt::format("{}={}", name, value));
  };
  add("ttl", 0);
  add("recv_buf_size", receive_buffer);
  const std::string address = fmt::format("udpm://{}:{}?", parsed.host, parsed.port);
  parsed.for_lcm = address + fmt::format("{}", fmt::join(lcm, "&"));
  lcm.insert(lcm.end(), ours.begin(), ours.end());
  parsed.full = address + fmt::format("{}", fmt::join(lcm, "&"));
  return {};
}

}  // namespace

Result<LcmUrl> ParseLcmUrl(const std::string& url, int receive_buffer) {
  const std::optional<Parts> parts = Split(url);
  if (!parts) {
    return BadUrl(url, "is no LCM URL such as udpm://239.255.76.67:7667?ttl=0");
  }
  LcmUrl parsed;
  parsed.provider = parts->provider;
  parsed.full = parsed.for_lcm = url;
  if (parts->provider == "memq") return parsed;
  if (parts->provider == "file") return BadUrl(url, "name a log by its path alone");
  const bool udpm = parts->provider == "udpm";
  if (!udpm && parts->provider != "tcpq") {
    return BadUrl(url, "the transports are udpm, tcpq and memq");
  }
  const bool good = udpm ? SplitAddress(parts->address, "239.255.76.67", 7667, parsed)
                         : SplitAddress(parts->address, "127.0.0.1", 7700, parsed);
  if (!good) return BadUrl(url, "the port must be 1 to 65535");
  if (!udpm) return parsed;
  const std::string wrong = TakeOptions(parts->options, receive_buffer, parsed);
  if (!wrong.empty()) return BadUrl(url, wrong);
  return parsed;
}

std::optional<Fault> CheckMulticastRoute(const LcmUrl& url) {
  sockaddr_in group{};
  group.sin_family = AF_INET;
  group.sin_port = htons(url.port);
  if (::inet_pton(AF_INET, url.host.c_str(), &group.sin_addr) != 1 ||
      !IN_MULTICAST(ntohl(group.sin_addr.s_addr))) {
    return BadUrl(url.full, fmt::format("\"{}\" is no multicast group, 224.0.0.0 to "
                                        "239.255.255.255",
                                        url.host));
  }
  const Probe probe;
  if (::connect(probe.descriptor(), reinterpret_cast<const sockaddr*>(&group), sizeof group) == 0) {
    return std::nullopt;
  }
  const std::string why = std::strerror(errno);
  return Fault{
      FaultCode::kIo,
      fmt::format("{}: the system has no route for multicast ({}); to stay on this machine, "
                  "as root: ip link set lo up; ip route add 224.0.0.0/4 dev lo",
                  url.full, why),
      url.full};
}

std::optional<int> GrantedReceiveBuffer(int asked) {
  const Probe probe;
  int granted = 0;
  socklen_t size = sizeof granted;
  if (::setsockopt(probe.descriptor(), SOL_SOCKET, SO_RCVBUF, &asked, sizeof asked) != 0 ||
      ::getsockopt(probe.descriptor(), SOL_SOCKET, SO_RCVBUF, &granted, &size) != 0) {
    return std::nullopt;
  }
  return granted / 2;  // Linux doubles it for its own book-keeping
}

}  // namespace wellgyro

#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
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

/// The value of the last `name` among `options`.
std::optional<int> Option(std::string_view options, std::string_view name) {
  std::optional<int> number;
  while (!options.empty()) {
    const std::string_view option = TakeOption(options);
    if (!option.starts_with(name) || option.substr(name.size(), 1) != "=") continue;
    int value = 0;
    std::from_chars(option.data() + name.size() + 1, option.data() + option.size(), value);
    number = value;
  }
  return number;
}

/// What is wrong with the options of a udpm URL, which LCM would pass over with a warning at most.
std::string WrongOption(std::string_view options) {
  while (!options.empty()) {
    const std::string_view option = TakeOption(options);
    const std::string_view name = option.substr(0, option.find('='));
    const std::string_view value = option.substr(std::min(option.size(), name.size() + 1));
    const bool ttl = name == "ttl";
    if (!ttl && name != "recv_buf_size" && name != "transmit_only") {
      return fmt::format("the options are ttl and recv_buf_size, not \"{}\"", name);
    }
    int number = 0;
    const char* end = value.data() + value.size();
    const auto [stop, error] = std::from_chars(value.data(), end, number);
    if (error != std::errc() || stop != end || number < 0 || (ttl && number > 255)) {
      return fmt::format("{} is no number{}", option, ttl ? " from 0 to 255" : "");
    }
  }
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

/// Inodes of this process's open sockets, as /proc/net/udp names them.
std::set<std::string> OwnSockets() {
  std::set<std::string> inodes;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", error)) {
    std::error_code gone;
    const std::string target = std::filesystem::read_symlink(entry.path(), gone).string();
    if (target.starts_with("socket:[")) inodes.insert(target.substr(8, target.size() - 9));
  }
  return inodes;
}

}  // namespace

Result<LcmUrl> ParseLcmUrl(const std::string& url, int receive_buffer) {
  const std::optional<Parts> parts = Split(url);
  if (!parts) {
    return BadUrl(url, "is no LCM URL such as udpm://239.255.76.67:7667?ttl=0");
  }
  LcmUrl parsed;
  parsed.provider = parts->provider;
  parsed.full = url;
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
  if (const std::string wrong = WrongOption(parts->options); !wrong.empty()) {
    return BadUrl(url, wrong);
  }
  std::string options(parts->options);
  const auto add = [&options](const std::string& option) {
    options += (options.empty() ? "" : "&") + option;
  };
  if (!Option(options, "ttl")) add("ttl=0");
  if (!Option(options, "recv_buf_size")) add(fmt::format("recv_buf_size={}", receive_buffer));
  parsed.receive_buffer = Option(options, "recv_buf_size").value_or(receive_buffer);
  parsed.full = fmt::format("udpm://{}:{}?{}", parsed.host, parsed.port, options);
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

std::optional<std::int64_t> UdpDrops(std::uint16_t port) {
  std::ifstream table("/proc/net/udp");
  std::string line;
  if (!std::getline(table, line)) return std::nullopt;
  const std::set<std::string> own = OwnSockets();
  const std::string end_of_address = fmt::format(":{:04X}", port);
  std::optional<std::int64_t> drops;
  while (std::getline(table, line)) {
    // sl local_address rem_address st queues tr:when retrnsmt uid timeout inode ref pointer drops
    std::istringstream words(line);
    std::string slot, local, word, inode;
    words >> slot >> local;
    for (int i = 0; i < 7; ++i) words >> word;
    std::int64_t lost = 0;
    if (!(words >> inode >> word >> word >> lost)) continue;
    if (local.ends_with(end_of_address) && own.contains(inode)) drops = drops.value_or(0) + lost;
  }
  return drops;
}

}  // namespace wellgyro

#include "wellgyro/bus/byte_stream.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

namespace wellgyro {
namespace {

constexpr std::size_t kBytesAtOnce = 65536;  // [bytes]

Fault Refused(const std::string& where, const std::string& why) {
  return {FaultCode::kIo, fmt::format("{}: {}", where, why), where};
}

bool Ready(int descriptor, short events, int patience_ms) {
  pollfd one{descriptor, events, 0};
  int ready = ::poll(&one, 1, patience_ms);
  if (ready < 0 && errno == EINTR) ready = 0;
  return ready > 0;
}

/// Connected, or why not.
int Connect(const addrinfo& address, int patience_ms) {
  const int descriptor = ::socket(address.ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (descriptor < 0) return -1;
  if (::connect(descriptor, address.ai_addr, address.ai_addrlen) == 0) return descriptor;
  int error = errno;
  if (error == EINPROGRESS) {
    error = ETIMEDOUT;
    socklen_t size = sizeof error;
    if (Ready(descriptor, POLLOUT, patience_ms)) {
      ::getsockopt(descriptor, SOL_SOCKET, SO_ERROR, &error, &size);
    }
  }
  if (error == 0) return descriptor;
  ::close(descriptor);
  errno = error;
  return -1;
}

Result<int> OpenTcp(const std::string& where, int patience_ms) {
  const std::string address = where.substr(std::strlen("tcp://"));
  const std::size_t colon = address.rfind(':');
  if (colon == std::string::npos || colon == 0 || colon + 1 == address.size()) {
    return Refused(where, "is no tcp://HOST:PORT");
  }
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const int wrong = ::getaddrinfo(address.substr(0, colon).c_str(),
                                  address.substr(colon + 1).c_str(), &hints, &found);
  if (wrong != 0) return Refused(where, ::gai_strerror(wrong));
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> all(found, ::freeaddrinfo);
  for (const addrinfo* one = found; one != nullptr; one = one->ai_next) {
    if (const int descriptor = Connect(*one, patience_ms); descriptor >= 0) return descriptor;
  }
  return Refused(where, std::strerror(errno));
}

speed_t SpeedOf(int baud) {
  constexpr std::array<std::pair<int, speed_t>, 7> kSpeeds = {{{1200, B1200},
                                                               {4800, B4800},
                                                               {9600, B9600},
                                                               {19200, B19200},
                                                               {38400, B38400},
                                                               {57600, B57600},
                                                               {115200, B115200}}};
  for (const auto& [number, speed] : kSpeeds) {
    if (number == baud) return speed;
  }
  return B0;
}

Result<int> OpenSerial(const std::string& where, int baud) {
  const speed_t speed = SpeedOf(baud);
  if (speed == B0) return Refused(where, fmt::format("{} is no usual speed [baud]", baud));
  const int descriptor = ::open(where.c_str(), O_RDONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return Refused(where, std::strerror(errno));
  termios line{};
  if (::tcgetattr(descriptor, &line) == 0) {
    ::cfmakeraw(&line);
    line.c_cflag |= CLOCAL | CREAD;
    ::cfsetspeed(&line, speed);
    ::tcsetattr(descriptor, TCSANOW, &line);
  }
  return descriptor;
}

}  // namespace

ByteStream::ByteStream(std::string where, int descriptor)
    : where_(std::move(where)), buffer_(kBytesAtOnce, '\0'), descriptor_(descriptor) {}

ByteStream::~ByteStream() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

ByteStream::ByteStream(ByteStream&& other) noexcept
    : where_(std::move(other.where_)),
      buffer_(std::move(other.buffer_)),
      descriptor_(std::exchange(other.descriptor_, -1)) {}

ByteStream& ByteStream::operator=(ByteStream&& other) noexcept {
  std::swap(where_, other.where_);
  std::swap(buffer_, other.buffer_);
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

Result<ByteStream> ByteStream::Open(const std::string& where, int baud, int patience_ms) {
  const bool tcp = where.starts_with("tcp://");
  const Result<int> descriptor = tcp ? OpenTcp(where, patience_ms) : OpenSerial(where, baud);
  if (!descriptor) return descriptor.fault();
  return ByteStream(where, *descriptor);
}

Result<std::string_view> ByteStream::Read(int patience_ms) {
  if (!Ready(descriptor_, POLLIN, patience_ms)) return std::string_view();
  const ssize_t size = ::read(descriptor_, buffer_.data(), buffer_.size());
  if (size > 0) return std::string_view(buffer_.data(), static_cast<std::size_t>(size));
  if (size < 0 && (errno == EAGAIN || errno == EINTR)) return std::string_view();
  return Refused(where_, size == 0 ? "the other side has closed the line" : std::strerror(errno));
}

}  // namespace wellgyro

#include "page_address.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstddef>

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/core.h>
#include <openssl/crypto.h>
#include <openssl/rand.h>
#include <unistd.h>

namespace wellgyro::apps {
namespace {

constexpr std::size_t kShortest = 16, kLongest = 128;  // characters of a token

/// "host" of "host:port", "[v6]:port" and either without its port.
std::string_view WithoutPort(std::string_view text) {
  if (text.starts_with('[')) {
    const std::size_t end = text.find(']');
    return end == std::string_view::npos ? text : text.substr(1, end - 1);
  }
  return text.substr(0, text.find(':'));
}

bool IsAddress(const std::string& host) {
  in_addr v4{};
  in6_addr v6{};
  return inet_pton(AF_INET, host.c_str(), &v4) == 1 || inet_pton(AF_INET6, host.c_str(), &v6) == 1;
}

bool IsLoopback(const std::string& host) {
  return host == "localhost" || host == "::1" || (host.starts_with("127.") && IsAddress(host));
}

std::string Lower(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return lower;
}

std::string ReadSome(int file) {
  std::string text(kLongest + 2, '\0');
  const ssize_t size = ::read(file, text.data(), text.size());
  text.resize(static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  const bool plain = std::ranges::all_of(text, [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' ||
           c == '_';
  });
  return plain && text.size() >= kShortest && text.size() <= kLongest ? text : std::string();
}

}  // namespace

std::optional<PageAddress> PageAddressOf(std::string_view text) {
  PageAddress address;
  const std::size_t colon = text.rfind(':');
  const std::string_view port = colon == std::string_view::npos ? text : text.substr(colon + 1);
  if (colon != std::string_view::npos) address.host = Lower(WithoutPort(text.substr(0, colon)));
  const char* const end = port.data() + port.size();
  const auto [rest, error] = std::from_chars(port.data(), end, address.port);
  const bool number = error == std::errc() && rest == end && !port.empty();
  if (!number || address.port < 0 || address.port > 65535 || address.host.empty()) {
    return std::nullopt;
  }
  address.loopback = IsLoopback(address.host);
  return address;
}

bool MayName(std::string_view host_header, const PageAddress& address, std::string_view own_name) {
  const std::string host = Lower(WithoutPort(host_header));
  if (IsLoopback(host)) return true;
  return !address.loopback && (IsAddress(host) || host == Lower(own_name) || host == address.host);
}

std::string NewToken() {
  std::array<unsigned char, 16> bytes{};
  if (RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) != 1) return {};
  std::string token;
  for (const unsigned char byte : bytes) token += fmt::format("{:02x}", byte);
  return token;
}

bool SameToken(const std::string& given, const std::string& token) {
  return given.size() == token.size() &&
         CRYPTO_memcmp(given.data(), token.data(), token.size()) == 0;
}

std::string TokenIn(const std::string& path) {
  const int made = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (made >= 0) {
    const std::string token = NewToken(), line = token + "\n";
    const bool whole = ::write(made, line.data(), line.size()) == static_cast<ssize_t>(line.size());
    return ::close(made) == 0 && whole ? token : std::string();
  }
  if (errno != EEXIST) return {};
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return {};
  std::string token = ReadSome(file);
  ::close(file);
  return token;
}

}  // namespace wellgyro::apps

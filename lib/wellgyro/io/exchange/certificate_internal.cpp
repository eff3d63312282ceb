#include "wellgyro/io/exchange/certificate_internal.h"

#include <charconv>
#include <system_error>

#include <fmt/core.h>

#include "wellgyro/io/sha256.h"

namespace wellgyro {
namespace {

constexpr std::string_view kName = "wellgyro certificate: ";

// A whole number at the begin of `text`, and then `after`; both are taken off.
template <class Number>
bool Take(std::string_view& text, Number& number, std::string_view after) {
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc()) return false;
  text.remove_prefix(static_cast<std::size_t>(rest - text.data()));
  if (!text.starts_with(after)) return false;
  text.remove_prefix(after.size());
  return true;
}

}  // namespace

std::string CertificateText(std::size_t stations, std::string_view below) {
  return fmt::format("{}{} stations | {} bytes below | SHA-256 {}", kName, stations, below.size(),
                     Sha256Hex(below));
}

std::optional<FileCertificate> CertificateIn(std::string_view line) {
  const std::size_t at = line.find(kName);
  if (at == std::string_view::npos) return std::nullopt;
  line.remove_prefix(at + kName.size());
  FileCertificate found;
  if (!Take(line, found.stations, " stations | ") ||
      !Take(line, found.bytes, " bytes below | SHA-256 ") || line.size() < 64) {
    return std::nullopt;
  }
  found.sha256 = line.substr(0, 64);
  return found;
}

}  // namespace wellgyro

#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace wellgyro {

/// What a file of ours says of its own bytes, on one line of its head: how many stations it holds,
/// and the size and SHA-256 of all that follows that line.
struct FileCertificate {
  std::size_t stations = 0;
  std::int64_t bytes = 0;
  std::string sha256;
};

/// "wellgyro certificate: 7 stations, 1234 bytes below, SHA-256 0123..." of the text `below` it.
std::string CertificateText(std::size_t stations, std::string_view below);
/// From a line that holds such a text, with whatever its format has before it.
std::optional<FileCertificate> CertificateIn(std::string_view line);

}  // namespace wellgyro

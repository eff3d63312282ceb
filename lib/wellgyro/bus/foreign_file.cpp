#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>

#include "wellgyro/bus/foreign_file_internal.h"

namespace wellgyro {
namespace {

struct Magic {
  std::string_view bytes;
  const char* name;
};
constexpr std::array<Magic, 8> kMagics = {{
    {"\x1F\x8B", "compressed with gzip; unpack it first"},
    {"PK\x03\x04", "a ZIP archive; unpack it first"},
    {"\x28\xB5\x2F\xFD", "compressed with zstd; unpack it first"},
    {"\xFD"
     "7zXZ",
     "compressed with xz; unpack it first"},
    {"BZh", "compressed with bzip2; unpack it first"},
    {"\x89MCAP", "an MCAP file"},
    {"#ROSBAG", "a ROS bag"},
    {"\x7F"
     "ELF",
     "a program"},
}};

}  // namespace

std::string ForeignFileText(std::span<const std::byte> beginning) {
  const std::string_view text(reinterpret_cast<const char*>(beginning.data()), beginning.size());
  if (text.empty()) return "is empty";
  for (const Magic& magic : kMagics) {
    if (text.starts_with(magic.bytes)) return fmt::format("is {}", magic.name);
  }
  const std::string_view line = text.substr(0, text.find_first_of("\r\n"));
  const auto printable = [](char c) { return (c >= 0x20 && c < 0x7F) || c == '\t'; };
  if (!line.empty() && std::all_of(line.begin(), line.end(), printable)) {
    return fmt::format("is text that begins with \"{}\"", line.substr(0, 40));
  }
  std::string hex;
  for (const char c : text.substr(0, 8)) {
    hex += fmt::format(" {:02x}", static_cast<unsigned char>(c));
  }
  return fmt::format("holds other data, which begin with{}", hex);
}

}  // namespace wellgyro

#include "wellgyro/io/text_file.h"

#include <array>
#include <fstream>
#include <system_error>

#include <fmt/core.h>

namespace wellgyro {
namespace {

Fault Unreadable(const std::filesystem::path& path, FaultCode code, std::string text) {
  return Fault{.code = code, .text = std::move(text), .source = path.string()};
}

}  // namespace

Result<std::string> ReadTextFile(const std::filesystem::path& path, std::int64_t limit) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    return Unreadable(path, FaultCode::kIo, "this is a directory, not a file");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) return Unreadable(path, FaultCode::kIo, "cannot open this file for reading");
  std::string bytes;
  std::array<char, 1 << 16> block{};
  while (file.read(block.data(), block.size()) || file.gcount() > 0) {
    bytes.append(block.data(), static_cast<std::size_t>(file.gcount()));
    if (std::ssize(bytes) > limit) {
      return Unreadable(
          path, FaultCode::kForeign,
          fmt::format("larger than {} bytes, too large for what it should be", limit));
    }
  }
  if (file.bad()) return Unreadable(path, FaultCode::kIo, "reading this file failed half way");
  return bytes;
}

}  // namespace wellgyro

#include "wellgyro/io/text_file.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

#include <fmt/core.h>

namespace wellgyro {
namespace {

Fault Unreadable(const std::filesystem::path& path, FaultCode code, std::string text) {
  return Fault{.code = code, .text = std::move(text), .source = path.string()};
}

// Up to `limit` bytes, and one more where there are more.
Result<std::string> ReadSome(const std::filesystem::path& path, std::int64_t limit) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    return Unreadable(path, FaultCode::kIo, "this is a directory, not a file");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) return Unreadable(path, FaultCode::kIo, "cannot open this file for reading");
  std::string bytes;
  std::array<char, 1 << 16> block{};
  while (std::ssize(bytes) <= limit) {
    const std::int64_t wanted = std::min(std::ssize(block), limit + 1 - std::ssize(bytes));
    file.read(block.data(), wanted);
    if (file.gcount() <= 0) break;
    bytes.append(block.data(), static_cast<std::size_t>(file.gcount()));
  }
  if (file.bad()) return Unreadable(path, FaultCode::kIo, "reading this file failed half way");
  return bytes;
}

}  // namespace

std::vector<std::filesystem::path> PathsOf(const std::vector<InputFile>& files) {
  std::vector<std::filesystem::path> paths;
  for (const InputFile& file : files) paths.push_back(file.path);
  return paths;
}

Result<std::string> ReadTextFile(const std::filesystem::path& path, std::int64_t limit) {
  Result<std::string> bytes = ReadSome(path, limit);
  if (bytes && std::ssize(*bytes) > limit) {
    return Unreadable(path, FaultCode::kForeign,
                      fmt::format("larger than {} bytes, too large for what it should be", limit));
  }
  return bytes;
}

Result<std::string> ReadTextHead(const std::filesystem::path& path, std::int64_t size) {
  if (size < 0) {
    return Unreadable(path, FaultCode::kRange, fmt::format("{} bytes cannot be read", size));
  }
  std::error_code ignored;
  if (std::filesystem::is_fifo(path, ignored)) {
    return Unreadable(path, FaultCode::kIo,
                      "this is a pipe, which can be read only once: save it to a file first");
  }
  Result<std::string> bytes = ReadSome(path, size);
  if (bytes && std::ssize(*bytes) > size) bytes->resize(static_cast<std::size_t>(size));
  return bytes;
}

}  // namespace wellgyro

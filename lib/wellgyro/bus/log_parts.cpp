#include "wellgyro/bus/log_parts.h"

#include <filesystem>
#include <system_error>
#include <utility>

#include <fmt/core.h>

namespace wellgyro {

std::string LogPart(const std::string& path, int number) {
  if (number == 0) return path;
  const std::filesystem::path whole(path);
  std::filesystem::path part = whole.parent_path() / whole.stem();
  part += fmt::format(".{:03}", number);
  part += whole.extension();
  return part.string();
}

std::vector<std::string> LogParts(const std::string& path) {
  std::vector<std::string> parts{path};
  std::error_code ignored;
  for (int number = 1;; ++number) {
    std::string part = LogPart(path, number);
    if (!std::filesystem::is_regular_file(part, ignored)) return parts;
    parts.push_back(std::move(part));
  }
}

}  // namespace wellgyro

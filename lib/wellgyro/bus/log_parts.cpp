#include "wellgyro/bus/log_parts.h"

#include <charconv>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

#include <fmt/core.h>

namespace wellgyro {
namespace {

/// The number in a path that ends like .00: two digits or more. Of one digit are the names of
/// lcm-logger --rotate, whose 0 is the newest.
std::optional<int> IncrementOf(const std::filesystem::path& path) {
  const std::string ending = path.extension().string();
  if (ending.size() < 3 || ending.size() > 9) return std::nullopt;
  int number = 0;
  const char* end = ending.data() + ending.size();
  const auto [last, error] = std::from_chars(ending.data() + 1, end, number);
  if (error != std::errc() || last != end || number < 0) return std::nullopt;
  return number;
}

/// The part of `first`, the number of which is `increment`, that comes `number` parts after it.
std::string PartAfter(const std::string& first, std::optional<int> increment, int number) {
  if (!increment) return LogPart(first, number);
  std::filesystem::path part(first);
  return part.replace_extension(fmt::format("{:02}", *increment + number)).string();
}

}  // namespace

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
  const std::optional<int> increment = IncrementOf(path);
  for (int number = 1;; ++number) {
    std::string part = PartAfter(path, increment, number);
    if (!std::filesystem::is_regular_file(part, ignored)) return parts;
    parts.push_back(std::move(part));
  }
}

}  // namespace wellgyro

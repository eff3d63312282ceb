#include "wellgyro/bus/log_parts.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <system_error>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/bus/log_reader.h"

namespace wellgyro {
namespace {

constexpr int kPartsMost = 1000;  // of three digits, within which a missing one is looked for

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

Result<std::vector<std::string>> LogParts(const std::string& path) {
  std::vector<std::string> parts{path};
  const std::optional<int> increment = IncrementOf(path);
  const auto after = [&](int number) { return PartAfter(path, increment, number); };
  std::error_code ignored;
  int number = 1;
  for (; std::filesystem::is_regular_file(after(number), ignored); ++number) {
    parts.push_back(after(number));
  }
  for (int later = number + 1; later < kPartsMost; ++later) {
    if (!std::filesystem::is_regular_file(after(later), ignored)) continue;
    return Fault{.code = FaultCode::kLost,
                 .text = fmt::format("is missing, and {} is there: find it, or name each part",
                                     after(later)),
                 .source = after(number)};
  }
  return parts;
}

std::vector<std::string> InOrderOfTime(std::vector<std::string> logs) {
  std::vector<std::pair<std::int64_t, std::string>> begun;
  for (std::string& log : logs) {
    Result<LogReader> reader = LogReader::Open(log);
    LogEvent first;
    const bool any = reader && reader->Next(first);
    begun.emplace_back(any ? first.received_us : std::numeric_limits<std::int64_t>::max(),
                       std::move(log));
  }
  std::ranges::stable_sort(begun, {}, &std::pair<std::int64_t, std::string>::first);
  for (std::size_t i = 0; i < logs.size(); ++i) logs[i] = std::move(begun[i].second);
  return logs;
}

}  // namespace wellgyro

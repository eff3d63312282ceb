#include "wellgyro/base/number_range.h"

#include <cmath>
#include <cstdint>

#include <fmt/core.h>

namespace wellgyro {
namespace {

// With all its digits where it is whole: 2305843009213693952 is one to type, 2.3e18 is not.
std::string EndOf(double end) {
  const bool whole = std::abs(end) < 0x1p63 && std::round(end) == end;
  return whole ? fmt::format("{}", static_cast<std::int64_t>(end)) : fmt::format("{}", end);
}

}  // namespace

std::optional<std::string> ComplaintOf(double value, const NumberRange& range) {
  if (!std::isfinite(value)) return fmt::format("{} is not a finite number", value);
  if (range.or_zero && value == 0) return std::nullopt;
  const std::string zero = range.or_zero ? "0, or " : "";
  if (range.above_min ? value <= range.min : value < range.min) {
    return fmt::format("{} must be {}{} {}", value, zero, range.above_min ? "above" : "at least",
                       range.min);
  }
  if (value > range.max) return fmt::format("{} must be {}at most {}", value, zero, range.max);
  return std::nullopt;
}

std::optional<std::string> ComplaintOfWhole(std::int64_t value, const NumberRange& range) {
  constexpr double kBeyond = 0x1p63;  // above 2^53 a double does not tell neighbours apart
  if (range.min >= -kBeyond && value < static_cast<std::int64_t>(range.min)) {
    return fmt::format("{} must be at least {}", value, EndOf(range.min));
  }
  if (range.max < kBeyond && value > static_cast<std::int64_t>(range.max)) {
    return fmt::format("{} must be at most {}", value, EndOf(range.max));
  }
  return std::nullopt;
}

std::string TextOf(const NumberRange& range) {
  const std::string zero = range.or_zero ? "0, or " : "";
  const bool low = std::isfinite(range.min), high = std::isfinite(range.max);
  if (low && high) {
    return fmt::format("{}{}{} to {}", zero, range.above_min ? "above " : "", EndOf(range.min),
                       EndOf(range.max));
  }
  if (low)
    return fmt::format("{}{} {}", zero, range.above_min ? "above" : "at least", EndOf(range.min));
  return high ? fmt::format("{}at most {}", zero, EndOf(range.max)) : "any";
}

}  // namespace wellgyro

#include "wellgyro/base/number_range.h"

#include <cmath>

#include <fmt/core.h>

namespace wellgyro {

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

std::string TextOf(const NumberRange& range) {
  const std::string zero = range.or_zero ? "0, or " : "";
  const bool low = std::isfinite(range.min), high = std::isfinite(range.max);
  if (low && high) {
    return fmt::format("{}{}{} to {}", zero, range.above_min ? "above " : "", range.min, range.max);
  }
  if (low) return fmt::format("{}{} {}", zero, range.above_min ? "above" : "at least", range.min);
  return high ? fmt::format("{}at most {}", zero, range.max) : "any";
}

}  // namespace wellgyro

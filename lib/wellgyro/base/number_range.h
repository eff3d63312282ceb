#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>

#include "wellgyro/base/export.h"

namespace wellgyro {

/// What a number may be, ends included unless `above_min`; with `or_zero` also 0.
struct NumberRange {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool above_min = false;
  bool or_zero = false;
};

/// "91 must be at most 90", or nothing where `value` lies in `range`. What is not finite never
/// does.
WELLGYRO_EXPORT std::optional<std::string> ComplaintOf(double value, const NumberRange& range);

/// The same of a whole number, to its last digit.
WELLGYRO_EXPORT std::optional<std::string> ComplaintOfWhole(std::int64_t value,
                                                            const NumberRange& range);

/// "0 to 90", "above 0", "0, or 0.2 to 100000", "any".
WELLGYRO_EXPORT std::string TextOf(const NumberRange& range);

}  // namespace wellgyro

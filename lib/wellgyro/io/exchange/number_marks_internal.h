#pragma once

#include <optional>
#include <string_view>

namespace wellgyro {

/// How a table uses commas inside its numbers.
enum class CommaUse {
  kNone,       ///< none seen
  kDecimal,    ///< 1229,99
  kThousands,  ///< 1,229.99
  kUnclear,    ///< 1,000 alone could be either
};

/// From the cells of `text` between `delimiter`: a comma followed by other than three digits, or
/// after a leading zero, is a decimal one; one beside a point, or two of them, part thousands.
CommaUse CommaUseOf(std::string_view text, char delimiter);

/// A number in a cell, with or without quotes; nothing where commas do not stand as `use` says.
/// Blanks and apostrophes may part thousands, and points where the comma is decimal.
std::optional<double> NumberIn(std::string_view cell, CommaUse use);

}  // namespace wellgyro

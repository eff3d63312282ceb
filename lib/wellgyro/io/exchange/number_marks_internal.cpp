#include "wellgyro/io/exchange/number_marks_internal.h"

#include <algorithm>
#include <string>
#include <vector>

#include "wellgyro/io/text_internal.h"

namespace wellgyro {
namespace {

// Groups of three digits after each comma, one to three before the first.
bool IsGrouped(std::string_view cell) {
  if (!cell.empty() && (cell.front() == '-' || cell.front() == '+')) cell.remove_prefix(1);
  const std::string_view whole = cell.substr(0, cell.find('.'));
  const std::size_t first = whole.find(',');
  if (first == 0 || first > 3 || whole.front() == '0') return false;
  for (std::size_t at = first; at < whole.size(); at += 4) {
    if (whole[at] != ',' || whole.size() - at < 4) return false;
  }
  return std::count(whole.begin(), whole.end(), ',') ==
         static_cast<std::ptrdiff_t>((whole.size() - first) / 4);
}

bool IsNumberLike(std::string_view cell) {
  return !cell.empty() && cell.find_first_of("0123456789") != std::string_view::npos &&
         cell.find_first_not_of("+-0123456789.,eE") == std::string_view::npos;
}

}  // namespace

CommaUse CommaUseOf(std::string_view text, char delimiter) {
  bool decimal = false, thousands = false, unclear = false, points = false;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    if (line.ends_with('\r')) line.remove_suffix(1);
    const auto fields = SplitQuoted(line, delimiter);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (!fields) continue;
    for (const std::string& field : *fields) {
      const std::string_view cell = TrimCell(field);
      if (!IsNumberLike(cell)) continue;
      const bool point = cell.find('.') != std::string_view::npos;
      const auto commas = std::count(cell.begin(), cell.end(), ',');
      points = points || point;
      if (commas == 0) continue;
      if (!IsGrouped(cell)) {
        decimal = true;
      } else if (point || commas > 1) {
        thousands = true;
      } else {
        unclear = true;
      }
    }
  }
  if (decimal && !thousands) return CommaUse::kDecimal;
  if ((thousands || (unclear && points)) && !decimal) return CommaUse::kThousands;
  return unclear || thousands ? CommaUse::kUnclear : CommaUse::kNone;
}

std::optional<double> NumberIn(std::string_view cell, CommaUse use) {
  cell = TrimCell(cell);
  if (cell.find(',') == std::string_view::npos) return NumberOf(cell);
  if (use == CommaUse::kDecimal) return NumberWithComma(cell);
  if (use != CommaUse::kThousands || !IsGrouped(cell)) return std::nullopt;
  std::string digits(cell);
  std::erase(digits, ',');
  return NumberOf(digits);
}

}  // namespace wellgyro

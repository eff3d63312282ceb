#include "wellgyro/io/exchange/number_marks_internal.h"

#include <algorithm>
#include <array>
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

// A number as typeset: blanks, apostrophes or thin spaces between groups of three digits are taken
// out, a minus sign of Unicode becomes a hyphen. As it is where there is none of them, or where
// they part no groups.
std::string PlainNumber(std::string_view cell) {
  constexpr std::array<std::string_view, 6> kGaps{" ", "'", "\u00A0", "\u2009", "\u202F", "\u2019"};
  constexpr std::string_view kMinus = "\u2212";
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  std::string plain;
  std::size_t group = 0;  // digits since the last gap
  bool gaps = false;
  for (std::size_t at = 0; at < cell.size();) {
    const std::string_view rest = cell.substr(at);
    if (at == 0 && rest.starts_with(kMinus)) {
      plain += '-';
      at += kMinus.size();
      continue;
    }
    const auto gap = std::ranges::find_if(kGaps, [&](auto g) { return rest.starts_with(g); });
    if (gap == kGaps.end()) {
      const bool ends = !digit(cell[at]) && gaps && plain.find_first_of(".,") == plain.npos;
      if (ends && group != 3) return std::string(cell);
      group = digit(cell[at]) ? group + 1 : 0;
      plain += cell[at++];
      continue;
    }
    if (group == 0 || group > 3 || (gaps && group != 3)) return std::string(cell);
    gaps = true;
    group = 0;
    at += gap->size();
  }
  const bool fraction = plain.find_first_of(".,") != plain.npos;
  return gaps && !fraction && group != 3 ? std::string(cell) : plain;
}

// "1.025,50": points part thousands where the comma is the decimal mark.
std::optional<double> WithPointsBetween(std::string_view cell) {
  std::string swapped(cell);
  for (char& c : swapped) c = c == ',' ? '.' : c == '.' ? ',' : c;
  if (swapped.find(',') == std::string::npos) return NumberOf(swapped);
  if (!IsGrouped(swapped)) return std::nullopt;
  std::erase(swapped, ',');
  return NumberOf(swapped);
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
      const std::string cell = PlainNumber(TrimCell(field));
      if (!IsNumberLike(cell)) continue;
      const bool point = cell.find('.') != std::string::npos;
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
  const bool comma = cell.find(',') != std::string_view::npos;
  if (!comma && use != CommaUse::kDecimal) {
    if (const auto number = NumberOf(cell)) return number;
  }
  const std::string plain = PlainNumber(cell);
  if (use == CommaUse::kDecimal) {
    const auto number = WithPointsBetween(plain);
    return number || comma ? number : NumberOf(plain);
  }
  if (!comma) return NumberOf(plain);
  if (use != CommaUse::kThousands || !IsGrouped(plain)) return std::nullopt;
  std::string digits(plain);
  std::erase(digits, ',');
  return NumberOf(digits);
}

}  // namespace wellgyro

#include "wellgyro/base/alike.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>

namespace wellgyro {
namespace {

std::size_t Distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = std::exchange(row[j + 1], std::min({replaced, row[j] + 1, row[j + 1] + 1}));
    }
  }
  return row.back();
}

}  // namespace

bool Alike(std::string_view a, std::string_view b) {
  return Distance(a, b) <= 1 + std::max(a.size(), b.size()) / 5;
}

std::string Nearest(std::string_view word, const std::vector<std::string>& known) {
  const auto found = std::min_element(
      known.begin(), known.end(),
      [&](const auto& a, const auto& b) { return Distance(word, a) < Distance(word, b); });
  return found != known.end() && Alike(word, *found) ? *found : std::string();
}

}  // namespace wellgyro

#include "wellgyro/io/exchange/spaced_names_internal.h"

#include <algorithm>

#include "wellgyro/io/text_internal.h"

namespace wellgyro {
namespace {

// "MD (m)" is one name.
std::vector<std::string> WithBrackets(const std::vector<std::string>& words) {
  std::vector<std::string> names;
  for (const std::string& word : words) {
    if (!names.empty() && (word.starts_with('(') || word.starts_with('['))) {
      names.back() += " " + word;
    } else {
      names.push_back(word);
    }
  }
  return names;
}

// Names that stand at least two blanks apart.
std::vector<std::string> SplitAtGaps(std::string_view line) {
  std::vector<std::string> names;
  std::string_view rest = Trim(line);
  while (!rest.empty()) {
    const std::size_t gap = std::min(rest.find("  "), rest.size());
    names.emplace_back(rest.substr(0, gap));
    rest = Trim(rest.substr(gap));
  }
  return names;
}

}  // namespace

std::optional<std::vector<std::string>> SpacedNames(std::string_view line,
                                                    std::optional<std::size_t> width) {
  if (line.find('\t') != std::string_view::npos) return std::nullopt;
  const auto words = SplitQuoted(line, ' ');
  if (!words || !width || words->size() == *width) return words;
  std::vector<std::string> names = WithBrackets(*words);
  if (names.size() == *width) return names;
  names = SplitAtGaps(line);
  if (names.size() == *width) return names;
  return std::nullopt;
}

}  // namespace wellgyro

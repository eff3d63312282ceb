#include "choice.h"

#include <algorithm>

#include <fmt/format.h>

#include "help.h"

namespace wellgyro::apps {
namespace {

/// What is said of a word that is none of `known`; empty where it is one.
std::string RefusalOf(const std::string& word, const std::vector<std::string>& known) {
  if (std::ranges::find(known, word) != known.end()) return {};
  return fmt::format("'{}' is none of {}{}", word, fmt::join(known, ", "), Guess(word, known));
}

}  // namespace

CLI::Option* TakeWord(CLI::Option* option, const std::vector<std::string>& words) {
  return option->check([words](const std::string& word) { return RefusalOf(word, words); })
      ->type_name(fmt::format("{}", fmt::join(words, "|")));
}

CLI::Option* TakeNumbered(CLI::Option* option,
                          const std::vector<std::pair<std::string, int>>& words) {
  std::vector<std::string> known;
  for (const auto& [word, number] : words) known.push_back(word);
  const auto turn = [words, known](std::string& word) {
    std::string refusal = RefusalOf(word, known);
    if (refusal.empty()) {
      const auto at = std::ranges::find(words, word, [](const auto& one) { return one.first; });
      word = std::to_string(at->second);
    }
    return refusal;
  };
  return option->transform(CLI::Validator(turn, "", ""))
      ->type_name(fmt::format("{}", fmt::join(known, "|")));
}

}  // namespace wellgyro::apps

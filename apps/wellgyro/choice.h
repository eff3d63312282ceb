#pragma once

#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

namespace wellgyro::apps {

/// Has `option` take one of `words` and nothing else: help shows them as its type, and a refusal
/// lists them with the one that seems to be meant.
CLI::Option* TakeWord(CLI::Option* option, const std::vector<std::string>& words);

/// The same, of what each word stands for: numbers of an enumeration that the option holds.
CLI::Option* TakeNumbered(CLI::Option* option,
                          const std::vector<std::pair<std::string, int>>& words);

template <class Enum>
CLI::Option* TakeOneOf(CLI::Option* option,
                       const std::vector<std::pair<std::string, Enum>>& words) {
  std::vector<std::pair<std::string, int>> numbered;
  for (const auto& [word, value] : words) numbered.emplace_back(word, static_cast<int>(value));
  return TakeNumbered(option, numbered);
}

}  // namespace wellgyro::apps

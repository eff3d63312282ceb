#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

#include <fmt/core.h>

#include "wellgyro/survey/job_keys.h"
#include "wellgyro/survey/unstated_errors.h"

namespace wellgyro {
namespace {

// "number, 0 to 90"; "axis or mark".
std::string TypeText(const JobKey& key) {
  std::string text(key.type);
  for (std::size_t i = 0; i < key.words.size(); ++i) {
    if (key.words[i].empty()) continue;
    if (!text.empty()) text += i + 1 < key.words.size() ? ", " : " or ";
    text += key.words[i];
  }
  const std::string range = TextOf(key.range), second = TextOf(key.second);
  if (range == "any") return text;
  return text + ", " + range + (key.type.starts_with("text") ? " bytes" : "") +
         (second == "any" ? "" : " and " + second);
}

std::string AbsentErrorText(const JobKey& key) {
  const Job job;
  for (const UnstatedError& each : UnstatedErrors()) {
    if (&(job.errors.*each.error) != key.find(job)) continue;
    return fmt::format("the tool's, else {}{}{:.3g}", each.follows_text,
                       each.follows ? ", else " : "", each.value / key.unit);
  }
  throw std::logic_error(fmt::format("survey/unstated_errors.cpp lacks {}", key.key));
}

std::string AbsentText(const JobKey& key) {
  if (!key.absent.empty()) return std::string(key.absent);
  if (key.table == "errors") return AbsentErrorText(key);
  if (key.table == "noise") {
    Job silent;
    silent.noise = NoiseUnlessStated();
    const double* const value = key.find(silent);
    if (value && *value > 0) return fmt::format("0; without any [noise] {:.3g}", *value / key.unit);
  }
  const Job job;
  const double* const value = key.find ? key.find(job) : nullptr;
  return value ? fmt::format("{:.12g}", *value / key.unit) : "none";
}

}  // namespace

std::string JobReference() {
  std::string text;
  std::string_view table;
  for (const JobKey& key : JobKeys()) {
    if (key.table != table) {
      table = key.table;
      const bool list = table == "run" || table == "event" || table == "operator";
      text += fmt::format("\n## {}{}{}\n\n| key | is | without it | meaning |\n|---|---|---|---|\n",
                          list ? "[[" : "[", table, list ? "]]" : "]");
    }
    text += fmt::format("| `{}` | {} | {} | {} |\n", key.key, TypeText(key), AbsentText(key),
                        key.meaning);
  }
  return text;
}

}  // namespace wellgyro

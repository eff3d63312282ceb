#include "wellgyro/io/words.h"

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>

#include "wellgyro/survey/job_words.h"
#include "wellgyro/uncertainty/error_model.h"

namespace wellgyro {
namespace {

using Words = std::span<const std::string_view>;

constexpr std::array<std::string_view, 4> kKinds{"tie_in", "gyrocompass", "continuous", "still"};
constexpr std::array<std::string_view, 5> kStatuses{"provisional", "field", "definitive",
                                                    "rejected", "superseded"};
constexpr std::array<std::string_view, 4> kPasses{"stationary", "in", "out", "repeat"};
constexpr std::array<std::string_view, 4> kVerdicts{"pass", "warn", "fail", "not_done"};
constexpr std::array<std::string_view, 12> kFlags{
    "moved",       "mirror",  "vertical", "saturated",  "gap",   "depth",
    "temperature", "aliased", "gravity",  "earth_rate", "clock", "unfit"};

constexpr std::array<std::string_view, 11> kFaults{"io",    "foreign", "fingerprint", "size",
                                                   "range", "syntax",  "damaged",     "lost",
                                                   "late",  "order",   "conflict"};
constexpr std::array<std::string_view, 4> kPropagations{"random", "systematic", "well", "global"};

template <class Enum>
std::string_view WordAt(Words words, Enum value) {
  const auto index = static_cast<std::size_t>(value);
  assert(index < words.size());
  return index < words.size() ? words[index] : "unknown";
}

template <class Enum>
std::optional<Enum> Find(Words words, std::string_view word) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (!word.empty() && words[i] == word) return static_cast<Enum>(i);
  }
  return std::nullopt;
}

}  // namespace

std::string_view WordOf(StationKind kind) { return WordAt(kKinds, kind); }
std::string_view WordOf(StationStatus status) { return WordAt(kStatuses, status); }
std::string_view WordOf(Pass pass) { return WordAt(kPasses, pass); }
std::string_view WordOf(Verdict verdict) { return WordAt(kVerdicts, verdict); }
std::string_view WordOf(Event::Kind kind) { return WordAt(words::kEvent, kind); }
std::string_view WordOf(DepthKind kind) { return WordAt(words::kDepthKind, kind); }
std::string_view WordOf(FaultCode code) { return WordAt(kFaults, code); }
std::string_view WordOf(Propagation reach) { return WordAt(kPropagations, reach); }

std::optional<StationKind> StationKindOf(std::string_view word) {
  return Find<StationKind>(kKinds, word);
}
std::optional<Event::Kind> EventKindOf(std::string_view word) {
  return Find<Event::Kind>(words::kEvent, word);
}
std::optional<DepthKind> DepthKindOf(std::string_view word) {
  return Find<DepthKind>(words::kDepthKind, word);
}

std::string QualityText(Quality quality) {
  std::string text;
  for (std::size_t i = 0; i < kFlags.size(); ++i) {
    if (!Has(quality, static_cast<Quality>(1u << i))) continue;
    if (!text.empty()) text += '+';
    text += kFlags[i];
  }
  return text.empty() ? "good" : text;
}

std::string Counted(std::size_t count, std::string_view noun) {
  return std::to_string(count) + ' ' + std::string(noun) + (count == 1 ? "" : "s");
}

std::optional<Quality> QualityOf(std::string_view text) {
  if (text == "good") return Quality::kGood;
  Quality quality = Quality::kGood;
  for (;;) {
    const std::size_t plus = text.find('+');
    const auto bit = Find<std::uint32_t>(kFlags, text.substr(0, plus));
    if (!bit) return std::nullopt;
    quality |= static_cast<Quality>(1u << *bit);
    if (plus == std::string_view::npos) return quality;
    text.remove_prefix(plus + 1);
  }
}

}  // namespace wellgyro

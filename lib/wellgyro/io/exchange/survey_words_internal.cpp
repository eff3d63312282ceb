#include "wellgyro/io/exchange/survey_words_internal.h"

#include <array>
#include <string>
#include <utility>

#include "wellgyro/io/text_internal.h"

namespace wellgyro {
namespace {

constexpr std::array<std::pair<RowStatus, std::string_view>, 11> kStatusWords{{
    {RowStatus::kUnused, "unused"},
    {RowStatus::kSurveyed, "surveyed"},
    {RowStatus::kPlanned, "planned"},
    {RowStatus::kInclinationInterpolated, "inclination_interpolated"},
    {RowStatus::kAzimuthInterpolated, "azimuth_interpolated"},
    {RowStatus::kInterpolated, "interpolated"},
    {RowStatus::kProjected, "projected"},
    {RowStatus::kTrended, "trended"},
    {RowStatus::kBackCalculated, "back_calculated"},
    {RowStatus::kOther, "other"},
    {RowStatus::kTieIn, "tie_in"},
}};

constexpr std::array<std::pair<SurveyTool, std::string_view>, 7> kToolWords{{
    {SurveyTool::kGyroContinuous, "gyroscopic inertial"},
    {SurveyTool::kGyroNorthSeeking, "gyroscopic north seeking"},
    {SurveyTool::kGyroMwd, "gyroscopic MWD"},
    {SurveyTool::kMagneticMwd, "magnetic MWD"},
    {SurveyTool::kMagneticMultishot, "magnetic multiple-shot"},
    {SurveyTool::kMagneticSingleShot, "magnetic single-shot"},
    {SurveyTool::kInclinationOnly, "inclination only"},
}};

}  // namespace

std::string_view WordOf(North north) {
  switch (north) {
    case North::kTrue:
      return "true";
    case North::kGrid:
      return "grid";
    case North::kMagnetic:
      return "magnetic";
    default:
      return "unknown";
  }
}

std::optional<North> NorthOf(std::string_view word) {
  const std::string plain = LettersAndDigits(word);
  if (plain == "true" || plain == "truenorth") return North::kTrue;
  if (plain == "grid" || plain == "gridnorth") return North::kGrid;
  if (plain == "magnetic" || plain == "magneticnorth") return North::kMagnetic;
  return std::nullopt;
}

std::string_view WordOf(RowStatus status) {
  return kStatusWords[static_cast<std::size_t>(status)].second;
}

std::optional<RowStatus> RowStatusOf(std::string_view word) {
  for (const auto& [status, name] : kStatusWords) {
    if (name == word) return status;
  }
  return std::nullopt;
}

std::string_view WordOf(SurveyTool tool) {
  for (const auto& [known, word] : kToolWords) {
    if (known == tool) return word;
  }
  return {};
}

std::optional<SurveyTool> SurveyToolOf(std::string_view word) {
  // WITSML 1.4's list of values writes one of them with two blanks.
  std::string single;
  for (const char c : word) {
    if (c != ' ' || !single.ends_with(' ')) single += c;
  }
  for (const auto& [tool, known] : kToolWords) {
    if (EqualNoCase(single, known)) return tool;
  }
  return std::nullopt;
}

}  // namespace wellgyro

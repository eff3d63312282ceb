#pragma once

#include <optional>
#include <string_view>

#include "wellgyro/record/survey_table.h"

/// The words that survey formats use for what a SurveyTable holds, beside those of words.h.
namespace wellgyro {

std::string_view WordOf(North north);                 ///< true, grid, magnetic, unknown
std::optional<North> NorthOf(std::string_view word);  ///< nothing for any other word
std::string_view WordOf(RowStatus status);            ///< surveyed, tie_in ...
std::optional<RowStatus> RowStatusOf(std::string_view word);
std::string_view WordOf(SurveyTool tool);  ///< gyroscopic inertial ..., WITSML's words
std::optional<SurveyTool> SurveyToolOf(std::string_view word);

}  // namespace wellgyro

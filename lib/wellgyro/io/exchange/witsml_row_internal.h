#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "wellgyro/record/survey_table.h"

namespace wellgyro::witsml {

/// What 2.1 has no element for in a station goes into the one extension that it allows there:
/// "KEY=VALUE;KEY=VALUE" with the keys and units of CSV, as "EASTING[m]=427710.69;QUALITY=good".
/// In texts, percent signs, semicolons and equals signs are written as in URLs. What goes beyond
/// kValueLengthOf21 is left out, the last first.
inline constexpr std::string_view kRowExtension = "wellgyro_row";

std::string PackedRow(const SurveyTable& table, std::size_t row, const std::vector<Column>& native);
/// Puts such a text's values into `row`; what it does not know is passed over.
void UnpackRow(std::string_view text, SurveyTable& table, std::size_t row);

}  // namespace wellgyro::witsml

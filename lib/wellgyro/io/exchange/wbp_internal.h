#pragma once

#include <string_view>

#include "wellgyro/io/exchange/exchange.h"
#include "wellgyro/io/exchange/line_reader_internal.h"

namespace wellgyro {

/// Whether text begins as a file of Landmark's well plans.
bool IsWbp(std::string_view head);
SurveyTable ReadWbp(LineReader& lines, const ReadOptions& options);

}  // namespace wellgyro

#pragma once

#include <string>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/io/exchange/exchange.h"
#include "wellgyro/record/survey_table.h"

namespace wellgyro {

/// What a survey loses when written in `format`: columns, words about single stations, facts of the
/// head, and names that the format cuts. One sentence each, empty where everything is kept.
WELLGYRO_EXPORT std::vector<std::string> LossesOf(const SurveyTable& table, SurveyFormat format,
                                                  const WriteOptions& options = {});

}  // namespace wellgyro

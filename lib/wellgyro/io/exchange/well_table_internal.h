#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "wellgyro/base/result.h"
#include "wellgyro/simulate/simulation.h"

namespace wellgyro {

/// Stations from CSV whose first three columns are MD[m],INC[deg],AZI_TRUE[deg]; others are left.
Result<std::vector<WellPoint>> ParseWellTable(std::string_view text, const std::string& source);

}  // namespace wellgyro

#pragma once

#include <span>

#include "wellgyro/fit/tool_rows_internal.h"

namespace wellgyro {

/// Tells what would not show in any residual: temperatures and times that nobody wrote down, and
/// gravity that is not the latitude's.
void TellReferences(std::span<const BenchTable> tables, const ToolReadings& readings,
                    const ToolFitSetup& setup, FitReport& report);

/// Tells temperatures that change faster than any chamber's.
void TellHeating(std::span<const BenchTable> tables, const ToolReadings& readings,
                 FitReport& report);

/// Tells what a wrong latitude would do where no rate table checks it.
void TellLatitude(std::span<const BenchTable> tables, const ToolReadings& readings,
                  const ToolFitSetup& setup, FitReport& report);

}  // namespace wellgyro

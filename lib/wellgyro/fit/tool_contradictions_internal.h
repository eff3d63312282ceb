#pragma once

#include <span>

#include "wellgyro/fit/tool_adjust_internal.h"

namespace wellgyro {

/// Tells where the readings suit a latitude of the other sign better.
void TellHemisphere(const ToolReadings& readings, const ToolFitSetup& setup, const ToolModel& model,
                    const ToolAdjustment& adjustment, FitReport& report);

/// Of several tables tells the one that contradicts the others most: in what a channel reads of one
/// force or rate, in its bias, or in its thermometer, which moves all channels by their own slopes.
/// The fit, which has none of these, makes noise of it, or heating, where one table was read as the
/// chamber warmed and the other as it cooled. One false alarm in a hundred benches.
void TellTables(std::span<const BenchTable> tables, const ToolReadings& readings,
                const ToolModel& model, const ToolAdjustment& adjustment, FitReport& report);

/// Tells the setting of the stand that suits its readings least: all readings at rest of one
/// inclination, azimuth or toolface, three and more, turned by one angle beside it, as by a wrong
/// stop or a wrong number in the table. The fit makes noise of it. One false alarm in a hundred
/// benches, divided by the number of such groups.
void TellSettings(const ToolReadings& readings, const ToolFitSetup& setup, const ToolModel& model,
                  const ToolAdjustment& adjustment, FitReport& report);

}  // namespace wellgyro

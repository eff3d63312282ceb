#pragma once

#include <string>

#include "wellgyro/io/exchange/claims_internal.h"
#include "wellgyro/io/exchange/exchange.h"

namespace wellgyro {

/// Throws, as readers do, where --columns names on its left what no column is.
void CheckColumns(const ReadOptions& options, const std::string& source);

/// Notes of options that this kind of file has no use for: whether it looks at names of `columns`,
/// and may hold several `trajectories`.
void NoteUnused(SurveyTable& table, const ReadOptions& options, bool columns, bool trajectories);

/// What the caller says of north, unit, datum and place, and the elevation that TVD counts from:
/// what an option says holds against what the file says, with a note where they differ. Throws, as
/// readers do, where TVD and MD have datums of which one has no elevation.
void TakeOptions(SurveyTable& table, const ReadOptions& options, const Claims& claims,
                 const std::string& source);

}  // namespace wellgyro

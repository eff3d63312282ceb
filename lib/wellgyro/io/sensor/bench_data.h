#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/calibration/bench_table.h"

namespace wellgyro {

/// Bench data from CSV: one header line of column names, then numbers; between commas, semicolons
/// or tabs. Words that are read: x, y, z (0, 1, 2) in columns axis and channel, up and down (+1,
/// -1) in columns dir and sign. Lines that begin with # and empty lines are left out. Faults, with
/// line and column: kForeign without a header or rows, kSyntax for a cell that is no number, kSize
/// for a row that is too short or long, kRange for a number beyond 1e15.
WELLGYRO_EXPORT Result<BenchTable> ParseBenchTable(std::string_view text,
                                                   const std::string& source);

/// ParseBenchTable of a file.
WELLGYRO_EXPORT Result<BenchTable> ReadBenchTable(const std::filesystem::path& path);

}  // namespace wellgyro

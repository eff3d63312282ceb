#pragma once

#include <filesystem>
#include <optional>
#include <span>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/io/atomic_file.h"

namespace wellgyro {

/// Whether `folder` holds a survey of which someone accepted a station: run.toml says so, or a row
/// of passes.csv is definitive. A Fault when a run.toml is there but cannot be read.
WELLGYRO_EXPORT Result<bool> HoldsAcceptedResult(const std::filesystem::path& folder);

/// WriteFiles, but never over an accepted result: then the Fault, kConflict, says what to do.
WELLGYRO_EXPORT std::optional<Fault> WriteResult(const std::filesystem::path& folder,
                                                 std::span<const OutputFile> files);

}  // namespace wellgyro

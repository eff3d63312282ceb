#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/io/atomic_file.h"

namespace wellgyro {

/// What every result's folder holds.
inline constexpr std::array kResultFiles{"survey.csv",    "passes.csv",      "checks.csv",
                                         "diagnosis.csv", "reliability.csv", "stretches.csv",
                                         "source.toml",   "run.toml"};

/// What it may hold beside them: exports, survey.json and report.html.
WELLGYRO_EXPORT std::vector<std::string> FilesBesideResult();

/// Removes what an older result, where `folder` holds one, had there beside its own files and
/// `files` does not write anew: it says what was.
WELLGYRO_EXPORT void RemoveOlder(const std::filesystem::path& folder,
                                 std::span<const OutputFile> files);

/// Whether `folder` holds a survey of which someone accepted a station: run.toml says so, or a row
/// of passes.csv is definitive. A Fault when a run.toml is there but cannot be read.
WELLGYRO_EXPORT Result<bool> HoldsAcceptedResult(const std::filesystem::path& folder);

/// WriteFiles, but never over an accepted result: then the Fault, kConflict, says what to do.
WELLGYRO_EXPORT std::optional<Fault> WriteResult(const std::filesystem::path& folder,
                                                 std::span<const OutputFile> files);

}  // namespace wellgyro

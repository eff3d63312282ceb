#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"

namespace wellgyro {

/// A file to be written, named relative to its folder.
struct OutputFile {
  std::string name;
  std::string bytes;
};

/// Writes `files` into `folder`, which is made if need be, so that at every moment each name holds
/// either its old or its whole new bytes: temporary files first, on disk, then renamed in the given
/// order. Nothing is renamed when one cannot be written. Gives the Fault, if any.
WELLGYRO_EXPORT std::optional<Fault> WriteFiles(const std::filesystem::path& folder,
                                                std::span<const OutputFile> files);

/// Whether `folder` holds a survey of which someone accepted a station: run.toml says so, or a row
/// of passes.csv is definitive. A Fault when a run.toml is there but cannot be read.
WELLGYRO_EXPORT Result<bool> HoldsAcceptedResult(const std::filesystem::path& folder);

/// WriteFiles, but never over an accepted result: then the Fault, kConflict, says what to do.
WELLGYRO_EXPORT std::optional<Fault> WriteResult(const std::filesystem::path& folder,
                                                 std::span<const OutputFile> files);

}  // namespace wellgyro

#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

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
/// order. Nothing is renamed when one cannot be written. Links are followed, modes kept, pipes and
/// devices written to as they are; temporary files that a killed process left of the same names are
/// removed. Gives the Fault, if any.
WELLGYRO_EXPORT std::optional<Fault> WriteFiles(const std::filesystem::path& folder,
                                                std::span<const OutputFile> files);

/// The Fault that writing a file would meet now, if any, for who must work long for what goes into
/// it. Its folder is made if need be; nothing else stays. Pipes and devices are not opened.
WELLGYRO_EXPORT std::optional<Fault> CannotWrite(const std::filesystem::path& path);

/// Writes a file that nobody but its owner can open, from its first moment on. A Fault where the
/// name is taken, by a link too.
WELLGYRO_EXPORT std::optional<Fault> WriteSecretFile(const std::filesystem::path& path,
                                                     std::string_view bytes);

}  // namespace wellgyro

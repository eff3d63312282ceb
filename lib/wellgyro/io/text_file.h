#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"

/// @file
/// Whole files as text, and which files a result rests on.
namespace wellgyro {

/// A file that a result rests on.
struct InputFile {
  std::string role;            ///< job, noise, tie_in, ...
  std::string name;            ///< as the user wrote it
  std::filesystem::path path;  ///< where it was found
  std::string sha256;          ///< of the very bytes that were used
  std::string text = {};       ///< those bytes, where they go into run.toml whole
};

/// Where they were found.
WELLGYRO_EXPORT std::vector<std::filesystem::path> PathsOf(const std::vector<InputFile>& files);

/// The bytes of the file at `path`. Fault kIo when it cannot be opened or read or is a directory,
/// kForeign when it is larger than `limit` bytes.
WELLGYRO_EXPORT Result<std::string> ReadTextFile(const std::filesystem::path& path,
                                                 std::int64_t limit = 1 << 26);

/// Its first `size` bytes, or all when there are fewer. Fault kRange for a size below 0.
WELLGYRO_EXPORT Result<std::string> ReadTextHead(const std::filesystem::path& path,
                                                 std::int64_t size);

}  // namespace wellgyro

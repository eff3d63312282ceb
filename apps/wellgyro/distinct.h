#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "wellgyro/io/atomic_file.h"

namespace wellgyro::apps {

struct NamedFile {
  std::string option, path;  ///< path empty: not given
};
/// Nothing is written over what it came from, nor two files in one place: throws
/// std::invalid_argument where two are one.
void RequireDistinct(std::span<const NamedFile> files);

/// Throws std::invalid_argument where `target` would take the place of one of `inputs`.
void RequireUnread(std::span<const std::filesystem::path> inputs,
                   const std::filesystem::path& target);
/// The same of all that goes into a folder.
void RequireUnread(std::span<const std::filesystem::path> inputs,
                   const std::filesystem::path& folder, std::span<const OutputFile> files);

/// Throws std::invalid_argument where a survey's result stands in the folder and one of the files
/// has the name of one of its own.
void RequireNoSurvey(const std::filesystem::path& folder, std::span<const OutputFile> files);

}  // namespace wellgyro::apps

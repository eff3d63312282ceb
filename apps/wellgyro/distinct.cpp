#include "distinct.h"

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <system_error>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/io/result/result_folder.h"

namespace wellgyro::apps {
namespace {

namespace fs = std::filesystem;

/// Whether two names are of one file; no name is of none. A device, as /dev/stdout, takes what
/// comes one behind the other, and nothing in it is lost.
bool AreOne(const fs::path& one, const fs::path& other) {
  if (one.empty() || other.empty()) return false;
  std::error_code ignored;
  const fs::file_status status = fs::status(one, ignored);
  if (fs::exists(status) && !fs::is_regular_file(status)) return false;
  const auto whole = [&](const fs::path& path) {
    return fs::weakly_canonical(fs::absolute(path, ignored), ignored);
  };
  return fs::equivalent(one, other, ignored) || whole(one) == whole(other);
}

}  // namespace

void RequireDistinct(std::span<const NamedFile> files) {
  for (std::size_t i = 0; i < files.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const auto& [name, path] = files[i];
      const auto& [other, other_path] = files[j];
      if (!AreOne(path, other_path)) continue;
      throw std::invalid_argument(fmt::format("{} and {} must be different files", other, name));
    }
  }
}

void RequireUnread(std::span<const fs::path> inputs, const fs::path& target) {
  for (const fs::path& input : inputs) {
    if (!AreOne(target, input)) continue;
    throw std::invalid_argument(fmt::format(
        "{} would be written over by what comes of it: choose another place", input.string()));
  }
}

void RequireUnread(std::span<const fs::path> inputs, const fs::path& folder,
                   std::span<const OutputFile> files) {
  for (const OutputFile& file : files) RequireUnread(inputs, folder / file.name);
}

void RequireNoSurvey(const fs::path& folder, std::span<const OutputFile> files) {
  std::error_code ignored;
  if (!fs::exists(folder / "run.toml", ignored)) return;
  std::vector<std::string> theirs = FilesBesideResult();
  theirs.insert(theirs.end(), kResultFiles.begin(), kResultFiles.end());
  for (const OutputFile& file : files) {
    if (std::ranges::find(theirs, file.name) == theirs.end()) continue;
    throw std::invalid_argument(
        fmt::format("{} holds a survey, which has a {} of its own: choose another --out",
                    folder.string(), file.name));
  }
}

}  // namespace wellgyro::apps

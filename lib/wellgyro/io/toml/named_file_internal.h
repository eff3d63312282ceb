#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "wellgyro/io/text_file.h"
#include "wellgyro/record/noise.h"

namespace wellgyro {

/// The files that a file names, relative to its folder, each noted with its SHA-256.
class NamedFiles {
 public:
  explicit NamedFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}

  std::filesystem::path PathOf(const std::string& name) const { return folder_ / name; }

  /// Reads one and notes it; with `keep_text` run.toml will hold it whole. Throws TomlError.
  std::string Take(std::string_view role, const std::string& name, bool keep_text = false);
  /// Notes the naming file itself, text and all.
  void Note(std::string_view role, const std::filesystem::path& path, std::string_view text);

  const std::vector<InputFile>& all() const { return files_; }

 private:
  std::filesystem::path folder_;
  std::vector<InputFile> files_;
};

/// The coefficients of the noise file `name`. Throws TomlError.
NoiseCoefficients NoiseOfFile(const std::string& name, NamedFiles& files);

}  // namespace wellgyro

#include "wellgyro/io/toml/named_file_internal.h"

#include <utility>

#include "wellgyro/io/sha256.h"
#include "wellgyro/io/toml/noise_file.h"
#include "wellgyro/io/toml/toml_internal.h"

namespace wellgyro {

std::string NamedFiles::Take(std::string_view role, const std::string& name, bool keep_text) {
  Result<std::string> text = ReadTextFile(PathOf(name));
  if (!text) throw TomlError{text.fault()};
  files_.push_back({.role = std::string(role),
                    .name = name,
                    .path = PathOf(name),
                    .sha256 = Sha256Hex(*text),
                    .text = keep_text ? *text : std::string()});
  return *std::move(text);
}

void NamedFiles::Note(std::string_view role, const std::filesystem::path& path,
                      std::string_view text) {
  files_.push_back({.role = std::string(role),
                    .name = path.filename().string(),
                    .path = path,
                    .sha256 = Sha256Hex(text),
                    .text = std::string(text)});
}

NoiseCoefficients NoiseOfFile(const std::string& name, NamedFiles& files) {
  const std::string text = files.Take("noise", name, true);
  const Result<NoiseCoefficients> noise = ParseNoiseFile(text, files.PathOf(name).string());
  if (!noise) throw TomlError{noise.fault()};
  return *noise;
}

}  // namespace wellgyro

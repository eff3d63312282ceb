#include "wellgyro/io/result/result_folder.h"

#include <cstdint>
#include <string>
#include <system_error>

#include <toml++/toml.h>

#include "wellgyro/io/text_file.h"

namespace wellgyro {

Result<bool> HoldsAcceptedResult(const std::filesystem::path& folder) {
  std::error_code ignored;
  const std::filesystem::path run_file = folder / "run.toml";
  if (std::filesystem::exists(run_file, ignored)) {
    const Result<std::string> text = ReadTextFile(run_file);
    if (!text) return text.fault();
    try {
      const toml::table run = toml::parse(*text);
      if (run["accepted"].value_or(false)) return true;
    } catch (const toml::parse_error& error) {
      return Fault{.code = FaultCode::kSyntax,
                   .text = std::string(error.description()),
                   .source = run_file.string(),
                   .line = static_cast<int>(error.source().begin.line),
                   .column = static_cast<int>(error.source().begin.column)};
    }
  }
  const std::filesystem::path passes = folder / "passes.csv";
  if (!std::filesystem::exists(passes, ignored)) return false;
  const Result<std::string> text = ReadTextFile(passes, std::int64_t{1} << 36);
  if (!text) return text.fault();
  return text->find(",definitive,") != std::string::npos;
}

std::optional<Fault> WriteResult(const std::filesystem::path& folder,
                                 std::span<const OutputFile> files) {
  const Result<bool> accepted = HoldsAcceptedResult(folder);
  if (!accepted) {
    Fault fault = accepted.fault();
    fault.text += "; whether a result there was accepted cannot be told: choose a new --out";
    return fault;
  }
  if (*accepted) {
    return Fault{.code = FaultCode::kConflict,
                 .text =
                     "holds a survey that someone accepted, which is never written over: "
                     "choose a new --out",
                 .source = folder.string()};
  }
  return WriteFiles(folder, files);
}

}  // namespace wellgyro

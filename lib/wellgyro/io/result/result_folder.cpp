#include "wellgyro/io/result/result_folder.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <string>
#include <system_error>

#include <toml++/toml.h>

#include "wellgyro/io/exchange/exchange.h"
#include "wellgyro/io/text_file.h"

namespace wellgyro {
namespace {

constexpr const char* kPages[] = {"survey.json", "report.html"};

std::vector<std::string> Exports() {
  std::vector<std::string> names;
  for (const std::string& word : WrittenFormats()) {
    const SurveyFormat format = *SurveyFormatOf(word);
    if (format != SurveyFormat::kCsv) names.push_back(FileNameOf(format, "survey"));
  }
  names.emplace_back("survey.osdu.csv");
  return names;
}

// An export may have the name of somebody's own file: those that a result wrote its run.toml lists.
bool Lists(const std::string& run, const std::string& name) {
  return run.find("name = \"" + name + "\"\n") != std::string::npos;
}

}  // namespace

std::vector<std::string> FilesBesideResult() {
  std::vector<std::string> names = Exports();
  names.insert(names.end(), std::begin(kPages), std::end(kPages));
  return names;
}

void RemoveOlder(const std::filesystem::path& folder, std::span<const OutputFile> files) {
  const Result<std::string> run = ReadTextFile(folder / "run.toml");
  if (!run) return;
  std::vector<std::string> older(std::begin(kPages), std::end(kPages));
  for (const std::string& name : Exports()) {
    if (Lists(*run, name)) older.push_back(name);
  }
  std::error_code absent;
  for (const std::string& name : older) {
    const bool anew =
        std::ranges::any_of(files, [&name](const OutputFile& file) { return file.name == name; });
    if (!anew) std::filesystem::remove(folder / name, absent);
  }
}

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

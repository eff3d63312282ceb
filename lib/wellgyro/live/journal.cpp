#include "wellgyro/live/journal.h"

#include <charconv>
#include <string_view>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/io/atomic_file.h"
#include "wellgyro/io/text_file.h"

namespace wellgyro {
namespace {

constexpr const char* kName = "journal.toml";

std::string Head(const Journal& journal) {
  return fmt::format(
      "# Of a live survey, for --resume.\nformat = \"wellgyro.journal/1\"\n"
      "inputs_sha256 = \"{}\"\nlog = '{}'\nbegun_utime_us = ",
      journal.inputs, journal.log);
}

}  // namespace

Journal JournalOf(const JobFile& job, const std::string& log, std::int64_t begun_us) {
  std::string inputs;
  for (const InputFile& input : job.files) {
    inputs += (inputs.empty() ? "" : " ") + input.sha256;
  }
  return {inputs, std::filesystem::absolute(log).string(), begun_us};
}

bool HasJournal(const std::filesystem::path& folder) {
  std::error_code ignored;
  return std::filesystem::exists(folder / kName, ignored);
}

std::optional<Fault> WriteJournal(const std::filesystem::path& folder, const Journal& journal) {
  const std::string text = Head(journal) + fmt::format("{}\n", journal.begun_us);
  return WriteFiles(folder, std::vector<OutputFile>{{kName, text}});
}

Result<Journal> ReadJournal(const std::filesystem::path& folder, const Journal& now) {
  const std::filesystem::path path = folder / kName;
  if (!HasJournal(folder)) return now;
  const Result<std::string> text = ReadTextFile(path);
  if (!text) return text.fault();
  const std::string head = Head(now);
  std::string_view rest = *text;
  if (rest.starts_with(head)) {
    rest.remove_prefix(head.size());
    Journal journal = now;
    const char* end = rest.data() + rest.size();
    const auto [stop, error] = std::from_chars(rest.data(), end, journal.begun_us);
    if (error == std::errc() && std::string_view(stop, end) == "\n") return journal;
  } else if (rest.find("\nbegun_utime_us = ") != std::string_view::npos) {
    return Fault{FaultCode::kConflict,
                 "is of a survey with another job or another --record log: give those, or survey "
                 "the log afresh with --from LOG",
                 path.string()};
  }
  return Fault{FaultCode::kDamaged, "is damaged: survey the log afresh with --from LOG",
               path.string()};
}

void RemovePartials(const std::filesystem::path& folder) {
  std::error_code error;
  std::vector<std::filesystem::path> partials;
  for (std::filesystem::recursive_directory_iterator entry(folder, error), end;
       !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.starts_with('.') && name.ends_with(".partial")) partials.push_back(entry->path());
  }
  for (const auto& path : partials) std::filesystem::remove(path, error);
}

}  // namespace wellgyro

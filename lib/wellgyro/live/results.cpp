#include "wellgyro/live/results.h"

#include <algorithm>
#include <system_error>

#include <fmt/core.h>

#include "wellgyro/io/result/result_folder.h"

namespace wellgyro {

bool HasLosses(const SourceRecord& source, const Survey& survey) {
  if (!source.faults.empty() || survey.marks_refused > 0) return true;
  for (const RunSummary& run : survey.runs) {
    if (run.samples_lost + run.samples_refused + run.clock_jumps > 0) return true;
  }
  return std::any_of(survey.passes.begin(), survey.passes.end(), [](const Station& station) {
    return Has(station.quality, Quality::kSaturated);
  });
}

bool AnyUsable(const std::vector<ToolResult>& results) {
  return std::ranges::any_of(results,
                             [](const ToolResult& tool) { return tool.survey.unusable.empty(); });
}

RunVerdict WorstVerdict(const std::vector<ToolResult>& results) {
  RunVerdict worst;
  for (const ToolResult& result : results) {
    const RunVerdict& verdict = result.survey.verdict;
    if (result.survey.unusable.empty() && verdict.verdict >= worst.verdict) worst = verdict;
  }
  return worst;
}

std::optional<Fault> AcceptedIn(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> folders = {folder};
  std::error_code absent;
  for (std::filesystem::directory_iterator entry(folder, absent), end; !absent && entry != end;
       entry.increment(absent)) {
    if (entry->path().filename().string().starts_with("tool-")) folders.push_back(entry->path());
  }
  for (const std::filesystem::path& one : folders) {
    const Result<bool> accepted = HoldsAcceptedResult(one);
    if (!accepted) return accepted.fault();
    if (!*accepted) continue;
    return Fault{
        FaultCode::kConflict,
        fmt::format("{} holds a survey that was accepted; choose a new --out", one.string())};
  }
  return std::nullopt;
}

RunRecord RecordOf(const std::string& program, const JobFile& job,
                   const std::vector<SurveyFormat>& formats, const Intake& intake,
                   const FaultBook& surveyor_faults) {
  RunRecord record;
  record.program = program;
  record.inputs = job.files;
  record.channels = intake.Channels();
  record.tools = intake.tools();
  record.faults = surveyor_faults.faults();
  record.operations = intake.operations().records();
  record.operations_obeyed = intake.operations().obeyed();
  record.operations_refused = intake.operations().refused();
  record.formats = formats;
  return record;
}

std::vector<ToolResult> ResultsOf(const Surveyor& surveyor, const std::filesystem::path& folder) {
  std::vector<ToolResult> results;
  for (const std::int32_t tool : surveyor.tools()) {
    results.push_back({tool, folder, surveyor.Current(tool)});
  }
  const auto usable = std::count_if(results.begin(), results.end(),
                                    [](const auto& r) { return r.survey.unusable.empty(); });
  if (results.empty()) results.push_back({0, folder, surveyor.Current(0)});
  for (ToolResult& result : results) {
    if (usable > 1) result.folder /= fmt::format("tool-{}", result.tool);
  }
  return results;
}

void RemoveFormer(const std::filesystem::path& folder, const std::vector<ToolResult>& results) {
  if (std::any_of(results.begin(), results.end(),
                  [&folder](const ToolResult& result) { return result.folder == folder; })) {
    return;
  }
  std::error_code ignored;
  RemoveOlder(folder, {});
  for (const char* name : kResultFiles) std::filesystem::remove(folder / name, ignored);
}

}  // namespace wellgyro

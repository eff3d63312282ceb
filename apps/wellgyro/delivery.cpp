#include "delivery.h"

#include <algorithm>
#include <cstddef>

#include <fmt/core.h>

#include "wellgyro/io/result/result_folder.h"
#include "wellgyro/io/result/summary.h"

#include "commands.h"
#include "report.h"

namespace wellgyro::apps {
namespace {

/// Writes one tool's result; its exit code.
int Deliver(const std::filesystem::path& folder, const RunRecord& record,
            const SourceRecord& source, const Job& job, const Survey& survey) {
  if (!survey.unusable.empty()) {
    Complain(survey.unusable);
    const auto malformed = source.counts.find("malformed");
    if (malformed != source.counts.end() && malformed->second > 0 && !source.faults.empty()) {
      Complain(fmt::format("{} messages came and were refused; the first: {}", malformed->second,
                           Sentence(source.faults.front())));
    }
    return kUnusable;
  }
  const std::vector<OutputFile> files = ResultFiles(record, source, job, survey);
  if (const auto fault = WriteFiles(folder, files)) {
    Complain(*fault);
    return kUnusable;
  }
  fmt::print("{}", SummaryText(survey));
  for (const OutputFile& file : files) {
    fmt::print("wrote {}\n", (folder / file.name).string());
  }
  return kDone;
}

bool HasLosses(const SourceRecord& source, const Survey& survey) {
  if (!source.faults.empty() || survey.marks_refused > 0) return true;
  for (const RunSummary& run : survey.runs) {
    if (run.samples_lost + run.samples_refused + run.clock_jumps > 0) return true;
  }
  for (const Station& station : survey.passes) {
    if (Has(station.quality, Quality::kSaturated)) return true;
  }
  return false;
}

void SayLosses(const SourceRecord& source) {
  constexpr std::size_t kSaid = 5;
  Complain("done, with losses or damage: see source.toml and run.toml");
  for (std::size_t i = 0; i < std::min(source.faults.size(), kSaid); ++i) {
    Complain(source.faults[i]);
  }
}

}  // namespace

bool MayWriteTo(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> folders = {folder};
  std::error_code absent;
  for (std::filesystem::directory_iterator entry(folder, absent), end; !absent && entry != end;
       entry.increment(absent)) {
    if (entry->path().filename().string().starts_with("tool-")) folders.push_back(entry->path());
  }
  for (const std::filesystem::path& one : folders) {
    const Result<bool> accepted = HoldsAcceptedResult(one);
    if (accepted && !*accepted) continue;
    Complain(accepted ? fmt::format("{} holds a survey that was accepted; choose a new --out",
                                    one.string())
                      : Sentence(accepted.fault()));
    return false;
  }
  return true;
}

RunRecord RecordOf(const JobFile& job, const std::vector<SurveyFormat>& formats,
                   const Intake& intake, const FaultBook& surveyor_faults) {
  RunRecord record;
  record.program = "wellgyro " WELLGYRO_VERSION;
  record.adjuster = AdjusterOf(job.job);
  record.inputs = job.files;
  record.channels = intake.Channels();
  record.tools = intake.tools();
  record.faults = surveyor_faults.faults();
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
  for (const char* name : {"survey.csv", "passes.csv", "checks.csv", "source.toml", "run.toml"}) {
    std::filesystem::remove(folder / name, ignored);
  }
}

int DeliverAll(const std::filesystem::path& folder, const JobFile& job, const Surveyor& surveyor,
               const RunRecord& record, const SourceRecord& source) {
  const std::vector<ToolResult> results = ResultsOf(surveyor, folder);
  const bool any = std::any_of(results.begin(), results.end(),
                               [](const auto& r) { return r.survey.unusable.empty(); });
  RunVerdict worst;
  bool losses = false;
  for (const ToolResult& result : results) {
    if (results.size() > 1) fmt::print("tool {}\n", result.tool);
    const int one = Deliver(result.folder, record, source, job.job, result.survey);
    if (one == kUnusable && result.survey.unusable.empty()) return kUnusable;
    const RunVerdict& verdict = result.survey.verdict;
    if (result.survey.unusable.empty() && verdict.verdict > worst.verdict) worst = verdict;
    losses = losses || one == kUnusable || HasLosses(source, result.survey);
  }
  RemoveFormer(folder, results);
  if (!any) return kUnusable;
  if (losses) SayLosses(source);
  fmt::print("{}\n", VerdictText(worst));
  return worst.verdict == Verdict::kFail ? kUnfit : losses ? kDoneWithLosses : kDone;
}

}  // namespace wellgyro::apps

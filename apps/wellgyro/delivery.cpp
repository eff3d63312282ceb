#include "delivery.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/io/result/result_folder.h"

#include "commands.h"
#include "report.h"
#include "result_report.h"

namespace wellgyro::apps {
namespace {

enum class Files { kToWrite, kWritten };

/// How the results are handed over, and what has been.
struct Delivery {
  Files state;
  Says says;
  bool page;  ///< report.html too
  std::vector<ToolSummary> done = {};
  int report = kDone;  ///< exit code of what is written beside the results
};

constexpr std::size_t kSaid = 5;  // of faults; all are in the files

void Say(const std::vector<Fault>& faults) {
  for (std::size_t i = 0; i < std::min(faults.size(), kSaid); ++i) Complain(faults[i]);
}

/// Where there is no survey at all: what else was found that may be the reason.
void SayReasons(const RunRecord& record, const SourceRecord& source) {
  Say(record.faults);
  Say(source.faults);
  const auto malformed = source.counts.find("malformed");
  if (malformed != source.counts.end() && malformed->second > 0) {
    Complain(fmt::format("{} messages came and were refused", malformed->second));
  }
}

/// Writes one tool's result where it is not written yet, and says what it is; its exit code.
int Deliver(Delivery& delivery, const ToolResult& result, const RunRecord& record,
            const SourceRecord& source, const Job& job) {
  const Survey& survey = result.survey;
  if (!survey.unusable.empty()) {
    Complain(survey.unusable);
    return kUnusable;
  }
  const std::vector<OutputFile> files = ResultFiles(record, source, job, survey);
  if (delivery.state == Files::kToWrite) {
    RemoveOlder(result.folder, files);
    if (const auto fault = WriteFiles(result.folder, files)) return Unusable(*fault);
  }
  ToolSummary& summary = delivery.done.emplace_back();
  summary = {.tool = result.tool, .folder = result.folder, .survey = &survey};
  for (const OutputFile& file : files) summary.files.push_back(file.name);
  delivery.report =
      std::max(delivery.report, ReportInto(result.folder, delivery.page, summary.files));
  if (delivery.says != Says::kSummary) return kDone;
  fmt::print("{}", SummaryText(survey));
  for (const std::string& name : summary.files) {
    fmt::print("wrote {}\n", (result.folder / name).string());
  }
  return kDone;
}

/// Tools that made no survey beside one that did: a damaged number in a message, mostly.
bool Nothing(const ToolResult& result) { return !result.survey.unusable.empty(); }

void SayLosses(const SourceRecord& source) {
  Complain("done, with losses or damage: see source.toml and run.toml");
  Say(source.faults);
}

int DeliverTools(Delivery& delivery, const std::vector<ToolResult>& results, const JobFile& job,
                 const RunRecord& record, const SourceRecord& source) {
  const auto nothing = std::count_if(results.begin(), results.end(), Nothing);
  const bool any = nothing < std::ssize(results);
  bool told = false, losses = false;
  for (const ToolResult& result : results) {
    const bool of_many = any && nothing > 1 && Nothing(result);
    if (of_many && std::exchange(told, true)) continue;
    if (of_many) {
      Complain(fmt::format("{} more tools were heard of that made no survey", nothing));
    } else if (results.size() > 1 && delivery.says == Says::kSummary) {
      fmt::print("tool {}\n", result.tool);
    }
    const int one = Deliver(delivery, result, record, source, job.job);
    if (one == kUnusable && !Nothing(result)) return kUnusable;
    losses = losses || one == kUnusable || HasLosses(source, result.survey);
  }
  if (!any) {
    SayReasons(record, source);
    return kUnusable;
  }
  if (losses) SayLosses(source);
  return losses ? kDoneWithLosses : kDone;
}

}  // namespace

std::string ProgramName() { return "wellgyro " WELLGYRO_VERSION; }

bool MayWriteTo(const std::filesystem::path& folder) {
  const auto fault = AcceptedIn(folder);
  if (fault) Complain(*fault);
  return !fault;
}

int DeliverAll(const std::filesystem::path& folder, const JobFile& job, const Surveyor& surveyor,
               const RunRecord& record, const SourceRecord& source, Says says, bool page) {
  const std::vector<ToolResult> results = ResultsOf(surveyor, folder);
  Delivery delivery{Files::kToWrite, says, page};
  const int code = DeliverTools(delivery, results, job, record, source);
  RemoveFormer(folder, results);
  if (code == kUnusable) return code;
  const int all = Conclude(WorstVerdict(results), code == kDoneWithLosses, says, delivery.done);
  return all == kDone ? delivery.report : all;
}

int Summarise(const JobFile& job, const LiveOutcome& outcome, Says says, bool page) {
  Delivery delivery{Files::kWritten, says, page};
  const int code = DeliverTools(delivery, outcome.tools, job, *outcome.record, *outcome.source);
  if (code == kUnusable) return code;
  if (!outcome.recording_is_whole) Complain("done, but the recording lacks messages");
  const bool losses = code == kDoneWithLosses || !outcome.recording_is_whole;
  const int all = Conclude(WorstVerdict(outcome.tools), losses, says, delivery.done);
  return all == kDone ? delivery.report : all;
}

int Conclude(const RunVerdict& verdict, bool losses, Says says,
             std::span<const ToolSummary> tools) {
  const int code = verdict.verdict == Verdict::kFail ? kUnfit : losses ? kDoneWithLosses : kDone;
  if (says == Says::kSummary) fmt::print("{}\n", VerdictText(verdict));
  if (says == Says::kJson) fmt::print("{}", SummaryJson(tools, verdict, code));
  return code;
}

}  // namespace wellgyro::apps

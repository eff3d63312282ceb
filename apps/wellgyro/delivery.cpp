#include "delivery.h"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/io/result/summary.h"

#include "commands.h"
#include "report.h"

namespace wellgyro::apps {
namespace {

enum class Files { kToWrite, kWritten };

/// Writes one tool's result where it is not written yet, and says what it is; its exit code.
int Deliver(Files state, const std::filesystem::path& folder, const RunRecord& record,
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
  if (state == Files::kToWrite) {
    if (const auto fault = WriteFiles(folder, files)) {
      Complain(*fault);
      return kUnusable;
    }
  }
  fmt::print("{}", SummaryText(survey));
  for (const OutputFile& file : files) {
    fmt::print("wrote {}\n", (folder / file.name).string());
  }
  return kDone;
}

/// Tools that made no survey beside one that did: a damaged number in a message, mostly.
bool Nothing(const ToolResult& result) { return !result.survey.unusable.empty(); }

void SayLosses(const SourceRecord& source) {
  constexpr std::size_t kSaid = 5;
  Complain("done, with losses or damage: see source.toml and run.toml");
  for (std::size_t i = 0; i < std::min(source.faults.size(), kSaid); ++i) {
    Complain(source.faults[i]);
  }
}

int DeliverTools(Files state, const std::vector<ToolResult>& results, const JobFile& job,
                 const RunRecord& record, const SourceRecord& source) {
  const auto nothing = std::count_if(results.begin(), results.end(), Nothing);
  const bool any = nothing < std::ssize(results);
  bool told = false, losses = false;
  for (const ToolResult& result : results) {
    const bool of_many = any && nothing > 1 && Nothing(result);
    if (of_many && std::exchange(told, true)) continue;
    if (of_many) {
      Complain(fmt::format("{} more tools were heard of that made no survey", nothing));
    } else if (results.size() > 1) {
      fmt::print("tool {}\n", result.tool);
    }
    const int one = Deliver(state, result.folder, record, source, job.job, result.survey);
    if (one == kUnusable && !Nothing(result)) return kUnusable;
    losses = losses || one == kUnusable || HasLosses(source, result.survey);
  }
  if (!any) return kUnusable;
  if (losses) SayLosses(source);
  return losses ? kDoneWithLosses : kDone;
}

}  // namespace

Maker MakerOf(const Job& job) {
  return {"wellgyro " WELLGYRO_VERSION,
          InAngles(job) ? "least squares in angles" : "least squares of rotations"};
}

bool MayWriteTo(const std::filesystem::path& folder) {
  const auto fault = AcceptedIn(folder);
  if (fault) Complain(*fault);
  return !fault;
}

int DeliverAll(const std::filesystem::path& folder, const JobFile& job, const Surveyor& surveyor,
               const RunRecord& record, const SourceRecord& source) {
  const std::vector<ToolResult> results = ResultsOf(surveyor, folder);
  const int code = DeliverTools(Files::kToWrite, results, job, record, source);
  RemoveFormer(folder, results);
  return code == kUnusable ? code : Conclude(WorstVerdict(results), code == kDoneWithLosses);
}

int Summarise(const JobFile& job, const LiveOutcome& outcome) {
  const int code =
      DeliverTools(Files::kWritten, outcome.tools, job, outcome.record, outcome.source);
  if (code == kUnusable) return code;
  if (!outcome.recording_is_whole) Complain("done, but the recording lacks messages");
  return Conclude(WorstVerdict(outcome.tools),
                  code == kDoneWithLosses || !outcome.recording_is_whole);
}

int Conclude(const RunVerdict& verdict, bool losses) {
  fmt::print("{}\n", VerdictText(verdict));
  return verdict.verdict == Verdict::kFail ? kUnfit : losses ? kDoneWithLosses : kDone;
}

}  // namespace wellgyro::apps

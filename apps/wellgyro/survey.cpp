#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/bus/feed.h"
#include "wellgyro/bus/log_reader.h"
#include "wellgyro/bus/surveyor_listener.h"
#include "wellgyro/io/atomic_file.h"
#include "wellgyro/io/job_file.h"
#include "wellgyro/io/run_file.h"
#include "wellgyro/io/sha256.h"
#include "wellgyro/io/summary.h"
#include "wellgyro/survey/surveyor.h"

#include "commands.h"
#include "report.h"

namespace wellgyro::apps {
namespace {

constexpr std::size_t kFaultsKept = 1000;

struct SurveyOptions {
  std::string job, from, out;
};

/// Keeps the first faults and counts them all.
class FaultBook : public Sink {
 public:
  void OnFault(const Fault& fault) override {
    ++count_;
    if (faults_.size() < kFaultsKept) faults_.push_back(fault);
  }
  const std::vector<Fault>& faults() const { return faults_; }
  std::int64_t count() const { return count_; }

 private:
  std::vector<Fault> faults_;
  std::int64_t count_ = 0;
};

/// The messages of one source on their way into a surveyor, with what is written about them.
class Intake {
 public:
  Intake(const Job& job, Surveyor& surveyor)
      : listener_(surveyor, feed_faults_),
        feed_(job.channels, listener_,
              [this](MessageType type, std::string_view, std::span<const std::byte> bytes) {
                digests_[static_cast<std::size_t>(type)].Update(bytes);
              }) {}

  void Take(const LogEvent& event) { feed_.Take(event.channel, event.data, event.data_offset); }

  std::vector<ChannelRecord> Channels() const {
    std::vector<ChannelRecord> records;
    for (int i = 0; i < kMessageTypes; ++i) {
      const auto type = static_cast<MessageType>(i);
      if (feed_.count(type).messages == 0) continue;
      records.push_back({NameOf(feed_.channels(), type), std::string(TypeName(type)),
                         feed_.count(type).messages,
                         digests_[static_cast<std::size_t>(i)].HexDigest()});
    }
    return records;
  }

  const Feed& feed() const { return feed_; }
  const std::vector<Fault>& faults() const { return feed_faults_.faults(); }

 private:
  FaultBook feed_faults_;
  SurveyorListener listener_;
  std::array<Sha256, kMessageTypes> digests_;
  Feed feed_;
};

SourceRecord Describe(const std::string& name, const Intake& intake, const LogReader& reader) {
  SourceRecord source;
  source.name = name;
  source.faults = reader.Faults();
  source.faults.insert(source.faults.end(), intake.faults().begin(), intake.faults().end());
  source.counts["events"] = reader.health().events;
  source.counts["bytes_lost"] = reader.health().lost_bytes;
  source.counts["gaps"] = reader.health().gap_count;
  source.counts["malformed"] = intake.feed().malformed();
  for (const auto& [channel, foreign] : intake.feed().foreign()) {
    source.counts["foreign_messages"] += foreign.messages;
  }
  return source;
}

/// A channel that carries one of our types under a name that the job does not know.
void HintAtChannels(const Feed& feed) {
  for (const auto& [channel, foreign] : feed.foreign()) {
    if (!foreign.type) continue;
    Complain(
        fmt::format("channel {} carries {} messages; if they are the tool's, name it under "
                    "[channels] in the job",
                    Printable(channel), TypeName(*foreign.type)));
  }
}

/// Writes one tool's result; its exit code.
int Deliver(const std::filesystem::path& folder, const RunRecord& record,
            const SourceRecord& source, const Job& job, const Survey& survey) {
  if (!survey.unusable.empty()) {
    Complain(survey.unusable);
    return kUnusable;
  }
  const std::vector<OutputFile> files = ResultFiles(record, source, job, survey);
  if (const auto fault = WriteResult(folder, files)) {
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
  if (!source.faults.empty()) return true;
  for (const RunSummary& run : survey.runs) {
    if (run.samples_lost > 0) return true;
  }
  for (const Station& station : survey.passes) {
    if (Has(station.quality, Quality::kSaturated)) return true;
  }
  return false;
}

/// One folder for each tool where several tools have surveys. A tool without one, which may be no
/// more than a damaged number in a message, is told and takes no folder.
int DeliverAll(const SurveyOptions& options, const JobFile& job, const Surveyor& surveyor,
               const RunRecord& record, const SourceRecord& source) {
  std::vector<std::pair<std::int32_t, Survey>> surveys;
  for (const std::int32_t tool : surveyor.tools())
    surveys.emplace_back(tool, surveyor.Current(tool));
  const auto usable = std::count_if(surveys.begin(), surveys.end(),
                                    [](const auto& s) { return s.second.unusable.empty(); });
  if (surveys.empty()) surveys.emplace_back(0, surveyor.Current(0));
  int code = usable > 0 ? kDone : kUnusable;
  for (const auto& [tool, survey] : surveys) {
    if (surveys.size() > 1) fmt::print("tool {}\n", tool);
    std::filesystem::path folder = options.out;
    if (usable > 1) folder /= fmt::format("tool-{}", tool);
    const int one = Deliver(folder, record, source, job.job, survey);
    if (one == kUnusable && survey.unusable.empty()) return kUnusable;
    if (code != kUnusable && (one == kUnusable || HasLosses(source, survey)))
      code = kDoneWithLosses;
  }
  return code;
}

int SurveyLog(const SurveyOptions& options) {
  const Result<JobFile> job = ReadJob(options.job);
  if (!job) {
    Complain(job.fault());
    return kUnusable;
  }
  const Result<bool> accepted = HoldsAcceptedResult(options.out);
  if (!accepted || *accepted) {
    Complain(accepted ? fmt::format("{} holds a survey that was accepted; choose a new --out",
                                    options.out)
                      : Sentence(accepted.fault()));
    return kUnusable;
  }
  Result<LogReader> reader = LogReader::Open(options.from);
  if (!reader) {
    Complain(reader.fault());
    return kUnusable;
  }
  FaultBook faults;
  Surveyor surveyor(job->job, faults);
  Intake intake(job->job, surveyor);
  {
    Progress progress("surveying");
    std::error_code ignored;
    const auto size = static_cast<std::int64_t>(std::filesystem::file_size(options.from, ignored));
    LogEvent event;
    while (reader->Next(event)) {
      intake.Take(event);
      progress.Show(event.data_offset, ignored ? 0 : size);
    }
    surveyor.Finish();
  }
  HintAtChannels(intake.feed());
  RunRecord record;
  record.program = "wellgyro " WELLGYRO_VERSION;
  record.inputs = job->files;
  record.channels = intake.Channels();
  record.faults = faults.faults();
  const SourceRecord source = Describe(options.from, intake, *reader);
  const int code = DeliverAll(options, *job, surveyor, record, source);
  if (code == kDoneWithLosses) {
    Complain("done, with losses or damage: see source.toml and run.toml");
    for (std::size_t i = 0; i < std::min<std::size_t>(source.faults.size(), 5); ++i) {
      Complain(source.faults[i]);
    }
  }
  return code;
}

}  // namespace

void AddSurvey(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<SurveyOptions>();
  CLI::App* command = app.add_subcommand(
      "survey",
      "Turns a sensor stream into survey files: survey.csv, passes.csv, checks.csv, "
      "run.toml and source.toml");
  command->add_option("--job", options->job, "Job file, wellgyro.job/1")
      ->required()
      ->type_name("FILE");
  command->add_option("--from", options->from, "LCM log; - for standard input")
      ->required()
      ->type_name("LOG");
  command->add_option("--out", options->out, "Folder for the survey files")
      ->required()
      ->type_name("DIR");
  command->footer(
      "Example:\n  wellgyro survey --job data/demo/job.toml --from data/demo/run.lcm "
      "--out result");
  command->callback([options, &exit_code] { exit_code = SurveyLog(*options); });
}

}  // namespace wellgyro::apps

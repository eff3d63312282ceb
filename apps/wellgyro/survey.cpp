#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/bus/file_lock.h"
#include "wellgyro/bus/log_parts.h"
#include "wellgyro/bus/log_reader.h"
#include "wellgyro/io/exchange/exchange.h"
#include "wellgyro/io/result/run_file.h"
#include "wellgyro/io/sensor/sensor_files.h"
#include "wellgyro/io/toml/job_file.h"
#include "wellgyro/live/intake.h"
#include "wellgyro/live/results.h"
#include "wellgyro/survey/surveyor.h"

#include "choice.h"
#include "commands.h"
#include "delivery.h"
#include "live.h"
#include "live_survey.h"
#include "report.h"
#include "result_report.h"

namespace wellgyro::apps {
namespace {

/// What a log, or a part of one, was like, beside the parts before it.
void Describe(const std::string& name, const LogReader& reader, SourceRecord& source) {
  source.name += (source.name.empty() ? "" : ", ") + name;
  for (const Fault& fault : reader.Faults()) source.faults.push_back(fault);
  source.counts["events"] += reader.health().events;
  source.counts["bytes_lost"] += reader.health().lost_bytes;
  source.counts["gaps"] += reader.health().gap_count;
}

void Describe(const Intake& intake, SourceRecord& source) {
  source.faults.insert(source.faults.end(), intake.faults().faults().begin(),
                       intake.faults().faults().end());
  source.counts["malformed"] = intake.feed().malformed();
  for (const auto& [channel, foreign] : intake.feed().foreign()) {
    source.counts["foreign_messages"] += foreign.messages;
  }
}

/// All of one log, or of a part of one, into `intake`; false where it is none.
bool PushLog(const std::string& path, const SurveyOptions& options, const Surveyor& surveyor,
             Intake& intake, SourceRecord& source) {
  Result<LogReader> reader = LogReader::Open(path);
  if (!reader) {
    Fault fault = reader.fault();
    if (fault.code == FaultCode::kForeign) fault.text += ", nor a table of sensor data";
    Complain(fault);
    return false;
  }
  Progress progress("surveying", options.says != Says::kNothing);
  std::error_code ignored;
  const auto size = static_cast<std::int64_t>(std::filesystem::file_size(path, ignored));
  LogEvent event;
  while (!surveyor.finished() && reader->Next(event)) {
    intake.Take(event.channel, event.data, event.data_offset);
    progress.Show(event.data_offset, ignored ? 0 : size);
  }
  Describe(path, *reader, source);
  return true;
}

/// The last adjustment, which may take as long as all before it.
void FinishSurvey(Surveyor& surveyor, const SurveyOptions& options) {
  Progress progress("adjusting", options.says != Says::kNothing);
  progress.Show();
  surveyor.Finish();
}

int SurveyLog(const SurveyOptions& options, const JobFile& job) {
  FaultBook faults;
  Surveyor surveyor(job.job, faults);
  Intake intake(job, surveyor);
  SourceRecord source;
  const std::vector<std::string> parts =
      options.sources.size() > 1 ? options.sources : LogParts(options.from);
  for (const std::string& part : parts) {
    if (!PushLog(part, options, surveyor, intake, source)) return kUnusable;
  }
  FinishSurvey(surveyor, options);
  for (const std::string& hint : HintsAtChannels(intake.feed())) Complain(hint);
  Describe(intake, source);
  return DeliverAll(options.out, job, surveyor,
                    RecordOf(MakerOf(), job, options.formats, intake, faults), source,
                    options.says);
}

/// From tables of sensor data: samples, averages at rest, depth.
int SurveyTables(const SurveyOptions& options, const JobFile& job) {
  FaultBook faults;
  Surveyor surveyor(job.job, faults);
  const std::vector<std::filesystem::path> files(options.sources.begin(), options.sources.end());
  const Result<SensorReport> report = PushSensorFiles(files, job.job, surveyor, faults);
  if (!report) return Unusable(report.fault());
  FinishSurvey(surveyor, options);
  RunRecord record;
  const Maker maker = MakerOf();
  record.program = maker.program;
  record.adjuster = maker.adjuster;
  record.inputs = job.files;
  record.inputs.insert(record.inputs.end(), report->files.begin(), report->files.end());
  record.faults = faults.faults();
  record.clock = report->clock;
  record.formats = options.formats;
  record.stamps_less_stops = report->stamps_less_stops;
  SourceRecord source;
  for (const std::string& name : options.sources) {
    source.name += (source.name.empty() ? "" : ", ") + name;
  }
  source.counts["samples"] = report->samples;
  source.counts["still_windows"] = report->windows;
  source.counts["depth_marks"] = report->marks;
  return DeliverAll(options.out, job, surveyor, record, source, options.says);
}

/// Says what the job lacks for one of the formats, before the work rather than after it.
bool CanExport(const Job& job, const std::vector<SurveyFormat>& formats) {
  try {
    RequireFormats(job, formats);
  } catch (const std::exception& error) {
    Complain(fmt::format("--formats: {}", error.what()));
    return false;
  }
  return true;
}

/// Says so and gives true where two of `sources` are one file, whose samples would come twice.
bool AnyTwice(const std::vector<std::string>& sources) {
  std::set<std::filesystem::path> seen;
  std::error_code ignored;
  for (const std::string& source : sources) {
    if (seen.insert(std::filesystem::weakly_canonical(source, ignored)).second) continue;
    Complain(fmt::format("{} is named twice", source));
    return true;
  }
  return false;
}

int SurveyAny(SurveyOptions options) {
  if (!options.sources.empty()) options.from = options.sources.front();
  const Result<JobFile> job = ReadJob(options.job);
  if (!job) return Unusable(job.fault());
  if (!CanExport(job->job, options.formats)) return kUnusable;
  if (IsLive(options.from)) return SurveyLive(options, *job);
  if (!options.record.empty() || options.resume || !options.fill.empty() ||
      !options.advise.empty() || !options.page.address.empty()) {
    return Misused(
        "--record, --resume, --fill, --advise and --page are for a live stream: --from URL");
  }
  if (AnyTwice(options.sources) || !MayWriteTo(options.out)) return kUnusable;
  // A folder that is new is nobody else's.
  std::optional<FileLock> lock;
  if (std::filesystem::is_directory(options.out)) {
    Result<FileLock> taken = FileLock::Take(options.out);
    if (!taken) return Unusable(taken.fault());
    lock.emplace(std::move(*taken));
  }
  const bool tables = IsSensorTable(options.from) ||
                      std::any_of(options.sources.begin(), options.sources.end(), IsSensorTable);
  return tables ? SurveyTables(options, *job) : SurveyLog(options, *job);
}

void AddLiveOptions(CLI::App& command, SurveyOptions& options) {
  command.add_option("--record", options.record, "Write what is heard live to this LCM log")
      ->type_name("LOG");
  command
      .add_option(
          "--advise", options.advise,
          "Plan file, wellgyro.plan/1: say live where to stop and how long, for its limits; "
          "the survey stays as it is")
      ->type_name("PLAN");
  command.add_flag("--resume", options.resume,
                   "Continue a live survey that was cut off, from its --record log");
  command
      .add_option("--fill", options.fill,
                  "With --resume: another recorder's log, for what was sent meanwhile")
      ->type_name("LOG");
}

void AddPageOptions(CLI::App& command, SurveyPageOptions& page) {
  CLI::Option* address =
      command
          .add_option("--page", page.address,
                      "Serve the live page here, as 127.0.0.1:8080; on another address than this "
                      "machine's loopback who looks needs a token, which is said")
          ->type_name("ADDRESS");
  command
      .add_option("--page-token", page.token_file,
                  "Want a token, and keep it in this file, so that it stays the same when the "
                  "survey is resumed; made where it is not there")
      ->needs(address)
      ->type_name("FILE");
  command
      .add_option("--page-key", page.key,
                  "Private key, listed in the job, that signs what the page orders: adjust, "
                  "accept, reject, remarks; who looks needs a token then")
      ->needs(address)
      ->type_name("PEM");
  command
      .add_option("--page-plan", page.plan,
                  "The path as planned, in any format that convert reads, drawn in the page")
      ->needs(address)
      ->type_name("FILE");
  command
      .add_option("--page-sigma-deg", page.sigma_deg,
                  "The azimuth's sigma that a stop is to reach: the page says how long it must "
                  "still last, as far as the gyros' noise goes")
      ->needs(address)
      ->check(CLI::Range(1e-3, 90.0));
}

void AddSays(CLI::App& command, Says& says) {
  CLI::Option* quiet = command.add_flag_callback(
      "--quiet", [&says] { says = Says::kNothing; },
      "Say nothing but what went wrong; the exit code has the verdict");
  command
      .add_flag_callback(
          "--json", [&says] { says = Says::kJson; },
          "The summary as one JSON document, wellgyro.summary/1, and nothing else on standard "
          "output")
      ->excludes(quiet);
}

void AddFormats(CLI::App& command, SurveyOptions& options) {
  CLI::Option* const formats =
      command
          .add_option_function<std::vector<std::string>>(
              "--formats",
              [&options](const std::vector<std::string>& words) {
                for (const std::string& word : words) {
                  options.formats.push_back(*SurveyFormatOf(word));
                }
              },
              "Files for others, beside survey.csv: las, p717, witsml (1.4.1.1), witsml21, petrel, "
              "compass, osdu")
          ->delimiter(',');
  TakeWord(formats, {"csv", "las", "p717", "witsml", "witsml21", "petrel", "compass", "osdu"})
      ->type_name("LIST");
}

/// What stands beside the survey's files once they are whole; its trouble shows where the survey
/// had none.
int SurveyAndReport(const SurveyOptions& options, bool page) {
  const int code = SurveyAny(options);
  if (code != kDone && code != kDoneWithLosses && code != kUnfit) return code;
  const int report = ReportOnSurvey(options.out, page);
  return code == kDone ? report : code;
}

}  // namespace

void AddSurvey(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<SurveyOptions>();
  CLI::App* command =
      app.add_subcommand("survey",
                         "A sensor stream into a folder of survey files: survey.csv, passes.csv, "
                         "checks.csv and others");
  command->add_option("--job", options->job, "Job file, wellgyro.job/1")
      ->required()
      ->type_name("FILE");
  command
      ->add_option(
          "--from", options->sources,
          "LCM log, with the parts that follow a rotated one, - for standard input, or an LCM URL "
          "as udpm://239.255.76.67:7667; by default LCM_DEFAULT_URL, or LCM's own default. Or "
          "tables of samples, of "
          "averages at rest and of depth, or P7/17 with G7 records, each with its own --from")
      ->allow_extra_args(false)
      ->type_name("LOG|URL|CSV");
  command->add_option("--out", options->out, "Folder for the survey files")
      ->required()
      ->type_name("DIR");
  AddLiveOptions(*command, *options);
  AddPageOptions(*command, options->page);
  AddFormats(*command, *options);
  AddSays(*command, options->says);
  auto page = std::make_shared<bool>(false);
  command->add_flag("--report", *page, "The report too, as report.html among the survey files");
  command->footer(
      "Example:\n  wellgyro survey --job data/demo/job.toml --from data/demo/run.lcm "
      "--out result\n"
      "  wellgyro survey --job job.toml --from tool.csv --from tally.csv --out result\n"
      "  wellgyro survey --job job.toml --from udpm://239.255.76.67:7667 --page 127.0.0.1:8080 "
      "--out live");
  command->callback([options, page, &exit_code] { exit_code = SurveyAndReport(*options, *page); });
}

}  // namespace wellgyro::apps

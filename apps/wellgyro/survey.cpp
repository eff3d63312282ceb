#include <algorithm>
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
#include "wellgyro/io/exchange/exchange.h"
#include "wellgyro/io/result/result_folder.h"
#include "wellgyro/io/sensor/sensor_files.h"
#include "wellgyro/io/toml/job_file.h"

#include "choice.h"
#include "commands.h"
#include "delivery.h"
#include "distinct.h"
#include "live.h"
#include "live_survey.h"
#include "recorded_survey.h"
#include "report.h"

namespace wellgyro::apps {
namespace {

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

/// Throws std::invalid_argument where the result would take the place of what it is made of.
void RequireKept(const SurveyOptions& options, const JobFile& job) {
  namespace fs = std::filesystem;
  std::vector<fs::path> inputs = PathsOf(job.files);
  inputs.insert(inputs.end(), options.sources.begin(), options.sources.end());
  inputs.insert(inputs.end(), options.fill.begin(), options.fill.end());
  inputs.emplace_back(options.record);
  inputs.emplace_back(options.advise);
  std::vector<fs::path> folders = {options.out};
  std::error_code absent;
  for (fs::directory_iterator entry(options.out, absent), end; !absent && entry != end;
       entry.increment(absent)) {
    if (entry->path().filename().string().starts_with("tool-")) folders.push_back(entry->path());
  }
  for (const fs::path& folder : folders) {
    for (const char* const name : kResultFiles) RequireUnread(inputs, folder / name);
    for (const std::string& name : FilesBesideResult()) RequireUnread(inputs, folder / name);
  }
}

int SurveyAny(SurveyOptions options) {
  if (!options.sources.empty()) options.from = options.sources.front();
  const Result<JobFile> job = ReadJob(options.job);
  if (!job) return Unusable(job.fault());
  try {
    RequireKept(options, *job);
  } catch (const std::invalid_argument& error) {
    return Misused(error.what());
  }
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
  command->add_flag("--report", options->report,
                    "The report too, as report.html among the survey files");
  command->footer(
      "Example:\n  wellgyro survey --job data/demo/job.toml --from data/demo/run.lcm "
      "--out result\n"
      "  wellgyro survey --job job.toml --from tool.csv --from tally.csv --out result\n"
      "  wellgyro survey --job job.toml --from udpm://239.255.76.67:7667 \\\n"
      "      --page 127.0.0.1:8080 --out live");
  command->callback([options, &exit_code] { exit_code = SurveyAny(*options); });
}

}  // namespace wellgyro::apps

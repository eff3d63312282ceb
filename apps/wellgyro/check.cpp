#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/bus/feed.h"
#include "wellgyro/bus/log_reader.h"
#include "wellgyro/io/exchange/delivery_check.h"
#include "wellgyro/io/exchange/exchange.h"
#include "wellgyro/io/exchange/survey_csv.h"
#include "wellgyro/io/sensor/file_kind.h"
#include "wellgyro/io/sensor/sensor_csv.h"
#include "wellgyro/io/toml/clearance_file.h"
#include "wellgyro/io/toml/error_model_file.h"
#include "wellgyro/io/toml/job_file.h"
#include "wellgyro/io/toml/noise_file.h"
#include "wellgyro/io/toml/program_file.h"
#include "wellgyro/io/toml/simulation_file.h"
#include "wellgyro/io/words.h"
#include "wellgyro/survey/job.h"
#include "wellgyro/survey/job_keys.h"

#include "commands.h"
#include "report.h"

namespace wellgyro::apps {
namespace {

constexpr std::size_t kFaultsShown = 10;

/// Says what is wrong with a file, or that nothing is.
int Tell(const std::string& name, const std::string& what, const std::vector<Fault>& faults,
         ExitCode if_any) {
  fmt::print("{}: {}{}\n", name, what, faults.empty() ? ", whole" : "");
  for (std::size_t i = 0; i < std::min(faults.size(), kFaultsShown); ++i) {
    fmt::print("  {}\n", SentenceOf(faults[i]));
  }
  if (faults.size() > kFaultsShown) fmt::print("  and {} more\n", faults.size() - kFaultsShown);
  return faults.empty() ? kDone : if_any;
}

template <class T>
std::vector<Fault> FaultOf(const Result<T>& result) {
  if (result) return {};
  return {result.fault()};
}

std::vector<Fault> FaultsOfJob(const std::string& name) {
  const Result<JobFile> job = ReadJob(name);
  if (!job) return {job.fault()};
  try {
    CheckJob(job->job);
  } catch (const std::invalid_argument& error) {
    return {Fault{FaultCode::kConflict, error.what(), name}};
  }
  return {};
}

struct FaultList : Listener {
  void OnFault(const Fault& fault) override { faults.push_back(fault); }
  std::vector<Fault> faults;
};

int CheckLog(const std::string& name) {
  Result<LogReader> reader = LogReader::Open(name);
  if (!reader) return Unusable(reader.fault());
  FaultList list;
  Feed feed(Channels{}, list);
  LogEvent event;
  while (reader->Next(event)) feed.Take(event.channel, event.data, event.data_offset);
  std::vector<Fault> faults = reader->Faults();
  faults.insert(faults.end(), list.faults.begin(), list.faults.end());
  std::string what = fmt::format("an LCM log of {} events", reader->health().events);
  for (int i = 0; i < kMessageTypes; ++i) {
    const auto type = static_cast<MessageType>(i);
    const std::int64_t messages = feed.count(type).messages;
    if (messages > 0) what += fmt::format(", {} {}", messages, TypeName(type));
  }
  for (const auto& [channel, foreign] : feed.foreign()) {
    what += fmt::format(", {} on {}{}", foreign.messages, Printable(channel),
                        foreign.type ? fmt::format(" ({})", TypeName(*foreign.type)) : "");
  }
  return Tell(name, what, faults, kDoneWithLosses);
}

std::vector<Fault> FaultsOfSensorTable(const std::string& name) {
  Result<SensorCsv> table = SensorCsv::Open(name);
  if (!table) return {table.fault()};
  SensorCsv::Row row;
  while (table->Next(row)) {
  }
  return table->fault() ? std::vector<Fault>{*table->fault()} : std::vector<Fault>();
}

/// A survey.csv. Its rows are all that it has, so that one which is cut behind a row looks whole.
int CheckSurvey(const std::string& name, const std::string& what) {
  const std::vector<Fault> faults = FaultOf(ReadSurveyCsv(name));
  if (!faults.empty()) return Tell(name, what, faults, kUnusable);
  fmt::print("{}: {}\n  nothing in it says where the table ends: a cut could not be seen\n", name,
             what);
  return kDone;
}

/// A survey in another's format, or nothing that wellgyro reads.
int CheckForeign(const std::string& name, const std::string& what) {
  if (const auto delivery = DeliveryKind(name)) {
    const auto fault = CheckDelivery(name);
    return Tell(name, *delivery, fault ? std::vector<Fault>{*fault} : std::vector<Fault>(),
                kUnusable);
  }
  // Results that are read by people and pages alone.
  if (what.starts_with("the ") || what.find("wellgyro") != what.npos) {
    fmt::print("{}: {}\n", name, what);
    return kDone;
  }
  const Result<SurveyTable> table = ReadSurvey(name);
  if (!table) {
    fmt::print("{}: {}, not one of wellgyro's nor a survey it reads\n  {}\n", name, what,
               SentenceOf(table.fault()));
    if (table.fault().text.find(" --") != std::string::npos) {
      fmt::print("  options are those of wellgyro convert, which reads it with them\n");
    }
    return kUnusable;
  }
  const std::size_t rows = table->rows();
  const bool ends = std::none_of(
      table->head.notes.begin(), table->head.notes.end(),
      [](const std::string& note) { return note.find("where the table ends") != note.npos; });
  fmt::print("{}: {}, a survey of {} from MD {:.2f} to {:.2f} m{}\n", name, what,
             Counted(rows, "station"), rows > 0 ? table->md(0) : 0,
             rows > 0 ? table->md(rows - 1) : 0, ends ? ", whole" : "");
  for (const std::string& note : table->head.notes) fmt::print("  {}\n", note);
  return kDone;
}

int CheckFile(const std::string& name) {
  const Result<FileIdentity> identity = IdentifyFile(name);
  if (!identity) return Unusable(identity.fault());
  const std::string& what = identity->text;
  switch (identity->kind) {
    case FileKind::kJob:
      return Tell(name, what, FaultsOfJob(name), kUnusable);
    case FileKind::kSimulation:
      return Tell(name, what, FaultOf(ReadSimulation(name)), kUnusable);
    case FileKind::kNoise:
      return Tell(name, what, FaultOf(ReadNoiseFile(name)), kUnusable);
    case FileKind::kErrorModel:
      return Tell(name, what, FaultOf(ReadErrorModelFile(name)), kUnusable);
    case FileKind::kProgram:
      return Tell(name, what, FaultOf(ReadSurveyProgram(name)), kUnusable);
    case FileKind::kClearancePolicy:
      return Tell(name, what, FaultOf(ReadClearancePolicy(name)), kUnusable);
    case FileKind::kSurveyCsv:
      return CheckSurvey(name, what);
    case FileKind::kSensorCsv:
      return Tell(name, what, FaultsOfSensorTable(name), kUnusable);
    case FileKind::kLcmLog:
      return CheckLog(name);
    case FileKind::kUnknownFormat:
      fmt::print("{}: {}\n", name, what);
      return kUnusable;
    case FileKind::kEmpty:
      fmt::print("{}: {}, not one of wellgyro's\n", name, what);
      return kUnusable;
    case FileKind::kForeign:
      return CheckForeign(name, what);
    default:
      fmt::print("{}: {}\n", name, what);
      return kDone;
  }
}

std::string JobKeysPage() {
  return "# Keys of a job\n\n`wellgyro check --job-keys` prints this page. A job is TOML and "
         "begins "
         "with `format = \"wellgyro.job/1\"`; any\nother key is an error with its line, but under "
         "`[identity]`, where keys are free and go to the files as they\nare. Of `[noise]`, "
         "`KEY_sigma` or `KEY_upper95` may stand beside a coefficient.\n" +
         JobReference();
}

}  // namespace

void AddCheck(CLI::App& app, int& exit_code) {
  auto files = std::make_shared<std::vector<std::string>>();
  auto keys = std::make_shared<bool>(false);
  CLI::App* command = app.add_subcommand("check", "Says what files are and whether they are whole");
  command->add_option("files", *files, "Jobs, logs, surveys, models ...");
  command->add_flag("--job-keys", *keys, "Every key of a job, as Markdown");
  command->footer("Example:\n  wellgyro check data/demo/job.toml data/demo/run.lcm");
  command->callback([files, keys, &exit_code] {
    if (files->empty() && !*keys) throw CLI::RequiredError("files");
    if (*keys) fmt::print("{}", JobKeysPage());
    for (const std::string& name : *files) {
      const int one = CheckFile(name);
      // A file that cannot be used weighs more than one with losses.
      if (exit_code != kUnusable && one != kDone) exit_code = one;
    }
  });
}

}  // namespace wellgyro::apps

#include "recorded_survey.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "wellgyro/bus/log_parts.h"
#include "wellgyro/bus/log_reader.h"
#include "wellgyro/io/result/run_file.h"
#include "wellgyro/io/sensor/sensor_files.h"
#include "wellgyro/live/intake.h"
#include "wellgyro/live/results.h"
#include "wellgyro/survey/fault_book.h"
#include "wellgyro/survey/surveyor.h"

#include "commands.h"
#include "delivery.h"
#include "report.h"

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
  const Waiting waiting("adjusting", options.says != Says::kNothing);
  surveyor.Finish();
}

}  // namespace

int SurveyLog(const SurveyOptions& options, const JobFile& job) {
  FaultBook faults;
  Surveyor surveyor(job.job, faults);
  Intake intake(job, surveyor);
  SourceRecord source;
  const Result<std::vector<std::string>> parts =
      options.sources.size() > 1 ? InOrderOfTime(options.sources) : LogParts(options.from);
  if (!parts) return Unusable(parts.fault());
  for (const std::string& part : *parts) {
    if (!PushLog(part, options, surveyor, intake, source)) return kUnusable;
  }
  FinishSurvey(surveyor, options);
  for (const std::string& hint : HintsAtChannels(intake.feed())) Complain(hint);
  Describe(intake, source);
  return DeliverAll(options.out, job, surveyor,
                    RecordOf(ProgramName(), job, options.formats, intake, faults), source,
                    options.says, options.report);
}

int SurveyTables(const SurveyOptions& options, const JobFile& job) {
  FaultBook faults;
  Surveyor surveyor(job.job, faults);
  const std::vector<std::filesystem::path> files(options.sources.begin(), options.sources.end());
  const Result<SensorReport> report = PushSensorFiles(files, job.job, surveyor, faults);
  if (!report) return Unusable(report.fault());
  FinishSurvey(surveyor, options);
  RunRecord record;
  record.program = ProgramName();
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
  return DeliverAll(options.out, job, surveyor, record, source, options.says, options.report);
}

}  // namespace wellgyro::apps

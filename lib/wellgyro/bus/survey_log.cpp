#include "wellgyro/bus/survey_log.h"

#include <utility>

#include "wellgyro/bus/feed.h"
#include "wellgyro/bus/log_parts.h"
#include "wellgyro/bus/log_reader.h"
#include "wellgyro/survey/fault_book.h"

namespace wellgyro {

Result<LogSurvey> SurveyLog(const Job& job, const std::string& path) {
  FaultBook sink;
  Surveyor surveyor(job, sink);
  SurveyorListener listener(surveyor, sink);
  Feed feed(job.channels, listener);
  LogSurvey survey;
  const Result<std::vector<std::string>> parts = LogParts(path);
  if (!parts) return parts.fault();
  for (const std::string& part : *parts) {
    Result<LogReader> reader = LogReader::Open(part);
    if (!reader) return reader.fault();
    LogEvent event;
    while (!surveyor.finished() && reader->Next(event)) {
      feed.Take(event.channel, event.data, event.data_offset);
    }
    for (const Fault& fault : reader->Faults()) survey.faults.push_back(fault);
  }
  surveyor.Finish();
  for (const std::int32_t tool : surveyor.tools()) survey.tools[tool] = surveyor.Current(tool);
  if (survey.tools.empty()) survey.tools[0] = surveyor.Current(0);
  survey.faults.insert(survey.faults.end(), sink.faults().begin(), sink.faults().end());
  survey.tally = surveyor.tally();
  return survey;
}

}  // namespace wellgyro

#include "wellgyro/io/sensor/sensor_survey.h"

#include "wellgyro/io/sensor/sensor_files.h"
#include "wellgyro/survey/fault_book.h"

namespace wellgyro {

Result<TableSurvey> SurveyTables(const Job& job, std::span<const std::filesystem::path> files) {
  FaultBook sink;
  Surveyor surveyor(job, sink);
  const Result<SensorReport> report = PushSensorFiles(files, job, surveyor, sink);
  if (!report) return report.fault();
  surveyor.Finish();
  TableSurvey survey;
  for (const std::int32_t tool : surveyor.tools()) survey.tools[tool] = surveyor.Current(tool);
  if (survey.tools.empty()) survey.tools[0] = surveyor.Current(0);
  survey.faults = sink.faults();
  survey.tally = surveyor.tally();
  return survey;
}

}  // namespace wellgyro

#include "wellgyro/io/sensor/sensor_survey.h"

#include <cstddef>

#include "wellgyro/io/sensor/sensor_files.h"

namespace wellgyro {
namespace {

class FaultList : public Sink {
 public:
  void OnFault(const Fault& fault) override {
    constexpr std::size_t kKept = 1000;  // the first, some 0.3 MB
    if (faults.size() < kKept) faults.push_back(fault);
  }
  std::vector<Fault> faults;
};

}  // namespace

Result<TableSurvey> SurveyTables(const Job& job, std::span<const std::filesystem::path> files) {
  FaultList sink;
  Surveyor surveyor(job, sink);
  const Result<SensorReport> report = PushSensorFiles(files, job, surveyor, sink);
  if (!report) return report.fault();
  surveyor.Finish();
  TableSurvey survey;
  for (const std::int32_t tool : surveyor.tools()) survey.tools[tool] = surveyor.Current(tool);
  if (survey.tools.empty()) survey.tools[0] = surveyor.Current(0);
  survey.faults = sink.faults;
  survey.tally = surveyor.tally();
  return survey;
}

}  // namespace wellgyro

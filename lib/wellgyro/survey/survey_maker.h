#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "wellgyro/base/time.h"
#include "wellgyro/survey/crew_events.h"
#include "wellgyro/survey/intake/sample_queue.h"
#include "wellgyro/survey/job.h"
#include "wellgyro/survey/stations/draft.h"
#include "wellgyro/survey/stations/told_stations.h"
#include "wellgyro/survey/string_records.h"
#include "wellgyro/survey/survey.h"
#include "wellgyro/survey/tool_run.h"

namespace wellgyro {

/// What one tool's survey is made of, as it stands.
struct SurveyParts {
  std::span<const ToolRun> runs;
  const CrewEvents& crew;
  const ToldStations& told;
  const SampleQueue::Counts& counts;
  UtcTime newest_used;    ///< begin of the last sample that was
  bool finished = false;  ///< no more samples come
};

/// Places the stations of a tool's runs, makes the checks and gives the verdict. Changes nothing.
class SurveyMaker {
 public:
  /// All that is referred to must outlive this object.
  SurveyMaker(const Job& job, const StringRecords& string, const SurveyParts& parts)
      : job_(job), string_(string), parts_(parts) {}

  Survey Make() const;

 private:
  double DepthTooLate() const;
  std::vector<RunSummary> Summaries() const;
  std::vector<Waypoint> WayOf(const ToolRun& run) const;
  DraftedRun DraftedOf(const ToolRun& run) const;
  std::vector<DraftedRun> Drafted() const;
  std::vector<Foresight> Foresights() const;
  std::vector<Check> Checks(const std::vector<RunSummary>& summaries,
                            const std::vector<Station>& passes) const;
  std::string WithoutDepth() const;
  std::string WithoutNorth(const std::vector<DraftedRun>& drafted, const Survey& survey) const;

  const Job& job_;
  const StringRecords& string_;
  const SurveyParts& parts_;
};

}  // namespace wellgyro

#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "wellgyro/record/operations.h"
#include "wellgyro/survey/crew_events.h"
#include "wellgyro/survey/intake/sample_intake.h"
#include "wellgyro/survey/operations_due.h"
#include "wellgyro/survey/run_adjuster.h"
#include "wellgyro/survey/stations/told_stations.h"
#include "wellgyro/survey/string_records.h"
#include "wellgyro/survey/survey_maker.h"
#include "wellgyro/survey/surveyor.h"
#include "wellgyro/survey/tool_run.h"

namespace wellgyro {

/// The survey of one tool of the string: splits the samples let in into runs, has what is due
/// obeyed between them, and tells the sink of every station.
class ToolSurvey {
 public:
  /// All references must outlive this object; `adjuster` may be null.
  ToolSurvey(const Job& job, std::int32_t tool, const StringRecords& string, Sink& sink,
             const RunAdjuster* adjuster);

  /// Takes the samples at the begin of `batch` that come right behind each other, or one that has
  /// to be sorted in; what is left. Work() is to follow, with the marks up to tally().newest.
  [[nodiscard]] std::span<const ImuSample> Take(std::span<const ImuSample> batch);
  /// Works off the samples whose depth is known.
  void Work() { Work(std::nullopt); }
  void Push(const StillWindow& window);
  void Push(const ToolInfo& info);
  void Push(const Operation& operation) { operations_.Push(operation); }

  void Adjust();
  /// Works off what still waits. `until`: samples that begin later are not used.
  void Flush(std::optional<UtcTime> until);
  /// `until`: samples that begin later are not used.
  void Finish(std::optional<UtcTime> until);
  std::int32_t tool() const { return tool_; }
  bool finish_asked() const { return finish_asked_.has_value(); }
  std::optional<UtcTime> finish_asked_at() const { return finish_asked_; }

  Survey Current() const;
  SampleTally tally() const { return intake_.tally(); }
  /// Of the run that samples came for last.
  RunNow Now() const;
  /// Of the first sample of the first run; nothing before there is one.
  std::optional<UtcTime> begin() const;
  /// Depth before this instant is no longer needed.
  UtcTime Needs() const { return newest_used_; }

 private:
  void Work(std::optional<UtcTime> until);
  bool IsUniform(const AdmittedBlock& block, std::size_t at) const;
  void Use(const AdmittedBlock& block, std::size_t at, std::size_t end);
  void Feel(const AdmittedBlock& block, std::size_t at, std::size_t end, DepthMotion& motion) const;
  void TellWithoutDepth(const StillWindow& window);
  void Obey(const Operation& operation);
  void Obey(const ToolMode& mode);
  void Obey(const Event& event);
  void Obey(const Command& command);
  AlongHole DepthHeldAt(UtcTime utc) const;
  ToolRun* RunFor(std::int32_t run);
  ToolRun* FindRun(std::int32_t run);
  void Tell(ToolRun& run);

  const Job& job_;
  std::int32_t tool_;
  StringRecords string_;
  Sink& sink_;
  const RunAdjuster* adjuster_;
  SampleIntake intake_;
  OperationsDue operations_;
  CrewEvents crew_;
  ToldStations told_;
  std::vector<ToolRun> runs_;
  std::int32_t depth_segment_ = 0;
  std::optional<ToolMode> mode_;
  UtcTime newest_used_;
  std::optional<UtcTime> finish_asked_;
  bool finished_ = false;
};

}  // namespace wellgyro

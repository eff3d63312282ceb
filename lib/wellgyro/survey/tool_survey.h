#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "wellgyro/depth/cable.h"
#include "wellgyro/depth/depth_motion.h"
#include "wellgyro/depth/depth_track.h"
#include "wellgyro/record/operations.h"
#include "wellgyro/survey/assemble.h"
#include "wellgyro/survey/checks.h"
#include "wellgyro/survey/provisional.h"
#include "wellgyro/survey/run_adjuster.h"
#include "wellgyro/survey/run_book.h"
#include "wellgyro/survey/run_survey.h"
#include "wellgyro/survey/sample_intake.h"
#include "wellgyro/survey/sample_watch.h"
#include "wellgyro/survey/station_key.h"
#include "wellgyro/survey/surveyor.h"

namespace wellgyro {

/// What holds from an instant on, for the tool's stream to obey when it gets there.
using Operation = std::variant<ToolMode, Event, Command>;

/// The survey of one tool of the string: orders its samples, joins them with depth, splits them
/// into runs and tells the sink of every station.
class ToolSurvey {
 public:
  /// All references must outlive this object. `track`, `refused` and `book` are the string's;
  /// `adjuster` may be null.
  ToolSurvey(const Job& job, std::int32_t tool, const DepthTrack& track,
             const MarksRefused& refused, CableMarks& marks, RunBook& book, Sink& sink,
             const RunAdjuster* adjuster);

  /// Takes the samples at the begin of `batch` that come right behind each other, or one that has
  /// to be sorted in; what is left. Work() is to follow, with the marks up to tally().newest.
  [[nodiscard]] std::span<const ImuSample> Take(std::span<const ImuSample> batch) {
    return intake_.Take(batch);
  }
  /// Works off the samples whose depth is known.
  void Work() { Work(std::nullopt); }
  void Push(const StillWindow& window);
  void Push(const ToolInfo& info) {
    intake_.depth().SetSensorBelowReference(info.sensor_below_reference);
  }
  void Push(const Operation& operation);

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
  /// Depth before this instant is no longer needed.
  UtcTime Needs() const { return newest_used_; }

 private:
  struct RunState {
    std::unique_ptr<RunSurvey> survey;
    std::unique_ptr<ProvisionalPath> provisional;
    std::unique_ptr<SampleWatch> watch;
    std::unique_ptr<DepthMotion> motion;
    std::vector<StationState> adjusted;  ///< as of the last Adjust
    std::size_t adjusted_drafts = 0;
    std::vector<AttitudeSample> attitude;  ///< smoothed, of every knot, as of the last Adjust
  };
  struct Due {
    UtcTime utc;
    Operation operation;
  };

  void Work(std::optional<UtcTime> until);
  bool IsUniform(const AdmittedBlock& block, std::size_t at) const;
  void Use(const AdmittedBlock& block, std::size_t at, std::size_t end);
  void Feel(const AdmittedBlock& block, std::size_t at, std::size_t end, DepthMotion& motion) const;
  bool ObeyDue(const SampleStamp& stamp, UtcTime utc);
  void TellWithoutDepth(const StillWindow& window);
  bool MakeRoom(const Due& due);
  void Obey(const Operation& operation);
  void Obey(const ToolMode& mode);
  void Obey(const Event& event);
  void Obey(const Command& command);
  bool IsDue(const Due& due, const SampleStamp& stamp, UtcTime utc) const;
  AlongHole DepthHeldAt(UtcTime utc) const;
  RunState* RunFor(std::int32_t run);
  RunState* FindRun(std::int32_t run);
  void Tell(RunState& run);
  StationStatus StatusOf(const Draft& draft, bool adjusted) const;
  double DepthTooLate() const;
  std::vector<RunSummary> Summaries() const;
  std::vector<Waypoint> WayOf(const RunState& run) const;
  std::vector<DraftedRun> Drafted() const;
  std::vector<Foresight> Foresights() const;
  std::vector<Check> Checks(const std::vector<Station>& passes) const;
  void SendRevisions();
  void TellStation(const Station& station);
  void KeepToWhatWasTold(std::vector<Station>& stations) const;
  std::string WithoutDepth() const;
  std::string WithoutNorth(const std::vector<DraftedRun>& drafted, const Survey& survey) const;

  const Job& job_;
  std::int32_t tool_;
  const DepthTrack& track_;
  const MarksRefused& refused_;
  CableMarks& marks_;
  RunBook& book_;
  Sink& sink_;
  const RunAdjuster* adjuster_;
  SampleIntake intake_;
  std::vector<Due> due_;              ///< not yet obeyed, by time
  /// Obeyed: session and id. Another console may count the same numbers.
  std::set<std::pair<std::int32_t, std::int32_t>> commands_, events_;
  std::vector<RunState> runs_;
  std::int32_t depth_segment_ = 0;
  std::optional<ToolMode> mode_;
  UtcTime newest_used_;
  std::optional<UtcTime> finish_asked_;
  bool finished_ = false;
  /// As last told: of one revision a station has one position and covariance, wherever it is read.
  std::map<StationKey, Station> told_;
  std::vector<Event> verdicts_;  ///< accepts and rejects, in the order in which they came
  std::vector<Event> foresights_;
  std::vector<ReturnToZero> returns_;
};

}  // namespace wellgyro

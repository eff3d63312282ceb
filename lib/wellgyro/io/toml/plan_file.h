#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/io/text_file.h"
#include "wellgyro/plan/stop_plan.h"
#include "wellgyro/simulate/simulation.h"
#include "wellgyro/survey/job.h"

namespace wellgyro {

/// A plan with what it rests on, as a file holds it.
struct PlanReport {
  std::string well;  ///< file name
  PlanCase c;
  PlanLimits limits;
  StopPlan plan;
  std::optional<ExpectedEnd> practice = {};  ///< what is usually done, where it was told
  std::vector<PlannedStop> practice_stops = {};
  std::optional<ExpectedEnd> worse = {};  ///< the plan with the tool five times worse
  std::vector<std::string> warnings = {};
  std::vector<InputFile> inputs = {};
};

/// How much worse WorseTool() is in a report.
inline constexpr double kWorseFactor = 5;

/// As TOML, `format = "wellgyro.plan/1"`: [limits], [run], [path] as stations of MD [m],
/// inclination and true azimuth [deg], every [[stop]] with what the end would be without it,
/// [expected], [without_stops], [practice], [worse_tool], [[hidden]], [[warning]].
WELLGYRO_EXPORT std::string PlanToml(const PlanReport& report);

/// How a plan wants a run to go, and what it was made for.
struct PlanFile {
  PlanLimits limits;            ///< ellipse 0: it names none
  std::vector<WellPoint> path;  ///< of the well; empty: it names none
  PlannedWay way;
  std::vector<PlannedStop> stops;  ///< in the order of time
};

/// Reads [limits], [path], [run] and [[stop]] of such a file; the rest is passed over. Mistakes are
/// Faults with line and column: an unknown key, a stop off the way or out of order.
WELLGYRO_EXPORT Result<PlanFile> ParsePlanFile(std::string_view text, const std::string& source);
WELLGYRO_EXPORT Result<PlanFile> ReadPlanFile(const std::filesystem::path& path);

/// How the tool rolls on a move that begins `moved` seconds on the move after the begin: as
/// SyntheticRun has it, by the time on the move.
WELLGYRO_EXPORT RunRoll PlannedRoll(const PlannedWay& way, double moved);

/// The run that the plan wants, as steps of a simulation: a tool that slides swings between its
/// stops as planned.
WELLGYRO_EXPORT SimulatedRun RunOf(const PlanFile& plan);

/// What a run by this job along the plan's path is advised by: noise, errors, place and start are
/// the job's. Throws std::invalid_argument where the plan lacks a path or an ellipse.
WELLGYRO_EXPORT PlanCase CaseOf(const PlanFile& plan, const Job& job);

}  // namespace wellgyro

#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/io/atomic_file.h"
#include "wellgyro/plan/preflight.h"
#include "wellgyro/plan/stop_plan.h"

namespace wellgyro {

/// What is usually done.
struct PracticeSpec {
  double every = 300;    ///< [m]
  double seconds = 180;  ///< [s]
};

/// A well, a tool and limits, for which stops are sought.
struct PlanRequest {
  std::filesystem::path well;  ///< a survey or plan in any format of exchange.h
  std::filesystem::path tool;  ///< a job, for its noise, errors and place, or a tool file
  std::optional<std::filesystem::path> noise;  ///< of the gyros, where `tool` does not say
  std::optional<double> latitude;              ///< else the job's [rad]
  std::optional<double> convergence;           ///< given: azimuths are grid [rad]
  std::optional<double> begin_md, end_md;      ///< else the well's [m]
  PlannedWay way;                              ///< but for its depths
  PlanLimits limits;
  std::optional<PracticeSpec> practice;
  std::optional<double> sigma_start_azimuth;  ///< else as the job's alignment says [rad]
  bool third_axis = false;                    ///< the tool has one, where `tool` does not say
  PreflightHeat heat;
  std::optional<UtcTime> date;  ///< of the run, to be held against the tool's calibration
};

struct PlanAnswer {
  std::vector<OutputFile> files;              ///< plan.toml, plan.svg, plan.txt, expected.csv
  std::vector<std::filesystem::path> inputs;  ///< files that were read
  std::vector<std::string> notes;             ///< assumptions and the warnings of Preflight()
  std::string summary;                        ///< some lines, as in plan.txt
  bool feasible = false;
};

/// Faults name file and line; the caller's mistakes are std::invalid_argument.
WELLGYRO_EXPORT Result<PlanAnswer> AnswerPlan(const PlanRequest& request);

}  // namespace wellgyro

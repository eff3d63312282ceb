#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/record/run_lesson.h"
#include "wellgyro/record/tool_calibration.h"

namespace wellgyro {

/// What a result's runs found of the tool that it used.
struct RunLessons {
  std::string tool_sha256;  ///< of the tool file
  ToolCalibration tool;
  std::vector<std::string> readings;  ///< SHA-256 of each channel's accepted samples
  std::vector<RunLesson> lessons;     ///< of every run that passed or warned
};

/// From a run.toml (`wellgyro.run/1`), which holds its tool file. A Fault where it has none, or
/// where no run of it can teach anything: failed, not solved, or with an azimuth in doubt.
WELLGYRO_EXPORT Result<RunLessons> ParseRunLessons(std::string_view text,
                                                   const std::string& source);

}  // namespace wellgyro

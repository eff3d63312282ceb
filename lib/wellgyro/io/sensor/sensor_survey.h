#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/survey/survey.h"
#include "wellgyro/survey/surveyor.h"

/// @file
/// Tables of sensor data to surveys.
namespace wellgyro {

/// What tables of sensor data came to.
struct TableSurvey {
  std::map<std::int32_t, Survey> tools;  ///< by number of the tool in the string
  std::vector<Fault> faults;             ///< of the files and of their rows, the first 1000
  SampleTally tally;
};

/// Surveys tables of samples, of averages at rest and of depth, in any order: what the program's
/// `survey` does of them, without its files. A Fault where a file or a row cannot be used at all.
/// Throws std::invalid_argument as Surveyor does.
WELLGYRO_EXPORT Result<TableSurvey> SurveyTables(const Job& job,
                                                 std::span<const std::filesystem::path> files);

}  // namespace wellgyro

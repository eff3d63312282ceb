#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/survey/survey.h"
#include "wellgyro/survey/surveyor.h"

namespace wellgyro {

/// What a log came to.
struct LogSurvey {
  std::map<std::int32_t, Survey> tools;  ///< by number of the tool in the string
  std::vector<Fault> faults;             ///< of the log and of its messages, the first 1000
  SampleTally tally;
};

/// Surveys the LCM log at `path`, with the parts behind it where it was rotated (log_parts.h), or a
/// pipe, or "-" for standard input: what the program's `survey` does, without its files. `adjuster`
/// as for Surveyor. A Fault where the log cannot be read at all; damage inside it is told in
/// `faults`. Throws std::invalid_argument as Surveyor does.
WELLGYRO_EXPORT Result<LogSurvey> SurveyLog(const Job& job, const std::string& path,
                                            const RunAdjuster* adjuster = nullptr);

}  // namespace wellgyro

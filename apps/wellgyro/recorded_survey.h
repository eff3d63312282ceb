#pragma once

#include "wellgyro/io/toml/job_file.h"

#include "live_survey.h"

namespace wellgyro::apps {

/// survey --from LOG or tables, in the order in which options.sources has them: all of them through
/// one surveyor, then its files into options.out. Gives the exit code.
int SurveyLog(const SurveyOptions& options, const JobFile& job);
int SurveyTables(const SurveyOptions& options, const JobFile& job);

}  // namespace wellgyro::apps

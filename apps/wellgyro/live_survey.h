#pragma once

#include <string>
#include <vector>

#include "wellgyro/io/exchange/exchange.h"
#include "wellgyro/io/toml/job_file.h"

#include "delivery.h"
#include "survey_page.h"

namespace wellgyro::apps {

struct SurveyOptions {
  std::string job, from, out;
  std::vector<std::string> sources;  ///< every --from; the first is `from`
  std::string advise;                ///< plan by which the run is advised
  std::string record;                ///< log that gets what is heard live
  bool resume = false;
  std::vector<std::string> fill;  ///< other recorders' logs
  SurveyPageOptions page;         ///< none where it has no address
  std::vector<SurveyFormat> formats;
  Says says = Says::kSummary;
  bool report = false;  ///< report.html too
};

/// Surveys a live stream until FINISH, a signal or the loss of the bus; the exit code.
int SurveyLive(const SurveyOptions& options, const JobFile& job);

}  // namespace wellgyro::apps

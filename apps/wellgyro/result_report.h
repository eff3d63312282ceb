#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "wellgyro/page/report_page.h"

namespace wellgyro::apps {

struct ResultReport {
  std::filesystem::path result;  ///< folder of one tool's survey files
  std::filesystem::path out;     ///< page; empty: none
  std::filesystem::path pdf;     ///< the same printed; empty: none
  std::filesystem::path json;    ///< survey.json; empty: none
  std::vector<std::string> others;
  std::filesystem::path plan;  ///< of the stops; empty: none
  ReportOptions options;
  bool say = true;  ///< what was written
};

/// Writes what is asked for; the exit code.
int WriteReport(const ResultReport& report);

/// After a survey: survey.json, and with `page` report.html, into each folder of results in `out`.
/// Silently, as the last line of a survey is its verdict. The exit code.
int ReportOnSurvey(const std::filesystem::path& out, bool page);

}  // namespace wellgyro::apps

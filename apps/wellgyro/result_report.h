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

/// After a survey: survey.json, and with `page` report.html, into the folder of one tool's result;
/// adds the names of what it wrote. The exit code.
int ReportInto(const std::filesystem::path& folder, bool page, std::vector<std::string>& written);

}  // namespace wellgyro::apps

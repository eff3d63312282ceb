#pragma once

#include <string>
#include <string_view>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"

namespace wellgyro {

/// How a report is shown.
struct ReportOptions {
  enum class Units { kMetric, kField };
  enum class Paper { kA4, kLetter };
  Units units = Units::kMetric;  ///< kField: feet and deg/100ft; map coordinates stay in metres
  Paper paper = Paper::kA4;      ///< of the print
};

/// The report of a survey as one self-contained HTML page, from its survey.json.
///
/// Nothing is asked of a network, and the page's own policy forbids it. Tables and pictures stand
/// in the page itself; where scripts run, D3 (in the page, with its licence) draws the pictures
/// again so that they can be zoomed and read. What the document does not hold is said to be not
/// measured. Texts of the document are shown as text, whatever they hold. The same document gives
/// the same bytes. Fault kSyntax or kForeign where `survey_json` is no `wellgyro.survey/1`.
WELLGYRO_EXPORT Result<std::string> ReportPage(std::string_view survey_json,
                                               const ReportOptions& options = {});

}  // namespace wellgyro

#pragma once

#include <string>

#include "wellgyro/base/export.h"
#include "wellgyro/record/verdict.h"
#include "wellgyro/survey/survey.h"

namespace wellgyro {

/// One line: "verdict fail: " and the causes, separated by "; ".
WELLGYRO_EXPORT std::string VerdictText(const RunVerdict& verdict);

/// A few lines for people: the end of the survey, its 95 % ellipse in the horizontal plane (half
/// axes 2.4477 sigma) and 95 % interval of depth (1.96 sigma), how many stations, and the checks
/// that did not pass. Every number with its unit; ends with a newline.
WELLGYRO_EXPORT std::string SummaryText(const Survey& survey);

}  // namespace wellgyro

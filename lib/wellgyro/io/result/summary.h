#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/record/check.h"
#include "wellgyro/survey/survey.h"

namespace wellgyro {

/// One line: "verdict fail: " and the causes, separated by "; ".
WELLGYRO_EXPORT std::string VerdictText(const RunVerdict& verdict);

/// A few lines for people: the end of the survey, its 95 % ellipse in the horizontal plane (half
/// axes 2.4477 sigma) and 95 % interval of depth (1.96 sigma), how many stations, and the checks
/// that did not pass. Every number with its unit; ends with a newline.
WELLGYRO_EXPORT std::string SummaryText(const Survey& survey);

/// One tool's survey and its files, for SummaryJson.
struct ToolSummary {
  std::int32_t tool = 0;
  std::filesystem::path folder;
  std::vector<std::string> files;  ///< written into `folder`
  const Survey* survey = nullptr;
};

/// The same for programs, `wellgyro.summary/1`: verdict, causes, the exit code, and of every tool
/// its files, counts of stations, the end with its 95 % ellipse, what a fault that passed unnoticed
/// may do to it, and the checks that did not pass. Units stand in the names; what is not known is
/// null; ends with a newline.
WELLGYRO_EXPORT std::string SummaryJson(std::span<const ToolSummary> tools,
                                        const RunVerdict& verdict, int exit_code);

}  // namespace wellgyro

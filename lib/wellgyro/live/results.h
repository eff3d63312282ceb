#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/io/exchange/exchange.h"
#include "wellgyro/io/result/run_file.h"
#include "wellgyro/io/toml/job_file.h"
#include "wellgyro/live/intake.h"
#include "wellgyro/live/session.h"
#include "wellgyro/record/check.h"
#include "wellgyro/survey/surveyor.h"

namespace wellgyro {

/// Never empty: where no tool has been heard of, tool 0 says so.
WELLGYRO_EXPORT std::vector<ToolResult> ResultsOf(const Surveyor& surveyor,
                                                  const std::filesystem::path& folder);

/// What is written about a survey besides the survey; `program`: name and version of who writes it.
WELLGYRO_EXPORT RunRecord RecordOf(const std::string& program, const JobFile& job,
                                   const std::vector<SurveyFormat>& formats, const Intake& intake,
                                   const FaultBook& surveyor_faults);

/// A Fault when `folder`, or the folder of a tool in it, holds a survey that someone accepted.
WELLGYRO_EXPORT std::optional<Fault> AcceptedIn(const std::filesystem::path& folder);

/// Removes the files that one tool's result had in `folder` itself, where several now have folders
/// of their own there.
WELLGYRO_EXPORT void RemoveFormer(const std::filesystem::path& folder,
                                  const std::vector<ToolResult>& results);

/// Something of the stream was lost, damaged or beyond what the tool can measure.
WELLGYRO_EXPORT bool HasLosses(const SourceRecord& source, const Survey& survey);

WELLGYRO_EXPORT bool AnyUsable(const std::vector<ToolResult>& results);
/// Of the tools that have a survey.
WELLGYRO_EXPORT RunVerdict WorstVerdict(const std::vector<ToolResult>& results);

}  // namespace wellgyro

#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "wellgyro/io/atomic_file.h"
#include "wellgyro/io/exchange/exchange.h"
#include "wellgyro/io/result/run_file.h"
#include "wellgyro/io/toml/job_file.h"
#include "wellgyro/survey/surveyor.h"

#include "intake.h"

namespace wellgyro::apps {

/// The job's estimator is the one that fit/ adjusts for.
inline bool InAngles(const Job& job) {
  return job.attitude.estimator == AttitudeSpec::Estimator::kAngles;
}
/// What adjusts its runs, as run.toml says it.
inline const char* AdjusterOf(const Job& job) {
  return InAngles(job) ? "least squares in angles" : "least squares of rotations";
}

/// Says so and gives false when `folder` holds a survey that someone accepted.
bool MayWriteTo(const std::filesystem::path& folder);

/// What is written about a survey besides the survey.
RunRecord RecordOf(const JobFile& job, const std::vector<SurveyFormat>& formats,
                   const Intake& intake, const FaultBook& surveyor_faults);

/// One tool's survey, and the folder that its files go to: the one given where a single tool has a
/// survey, tool-N in it for several. A tool without a survey, which may be no more than a damaged
/// number in a message, takes no folder of its own.
struct ToolResult {
  std::int32_t tool = 0;
  std::filesystem::path folder;
  Survey survey;
};
/// Never empty: where no tool has been heard of, tool 0 says so.
std::vector<ToolResult> ResultsOf(const Surveyor& surveyor, const std::filesystem::path& folder);

/// Removes the files that one tool's result had in `folder` itself, where several now have folders
/// of their own there.
void RemoveFormer(const std::filesystem::path& folder, const std::vector<ToolResult>& results);

/// Writes every tool's result, prints its summary, and gives the exit code.
int DeliverAll(const std::filesystem::path& folder, const JobFile& job, const Surveyor& surveyor,
               const RunRecord& record, const SourceRecord& source);

}  // namespace wellgyro::apps

#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "wellgyro/io/result/run_file.h"
#include "wellgyro/io/toml/job_file.h"
#include "wellgyro/live/results.h"
#include "wellgyro/live/session.h"
#include "wellgyro/survey/surveyor.h"

namespace wellgyro::apps {

/// The job's estimator is the one that fit/ adjusts for.
inline bool InAngles(const Job& job) {
  return job.attitude.estimator == AttitudeSpec::Estimator::kAngles;
}

/// Who wrote a result, and what adjusted its runs, in run.toml.
Maker MakerOf(const Job& job);

/// Says so and gives false when `folder` holds a survey that someone accepted.
bool MayWriteTo(const std::filesystem::path& folder);

/// Writes every tool's result, prints its summary, and gives the exit code.
int DeliverAll(const std::filesystem::path& folder, const JobFile& job, const Surveyor& surveyor,
               const RunRecord& record, const SourceRecord& source);

/// Of a live survey whose files are written: prints their summary and gives the exit code.
int Summarise(const JobFile& job, const LiveOutcome& outcome);

/// Prints the verdict as the last line; the exit code.
int Conclude(const RunVerdict& verdict, bool losses);

}  // namespace wellgyro::apps

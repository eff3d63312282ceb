#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "wellgyro/io/result/run_file.h"
#include "wellgyro/io/result/summary.h"
#include "wellgyro/io/toml/job_file.h"
#include "wellgyro/live/results.h"
#include "wellgyro/live/session.h"
#include "wellgyro/survey/surveyor.h"

namespace wellgyro::apps {

/// What a survey says of itself on standard output.
enum class Says { kSummary, kNothing, kJson };

/// Name and version of this program, in run.toml.
std::string ProgramName();

/// Says so and gives false when `folder` holds a survey that someone accepted.
bool MayWriteTo(const std::filesystem::path& folder);

/// Writes every tool's result and survey.json, with `page` report.html too, prints its summary, and
/// gives the exit code.
int DeliverAll(const std::filesystem::path& folder, const JobFile& job, const Surveyor& surveyor,
               const RunRecord& record, const SourceRecord& source, Says says, bool page);

/// The same of a live survey whose results are written.
int Summarise(const JobFile& job, const LiveOutcome& outcome, Says says, bool page);

/// Prints the verdict as the last line, or with what is known of `tools` as a document; the exit
/// code.
int Conclude(const RunVerdict& verdict, bool losses, Says says,
             std::span<const ToolSummary> tools = {});

}  // namespace wellgyro::apps

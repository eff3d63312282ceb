#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/io/text_file.h"
#include "wellgyro/record/operations.h"
#include "wellgyro/survey/job.h"

/// @file
/// A job from its TOML file.
namespace wellgyro {

/// A job and the files it was read from.
struct JobFile {
  Job job;
  std::vector<InputFile> files;  ///< the job itself first
  OperationSpec operations;      ///< whose orders are obeyed
};

/// Reads a job, `format = "wellgyro.job/1"`, and the files it names, relative to its own folder.
///
/// Every key carries its unit; an unknown key, a value of the wrong type or out of range and keys
/// that contradict each other are Faults with line and column. What only the run can tell, as a
/// tie-in above the run, is left to the Surveyor.
WELLGYRO_EXPORT Result<JobFile> ReadJob(const std::filesystem::path& path);

/// The same of text that came from elsewhere; `source` names it in Faults, and files it names are
/// relative to `folder`.
WELLGYRO_EXPORT Result<JobFile> ParseJob(std::string_view text, const std::filesystem::path& source,
                                         const std::filesystem::path& folder);

}  // namespace wellgyro

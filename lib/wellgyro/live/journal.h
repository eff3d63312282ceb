#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/io/toml/job_file.h"

namespace wellgyro {

/// What a live survey needs besides its log to be continued: journal.toml in its --out.
struct Journal {
  std::string inputs;         ///< SHA-256 of the job and of each file that it names
  std::string log;            ///< absolute
  std::int64_t begun_us = 0;  ///< when the survey began to listen, since 1970; 0: not known
};

/// Of a job's files as they were read. `log` is made absolute, so that a session may be resumed
/// from another folder.
Journal JournalOf(const JobFile& job, const std::string& log, std::int64_t begun_us);

/// Whether a survey that was cut off can be continued in this folder.
bool HasJournal(const std::filesystem::path& folder);
/// Whole or not at all; before the first message is recorded.
std::optional<Fault> WriteJournal(const std::filesystem::path& folder, const Journal& journal);

/// The journal in `folder`; `now` itself where there is none, because the survey was cut off before
/// it had written one. A Fault when the survey was of another job, has another log, or the journal
/// is damaged.
Result<Journal> ReadJournal(const std::filesystem::path& folder, const Journal& now);

/// Removes what a killed program was about to put in place.
void RemovePartials(const std::filesystem::path& folder);

}  // namespace wellgyro

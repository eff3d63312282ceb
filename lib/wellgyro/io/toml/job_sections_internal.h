#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "wellgyro/io/toml/toml_internal.h"
#include "wellgyro/record/operations.h"
#include "wellgyro/survey/job.h"

/// The sections of a job file, one function each; every one reads all keys of its table. Numbers
/// are as survey/job_keys.h says; sections of numbers alone have no function here.
namespace wellgyro {

// Each reads one table of a job. Keys are those of survey/job_keys.h with their units and ranges;
// what cannot be used is thrown as a TomlError with line and column, and a key that is absent
// leaves the member as it was.

/// [well]: place, datum and depths.
void ReadWell(TomlTable table, Job& job);
/// [grid]: projection, convergence and scale, the operator's before computed ones.
void ReadGrid(TomlTable table, Job& job);
/// [tie_in]: the first row of the survey.
void ReadTieIn(TomlTable table, Job& job);
/// [channels]: names in place of the WELLGYRO_ ones.
Channels ReadChannels(TomlTable table);
/// [alignment]: gyrocompass or an external azimuth, and what counts as still.
void ReadAlignment(TomlTable table, Job& job);
/// [attitude]: order of the integration within a sample.
AttitudeSpec ReadAttitude(TomlTable table);
/// [stations]: which depths and stops are listed.
void ReadStations(TomlTable table, Job& job);
/// [depth]: latency, kind of depth, cable and marks.
void ReadDepth(TomlTable table, Job& job);
/// [magnetic]: declination, and whether a stop's magnetic azimuth ties the run.
void ReadMagnetic(TomlTable table, Job& job);
/// [operations] and each [[operator]].
OperationSpec ReadOperations(TomlTable& root);
/// One [[run]], behind those before it.
void ReadRun(TomlTable table, std::vector<RunSpec>& runs);
/// One [[event]], as it would have come by message.
Event ReadEvent(TomlTable table);

/// Every key that reading the job `text` asks for, there or not, after its table, until the first
/// complaint.
std::set<std::string> KeysAskedOfJob(std::string_view text, const std::filesystem::path& folder);

}  // namespace wellgyro

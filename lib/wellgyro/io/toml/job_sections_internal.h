#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <string_view>

#include "wellgyro/io/toml/toml_internal.h"
#include "wellgyro/record/signed_operation.h"
#include "wellgyro/survey/job.h"

/// The sections of a job file, one function each; every one reads all keys of its table. Numbers
/// are as survey/job_keys.h says; sections of numbers alone have no function here.
namespace wellgyro {

void ReadWell(TomlTable table, Job& job);
void ReadGrid(TomlTable table, Job& job);
void ReadTieIn(TomlTable table, Job& job);
Channels ReadChannels(TomlTable table);
void ReadAlignment(TomlTable table, Job& job);
AttitudeSpec ReadAttitude(TomlTable table);
void ReadStations(TomlTable table, Job& job);
void ReadDepth(TomlTable table, Job& job);
void ReadMagnetic(TomlTable table, Job& job);
/// [operations] and each [[operator]].
OperationSpec ReadOperations(TomlTable& root);
RunSpec ReadRun(TomlTable table);
Event ReadEvent(TomlTable table);

/// Every key that reading the job `text` asks for, there or not, after its table, until the first
/// complaint.
std::set<std::string> KeysAskedOfJob(std::string_view text, const std::filesystem::path& folder);

}  // namespace wellgyro

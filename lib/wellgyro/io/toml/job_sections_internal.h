#pragma once

#include "wellgyro/io/toml/toml_internal.h"
#include "wellgyro/record/signed_operation.h"
#include "wellgyro/survey/job.h"

/// The sections of a job file, one function each; every one reads all keys of its table.
namespace wellgyro {

Job::Well ReadWell(TomlTable table);
GridSpec ReadGrid(TomlTable table);
TieIn ReadTieIn(TomlTable table);
Channels ReadChannels(TomlTable table);
AlignmentSpec ReadAlignment(TomlTable table);
AttitudeSpec ReadAttitude(TomlTable table);
StationSpec ReadStations(TomlTable table);
DepthSpec ReadDepth(TomlTable table);
StringSpec ReadString(TomlTable table);
MagneticSpec ReadMagnetic(TomlTable table);
Acceptance ReadAcceptance(TomlTable table);
/// [operations] and each [[operator]].
OperationSpec ReadOperations(TomlTable& root);
RunSpec ReadRun(TomlTable table);
Event ReadEvent(TomlTable table);

}  // namespace wellgyro

#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"

namespace wellgyro {

enum class FileKind {
  kEmpty,
  kJob,
  kSimulation,
  kNoise,
  kCalibration,
  kTool,
  kErrorModel,
  kProgram,
  kUncertainty,  ///< uncertainty.toml
  kRun,          ///< run.toml
  kSource,       ///< source.toml
  kClearancePolicy,
  kLcmLog,
  kSurveyCsv,
  kPassesCsv,
  kChecksCsv,
  kTruthCsv,
  kSensorCsv,  ///< sensor_csv.h
  kForeign,
  kUnknownFormat,  ///< TOML of a format that this version does not know, or that names none
};

/// What a file is, by its first bytes.
struct FileIdentity {
  FileKind kind = FileKind::kForeign;
  std::string text;  ///< to follow "this is": "a wellgyro job", "an empty file", "a PDF document"
};

/// TOML files of ours are told by their format line, logs by LCM's sync word, which may come late
/// where a log is damaged, tables by their header. 64 KiB are enough.
WELLGYRO_EXPORT FileIdentity IdentifyBytes(std::string_view head);

/// The same of the file at `path`. Fault kIo when it cannot be read.
WELLGYRO_EXPORT Result<FileIdentity> IdentifyFile(const std::filesystem::path& path);

}  // namespace wellgyro

#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/record/tool_calibration.h"

namespace wellgyro {

/// A tool model from TOML, `wellgyro.tool/1`; the file that ToolToml writes explains its keys and
/// formula. A Fault names file, line and key; a model that comes back has no FindComplaint.
WELLGYRO_EXPORT Result<ToolCalibration> ParseTool(std::string_view text, const std::string& source);

/// The same from the file at `path`.
WELLGYRO_EXPORT Result<ToolCalibration> ReadToolFile(const std::filesystem::path& path);

/// `tool` as TOML, its formula in comments. Throws std::invalid_argument with FindComplaint's
/// sentence when it cannot be used. Reading it back gives the same model, but for the last bit of
/// what is converted to the units of files.
WELLGYRO_EXPORT std::string ToolToml(const ToolCalibration& tool);

}  // namespace wellgyro

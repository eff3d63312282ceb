#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/base/time.h"
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

/// R_TS of three words as "+y", "-x", "+z": x, y and z of the tool along these axes of the sensors.
/// Nothing for other words, or axes that are not at right angles.
WELLGYRO_EXPORT std::optional<Eigen::Matrix3d> AxesOf(const std::vector<std::string>& words);

/// "2026-01-31" as its first moment; nothing for any other text.
WELLGYRO_EXPORT std::optional<UtcTime> DateOf(std::string_view text);

}  // namespace wellgyro

#pragma once

#include <span>
#include <string>
#include <vector>

#include "wellgyro/io/toml/toml_internal.h"
#include "wellgyro/io/toml/toml_writer_internal.h"
#include "wellgyro/record/noise.h"
#include "wellgyro/record/tool_calibration.h"

namespace wellgyro {

/// Noise coefficients under the names and units of noise files: quantization_arcsec,
/// angle_random_walk_deg_per_sqrt_h, ... Absent ones are zero. `<key>_sigma` and `<key>_upper95`
/// may stand beside them and are checked, not kept.
NoiseCoefficients ReadCoefficients(TomlTable& table);

/// Priors under the names of `[errors]`; absent ones are zero.
ErrorPriors ReadPriors(TomlTable& table);
/// Those of them that are zero because the table says so.
std::vector<std::string> PriorsOfNone(const TomlTable& table, const ErrorPriors& priors);
/// Those of them that are not zero, or are among `none`.
void WritePriors(TomlWriter& out, const ErrorPriors& priors, std::span<const std::string> none);

/// The priors of a job, key by key: the job's own, else the tool's, else what
/// survey/unstated_errors.h has. `table`: its [errors]; may be null.
ErrorPriors PriorsOfJob(TomlTable* table, const ToolCalibration* tool);

}  // namespace wellgyro

#pragma once

#include "wellgyro/io/toml/toml_internal.h"
#include "wellgyro/io/toml/toml_writer_internal.h"
#include "wellgyro/record/noise.h"

namespace wellgyro {

/// Noise coefficients under the names and units of noise files: quantization_arcsec,
/// angle_random_walk_deg_per_sqrt_h, ... Absent ones are zero. `<key>_sigma` and `<key>_upper95`
/// may stand beside them and are checked, not kept.
NoiseCoefficients ReadCoefficients(TomlTable& table);

/// Priors under the names of `[errors]`.
ErrorPriors ReadPriors(TomlTable& table);
/// Those of them that are not zero.
void WritePriors(TomlWriter& out, const ErrorPriors& priors);

}  // namespace wellgyro

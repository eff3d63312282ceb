#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/noise/noise_fit.h"
#include "wellgyro/record/noise.h"

namespace wellgyro {

/// What a noise file says of the log it rests on.
struct NoiseFileHead {
  bool accelerometer = false;  ///< coefficients in m/s^2 and their like, under other names
  std::string source;          ///< the log's file name
  std::string channel;
  double period = 0;  ///< [s]
  std::int64_t samples = 0;
  std::int64_t missing = 0;
  std::vector<std::string> cleaned;  ///< what was left out or taken off beforehand, in words
};

/// A noise file, `format = "wellgyro.noise/1"`: under [coefficients] each observable coefficient
/// with its `<key>_sigma`, of each other its `<key>_upper95` alone; a fitted sinusoid under
/// [sinusoid]; the log and the fit under [log] and [fit].
WELLGYRO_EXPORT std::string NoiseFileText(const NoiseFit& fit, const NoiseFileHead& head);

/// Reads the coefficients of a gyro's noise file; those that are not observable are zero. An
/// unknown key, a value out of range or an accelerometer's file is a Fault with line and column.
WELLGYRO_EXPORT Result<NoiseCoefficients> ReadNoiseFile(const std::filesystem::path& path);
WELLGYRO_EXPORT Result<NoiseCoefficients> ParseNoiseFile(std::string_view text,
                                                         const std::string& source);

}  // namespace wellgyro

#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/record/channels.h"

namespace wellgyro {

/// What was written.
struct LogTables {
  std::int64_t samples = 0, marks = 0;
  std::int64_t left_out = 0;  ///< samples of tools or sensors unlike the first, messages refused
};

/// The samples in SI units of the LCM log at `log`, and its depths, as tables that sensor_csv.h
/// reads, each written beside its name first and then put in place; one without rows is not
/// written. Numbers come back to the last bit. What no column holds is left out: flags of
/// saturation, speed, and where the depths came from. Faults: kIo; kForeign where `log` is no log
/// or holds no sample in SI units.
WELLGYRO_EXPORT Result<LogTables> WriteLogTables(const std::string& log, const Channels& channels,
                                                 const std::filesystem::path& samples,
                                                 const std::filesystem::path& depths);

}  // namespace wellgyro

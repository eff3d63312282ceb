#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/record/channels.h"

namespace wellgyro {

/// What was handed over.
struct LogTables {
  std::int64_t samples = 0, marks = 0;
  std::int64_t left_out = 0;  ///< samples of tools or sensors unlike the first, messages refused
  std::vector<Fault> damage;  ///< of the log: one Fault for each gap, one for an end that is cut
};

/// Takes whole lines of a table, in their order; gives a Fault where it cannot.
using TextSink = std::function<std::optional<Fault>(std::string_view lines)>;

/// The samples in SI units of the LCM log at `log` and its parts, see LogParts(), and the depths,
/// as tables that sensor_csv.h reads, in pieces of some megabyte; nothing of one without rows.
/// Numbers come back to the last bit. What no column holds is left out: flags of saturation, speed,
/// and where the depths came from. Faults: kIo; kForeign where `log` is no log or holds no sample
/// in SI units; the sinks' own.
WELLGYRO_EXPORT Result<LogTables> WriteLogTables(const std::string& log, const Channels& channels,
                                                 const TextSink& samples, const TextSink& depths);

}  // namespace wellgyro

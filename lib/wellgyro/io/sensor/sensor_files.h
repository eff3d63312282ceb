#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/depth/stop_match.h"
#include "wellgyro/io/text_file.h"
#include "wellgyro/survey/surveyor.h"

namespace wellgyro {

/// What became of files of sensor data.
struct SensorReport {
  std::vector<InputFile> files;
  /// The tool's clock joined with the rig's by stops and starts, where samples came beside depth.
  std::optional<StopMatch> clock;
  /// What the samples' own UTC differs by from that [s]; absent where they have none.
  std::optional<double> stamps_less_stops;
  std::int64_t samples = 0, windows = 0, marks = 0;
};

/// The other door beside a log: tables of samples, of averages at rest and of depth (sensor_csv.h),
/// and the G7 records of IOGP P7/17 files (gyro_raw.h), into a Surveyor, in the order of time; does
/// not Finish it.
///
/// Samples of a memory or drop tool, which have the tool's time alone, get UTC from its stops
/// against those of the depth or tally table (stop_match.h), and from what the accelerometers feel
/// of starts and stops. Where they have both, stops more than three sigmas from the stamps are told
/// to `faults` (kConflict). Depths on the tool's own clock
/// get UTC from the samples' pairs of both clocks; where nothing has UTC, the tool's time stands
/// for it. Faults: a file or row that cannot be used, two tables of samples, samples without UTC
/// that cannot be joined, depths on a clock that the samples lack.
WELLGYRO_EXPORT Result<SensorReport> PushSensorFiles(
    std::span<const std::filesystem::path> files, const Job& job, Surveyor& surveyor, Sink& faults,
    const std::function<void(double)>& progress = {});

/// True where the file's first lines are those of such a table, be it without columns that it
/// needs, or of an IOGP file.
WELLGYRO_EXPORT bool IsSensorTable(const std::filesystem::path& path);

}  // namespace wellgyro

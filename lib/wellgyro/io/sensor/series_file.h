#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/noise/sample_series.h"

namespace wellgyro {

/// How the samples of one channel lie in a file. Binary numbers are little-endian, one after the
/// other, nothing between.
enum class SeriesType { kF64, kI16, kI32, kCsv, kLcm };

/// From f64, i16, i32, csv, lcm; nothing for any other word.
WELLGYRO_EXPORT std::optional<SeriesType> SeriesTypeOf(std::string_view word);
/// By the file's ending: .f64 .i16 .i32 .csv .txt .lcm, else by its first bytes where they say it.
/// A Fault that asks for the type when neither does, or when it cannot be read.
WELLGYRO_EXPORT Result<SeriesType> SeriesTypeOfFile(const std::filesystem::path& path);

/// Columns of a CSV file, by the name in its header or the number from 1.
struct SeriesColumns {
  std::string value;        ///< empty: the only one, or the only one not named below
  std::string sequence;     ///< numbers of the samples: those left out are missing
  std::string temperature;  ///< [degC]
  /// Time of each sample, which gives the period and what is missing: heading with [s], [ms], [us]
  /// or [ns], or so ending (t_ms), else seconds. Empty: column TOOL or UTC, where the header has
  /// one with a unit.
  std::string time;
};

/// Reads binary samples. Faults: kIo, kSize for a size that does not go into whole samples,
/// kForeign for text or numbers that cannot be float64 readings.
WELLGYRO_EXPORT Result<SampleSeries> ReadBinarySeries(
    const std::filesystem::path& path, SeriesType type,
    const std::function<void(double)>& progress = {});

/// Reads a column of numbers. Separated by comma, semicolon, tab or blanks; one header line or
/// none; lines with # and empty lines are left out. An empty field, "nan" or "inf" is a sample that
/// is missing; so is an empty line between samples that are the only column. Any other text is a
/// Fault with line and column; so is a sequence that goes back. A unit in the heading, as tables of
/// sensor data have it (GX[deg/h], GX(deg/h), gx_deg_per_h), is the series'.
WELLGYRO_EXPORT Result<SampleSeries> ReadCsvSeries(
    const std::filesystem::path& path, const SeriesColumns& columns,
    const std::function<void(double)>& progress = {});

}  // namespace wellgyro

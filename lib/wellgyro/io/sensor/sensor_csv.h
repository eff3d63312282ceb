#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>
#include <variant>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/record/depth.h"
#include "wellgyro/record/sample.h"

namespace wellgyro {

/// What a table of sensor data holds.
enum class SensorTable {
  kSamples,  ///< a time, AX AY AZ, GX GY
  kStill,    ///< averages at rest: the same with DURATION
  kDepth,    ///< a time and MD, or LENGTH of the pipe run since the row before
};

/// By the header line; nothing where it is no such table. Columns are NAME[unit] in any order,
/// separated by commas:
///   UTC[us] UTC[s] END_UTC[us] END_UTC[s]   since 1970; of samples and averages the begin
///   TOOL[ns] TOOL[us] TOOL[ms] TOOL[s]      the tool's own clock
///   GX GY GZ [rad/s] [deg/s] [deg/h]   AX AY AZ [m/s2] [g] [mg]   MX MY MZ [T] [nT]
///   SIG_GX ... SIG_AX ...   of averages, same units      TEMP[degC]   DURATION[s]
///   MD[m] MD[ft]   LENGTH[m] LENGTH[ft]   SIG_MD[m] SIG_MD[ft]   TENSION[N] TENSION[kN]
///   TENSION[lbf]   STOPPED MARK CORRECTED (0 or 1)   INDEX RUN TOOL_NUMBER (whole numbers)
/// A depth row with END_UTC is a time at rest at that depth, as in a stand or tally table.
WELLGYRO_EXPORT std::optional<SensorTable> SensorTableOf(std::string_view header);

/// Rows that say to the letter what the row before them says: copies, which are left out.
struct RepeatedRows {
  std::int64_t count = 0;
  int first_line = 0;  ///< where the first of them stands
};

/// Reads such a table row by row, in constant memory.
///
/// Samples must come evenly: their period is the median of the first thousand steps, a longer step
/// is a gap; rows with an empty field are samples that are missing. Time does not go back.
class WELLGYRO_EXPORT SensorCsv {
 public:
  using Row = std::variant<ImuSample, StillWindow, DepthMark>;

  /// Faults: kIo, kForeign when the header is none, kSyntax for a column that is not known or
  /// twice.
  static Result<SensorCsv> Open(const std::filesystem::path& path);
  ~SensorCsv();
  SensorCsv(SensorCsv&&) noexcept;
  SensorCsv& operator=(SensorCsv&&) noexcept;

  SensorTable kind() const;
  bool has_utc() const;   ///< else rows have the tool's time alone, and utc = tool time
  bool has_tool() const;  ///< samples have a tool time of their own; else it is counted from UTC

  /// The next record; nothing at the end and where a row cannot be used, which fault() tells. A
  /// depth row at rest gives a mark every four seconds.
  bool Next(Row& row);
  const std::optional<Fault>& fault() const;
  RepeatedRows repeated() const;  ///< so far

 private:
  struct Impl;
  explicit SensorCsv(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace wellgyro

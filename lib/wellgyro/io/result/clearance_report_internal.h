#pragma once

#include <optional>
#include <string>
#include <vector>

#include "wellgyro/io/plot/clearance_plot.h"
#include "wellgyro/io/toml/clearance_file.h"
#include "wellgyro/survey/wells/separation.h"

namespace wellgyro {

/// One offset well as it was found.
struct OffsetResult {
  std::string name;
  bool screened_out = false;     ///< it cannot come below the policy's `report`
  std::vector<Separation> rows;  ///< empty when screened out
  std::optional<Separation> lowest;
  bool cut_short = false;  ///< a model ends before its survey: what is below is not judged
};

/// Those that were not screened out, the lowest factor first.
std::vector<ClearanceSeries> SeriesOf(const std::vector<OffsetResult>& offsets);

/// clearance.csv: every row of every well that was not screened out, columns with their units.
std::string ClearanceCsv(const std::vector<OffsetResult>& offsets);
/// wells.csv: one row a well, its lowest factor and verdict.
std::string WellsCsv(const std::vector<OffsetResult>& offsets, const ClearancePolicy& policy);
/// The report as one self-contained page; `ladder` and `cylinder` are its pictures in SVG.
std::string ClearanceHtml(const std::string& reference, const std::vector<OffsetResult>& offsets,
                          const ClearancePolicy& policy, const std::vector<std::string>& notes,
                          const std::string& ladder, const std::string& cylinder);

/// "pass", "warn" or "fail".
const char* VerdictWord(const OffsetResult& offset, const ClearancePolicy& policy);

}  // namespace wellgyro

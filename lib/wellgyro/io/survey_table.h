#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/uncertainty/survey_point.h"

namespace wellgyro {

/// Which north an azimuth column counts from. Unstated is what a bare AZI says.
enum class NorthReference { kUnstated, kTrue, kGrid };

/// MD, inclination and azimuth of any survey that is a table.
struct SurveyTable {
  std::vector<SurveyPoint> stations;  ///< TVD not filled
  NorthReference north = NorthReference::kUnstated;
  /// North, east, TVD of the first row, where columns give all three [m].
  std::optional<Eigen::Vector3d> start;
  bool depth_unit_stated = false;  ///< where not, depths were taken for metres
};

/// A survey from text with a header of names, as MD[m],INC[deg],AZI_TRUE[deg]: separated by comma,
/// semicolon, tab or spaces; names in any case; units in brackets or as an ending (md_ft): m or ft
/// for lengths, deg for angles. Columns beside MD, INC, AZI (or AZI_TRUE, AZI_GRID), N, E, TVD are
/// left; lines that begin with # too. Of two azimuth columns `wanted` is taken. A BOM and CRLF are
/// accepted.
///
/// Faults with line and column: kForeign when a column is missing or a unit unknown, kSyntax when a
/// cell is no number, kRange for values not finite or an inclination outside 0 to 180 deg, kOrder
/// when depth does not increase; a magnetic azimuth alone is kForeign.
WELLGYRO_EXPORT Result<SurveyTable> ParseSurveyTable(std::string_view text,
                                                     const std::string& source,
                                                     NorthReference wanted = NorthReference::kTrue);

/// The same from the file at `path`.
WELLGYRO_EXPORT Result<SurveyTable> ReadSurveyTable(const std::filesystem::path& path,
                                                    NorthReference wanted = NorthReference::kTrue);

}  // namespace wellgyro

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "wellgyro/record/survey_table.h"

namespace wellgyro {

/// What a survey file left open, so that its numbers were read by an assumption: lengths without a
/// unit as metres, curvatures without one as deg/30 m.
struct Claims {
  bool md_unit = true;         ///< said by the file or an option
  bool curvature_unit = true;  ///< the same
  bool offsets_north = false;  ///< said which north the offsets count from
  bool position_log = false;   ///< its angles come from its positions
  bool axes_named = true;      ///< false: X and Y, of which either may be the east
  std::vector<Column> open;    ///< lengths without a unit of their own, taken in that of MD
  /// Elevation of the depth datum as two columns give it, in units of MD.
  std::optional<double> sum_of_tvd_and_z;
  /// Of the datum that TVD counts from, where a head names it apart from that of MD [m].
  std::optional<double> tvd_elevation;
  std::string tvd_datum;
};

}  // namespace wellgyro

#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/earth/grid.h"
#include "wellgyro/uncertainty/survey_point.h"

namespace wellgyro {

/// The path of a well as a survey file gives it.
struct WellStations {
  std::vector<SurveyPoint> stations;                  ///< TVD not filled
  North north = North::kUnknown;                      ///< from which their azimuths count
  Eigen::Vector3d start_W = Eigen::Vector3d::Zero();  ///< north, east, TVD of the first [m]
  bool start_stated = false;                          ///< by columns that give all three
  std::optional<Eigen::Vector2d> offsets;  ///< north, east of the first, with or without TVD
  bool depth_unit_stated = true;           ///< where not, depths were taken for metres
  std::optional<Eigen::Vector2d> map;      ///< northing, easting of the first [m]
  std::optional<double> datum_elevation;   ///< of what depths count from [m]
};

/// The stations of a survey in any format of exchange.h. Where the file has azimuths from
/// several norths, those from `wanted` are taken. Faults as ReadSurvey; and kForeign when the
/// azimuths are magnetic only, kRange when there are fewer than two stations or the hole points
/// back the way it came. Options that a fault names are those of wellgyro convert.
WELLGYRO_EXPORT Result<WellStations> ParseWellStations(std::string_view text,
                                                       const std::string& source,
                                                       North wanted = North::kTrue);

/// Where two wells lie to each other by their map coordinates and by their offsets, if that differs
/// by more than 1 m and what scale of a map and height above its ellipsoid can make, 0.2 %: a
/// sentence with both distances. Offsets that count from two well heads are the usual reason.
WELLGYRO_EXPORT std::optional<std::string> PlacesContradict(const WellStations& a,
                                                            const WellStations& b);

}  // namespace wellgyro

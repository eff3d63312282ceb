#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/earth/north.h"
#include "wellgyro/uncertainty/survey_point.h"

namespace wellgyro {

/// The path of a well as a survey file gives it.
struct WellStations {
  std::vector<SurveyPoint> stations;                ///< TVD not filled
  North north = North::kUnknown;                    ///< from which their azimuths count
  Eigen::Vector3d start = Eigen::Vector3d::Zero();  ///< north, east, TVD of the first [m]
  bool start_stated = false;                        ///< by columns that give all three
  bool depth_unit_stated = true;                    ///< where not, depths were taken for metres
};

/// The stations of a survey in any format of exchange.h. Where the file has azimuths from
/// several norths, those from `wanted` are taken. Faults as ReadSurvey; and kForeign when the
/// azimuths are magnetic only, kRange when there are fewer than two stations or the hole points
/// back the way it came.
WELLGYRO_EXPORT Result<WellStations> ParseWellStations(std::string_view text,
                                                       const std::string& source,
                                                       North wanted = North::kTrue);

}  // namespace wellgyro

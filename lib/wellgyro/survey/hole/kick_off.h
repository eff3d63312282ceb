#pragma once

#include <cstddef>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/survey/hole/well_uncertainty.h"

namespace wellgyro {

/// The index of the station at `md` [m]; where there is none one is put in, on the arc, and counted
/// to the leg of the station below it. Throws std::domain_error outside the survey.
WELLGYRO_EXPORT std::size_t StationAt(std::vector<SurveyPoint>& stations,
                                      std::vector<ToolLeg>& legs, double md);

/// A survey with its errors.
struct KnownWell {
  SurveyedWell well;
  PositionUncertainty errors;
};

/// What lies from station `first` down. Throws std::domain_error when fewer than two stations with
/// covariances are left.
WELLGYRO_EXPORT KnownWell FromStation(const KnownWell& known, std::size_t first);

}  // namespace wellgyro

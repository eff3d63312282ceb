#pragma once

#include "wellgyro/survey/hole/well_uncertainty.h"
#include "wellgyro/trajectory/trajectory.h"

namespace wellgyro {

/// The arcs through a survey's stations, from the place of the first.
Trajectory LineOf(const SurveyedWell& well);

}  // namespace wellgyro

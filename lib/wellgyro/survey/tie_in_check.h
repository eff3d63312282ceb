#pragma once

#include <span>

#include "wellgyro/base/export.h"
#include "wellgyro/record/check.h"
#include "wellgyro/record/station.h"
#include "wellgyro/survey/job.h"

namespace wellgyro {

/// `tie_in` [deg]: the angle between the tie-in's direction and that of the station nearest to it,
/// within 30 m. Fails beyond 3 sigma of the station, 0.5 deg, by which two good surveys of one hole
/// may differ, and what a hole of 5 deg in 30 m bends between. Not done where the job gives the
/// tie-in no direction.
WELLGYRO_EXPORT Check CheckTieIn(const Job& job, std::span<const Station> stations);

}  // namespace wellgyro

#pragma once

#include <span>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/record/check.h"
#include "wellgyro/record/station.h"
#include "wellgyro/survey/job.h"
#include "wellgyro/survey/survey.h"
#include "wellgyro/trajectory/path.h"

namespace wellgyro {

/// `tie_in` [deg]: the angle between the tie-in's direction and that of the run's station or north
/// fix nearest to it, within 30 m. Fails beyond 3 sigma of that, 0.5 deg, by which two good surveys
/// of one hole may differ, and what a hole of 12 deg in 30 m, as motors build it, bends between.
/// Not done where the job gives the tie-in no direction.
WELLGYRO_EXPORT Check CheckTieIn(const Job& job, std::span<const Station> stations,
                                 std::span<const RunSummary> runs);

/// `tie_in_way` [m]: how far the tie-in's place is from where the runs' own directions lead from
/// the well head. The hole above the first station and between the last and the tie-in may go
/// anywhere; fails beyond that, 5 % of the way, which is another north's too, 30 m and 3 sigma. Not
/// done where no run has been over half of that way. `seen`: where the hole pointed, in any order.
WELLGYRO_EXPORT Check CheckTieInWay(const TieIn& tie_in, std::vector<PathStation> seen);

/// `tie_in_place` [m] of a tie-in below the datum, md > 0: how much further it is from the well
/// head than its depth along the hole reaches. Fails beyond 30 m, for a slot aside of where the job
/// counts from, .2 % of depth and 3 sigma. Where the job does not say north and east: how far they
/// can be from the 0 that is taken, by the two depths; warns beyond 1 m and 3 sigma.
WELLGYRO_EXPORT Check CheckTieInPlace(const TieIn& tie_in);

}  // namespace wellgyro

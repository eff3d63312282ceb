#pragma once

#include <vector>

#include "wellgyro/survey/job.h"
#include "wellgyro/survey/stations/draft.h"

namespace wellgyro {

/// Between the azimuths and the mirrors of stations that are averages at rest, chooses those that
/// make one hole: the path along depth that costs least, its bends against what a hole may bend
/// (1-sigma 1.7e-3 rad/m) and what the azimuths are uncertain by, from the tie-in's own direction
/// where the job gives it.
///
/// A station is resolved, and kMirror taken off it, where every path through its other azimuth
/// costs more by 9: because a neighbour, near or through others, has no mirror. A chain of stations
/// that all have one comes out as one hole, but stays flagged: the error that made one of them
/// choose wrongly is the tool's and made the others choose, so that all of them count as one.
void ResolveMirrors(const Job& job, std::vector<Draft>& drafts);

}  // namespace wellgyro

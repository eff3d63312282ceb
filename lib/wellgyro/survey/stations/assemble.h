#pragma once

#include <string>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/survey/job.h"
#include "wellgyro/survey/stations/draft.h"

namespace wellgyro {

/// Stations with positions, of one tool.
struct Placed {
  std::vector<Station> passes;  ///< all listed stations, by run, pass and time
  std::vector<Station> chosen;  ///< the tie-in and one station per depth; empty: see `unusable`
  std::string unusable;         ///< why there is no survey, in a sentence; empty: there is one
};

/// How far below the tie-in a run may begin and still take the tie-in's attitude from its own first
/// station [m]: what the depth of a tool at zero is out by.
WELLGYRO_EXPORT double TieInReach(const Job& job);

/// From drafts to positions: turns tool attitude to hole attitude, sums each pass from the tie-in
/// (or, where it begins deeper, from the pass above it), chooses one station per depth and sums the
/// chosen. Between stations the run's own way is summed, so that positions do not depend on the
/// stations' spacing. Position covariances are those of each station's own pass.
WELLGYRO_EXPORT Placed Assemble(const Job& job, const std::vector<DraftedRun>& runs);

}  // namespace wellgyro

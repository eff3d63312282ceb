#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "wellgyro/attitude/station_state.h"
#include "wellgyro/earth/earth.h"
#include "wellgyro/estimate/north_closure.h"
#include "wellgyro/estimate/setup.h"
#include "wellgyro/record/attitude_sample.h"
#include "wellgyro/record/north_fix.h"
#include "wellgyro/record/run_fit.h"
#include "wellgyro/record/run_knot.h"

namespace wellgyro {

/// A north found at rest, and the node at which its stop ends.
struct FixAtNode {
  NorthFix fix;
  std::size_t node = 0;
};

/// All that a run leaves to be estimated from. Node k + 1 is the end of knot k, node 0 the begin.
struct RunHistory {
  Site site;  ///< where the run starts; latitude and height are carried along the hole
  std::vector<RunKnot> knots;
  std::vector<AzimuthTie> ties;       ///< azimuths from outside
  std::vector<FixAtNode> fixes;       ///< in the order of time
  std::vector<std::size_t> stations;  ///< knots at whose ends stations are, ascending
  /// At the end of every knot and at every station, from what was known then; before the first
  /// north with it.
  std::vector<AttitudeSample> attitude;
  std::vector<StationState> states;
};

/// A run as all its knots together tell it.
struct SmoothedRun {
  std::vector<AttitudeSample> attitude;  ///< at the end of every knot
  std::vector<StationState> stations;    ///< as RunHistory::stations
  std::optional<RunFit> fit;             ///< where the run was adjusted as a whole
  std::vector<NorthClosure> closures;    ///< of RunHistory::fixes, then of its ties
};

}  // namespace wellgyro

#pragma once

#include <optional>
#include <vector>

#include "wellgyro/attitude/filter.h"
#include "wellgyro/attitude/filter_state.h"
#include "wellgyro/base/export.h"
#include "wellgyro/record/attitude_sample.h"
#include "wellgyro/record/run_fit.h"

namespace wellgyro {

/// A run as all its knots and fixes together tell it.
struct SmoothedRun {
  std::vector<AttitudeSample> attitude;  ///< of every epoch of the history
  std::vector<StationState> stations;    ///< of every marked station, in the order of time
  std::optional<RunFit> fit;             ///< where the run was adjusted as a whole
};

/// Fixed-interval smoothing of a run (modified Bryson-Frazier, which inverts no covariance), so
/// that a fix also serves the knots before it.
///
/// Where the azimuth is unknown until a fix, the path is first run backwards from that fix, so that
/// the Earth's share is right before anything is made linear; then the whole run is made linear
/// about the path and solved, twice. Time and memory are proportional to the number of knots.
/// Bierman, "Fixed interval smoothing with discrete measurements", Int. J. Control 18 (1973);
/// covariances of successive states after de Jong and Mackinnon, Biometrika 75 (1988).
WELLGYRO_EXPORT SmoothedRun Smooth(const FilterHistory& history);

}  // namespace wellgyro

#pragma once

#include <optional>

#include "wellgyro/base/export.h"
#include "wellgyro/plan/run_so_far.h"
#include "wellgyro/plan/stop_search.h"
#include "wellgyro/record/advice.h"
#include "wellgyro/survey/run/run_now.h"

namespace wellgyro {

/// What a run is advised by.
struct AdviceCase {
  PlanCase c;
  PlanLimits limits;
};

/// Where a run stands when it asks what to do.
struct AskingRun {
  std::optional<double> md;         ///< of the sensor point; absent: not known [m]
  double deepest = 0;               ///< so far [m]
  double rested = 0;                ///< at rest since; 0: it moves [s]
  double rest_known = 0;            ///< of it what `state` knows [s]
  const RunState* state = nullptr;  ///< null: no north yet
};

/// Of a run whose newest sample begins at `newest`: what rests by its last knot rests still.
/// `deepest`: of what was asked of it before, it knows that itself once it has a north [m].
WELLGYRO_EXPORT AskingRun AskingOf(const RunNow& now, std::optional<UtcTime> newest,
                                   double deepest);

/// The stops that meet `limits` in little time for what is left of a run of case `c`, from what it
/// knows: its covariance, its noise as found, the stops it has made. Before its first north as a
/// plan is made, from here on. The sums are those of StopInformation with knots of 12 s, some
/// forty places on either way; without a round of verification, as what they leave out shows in
/// `state` while the tool rests. Of faults in the gyros' drift those ahead count.
///
/// kNone where no way is left, no depth is known, or what is known of the run cannot be gone on
/// from. Time, number, session and run are the caller's. Throws as CheckPlanCase().
WELLGYRO_EXPORT Advice Advise(const PlanCase& c, const PlanLimits& limits, const AskingRun& run);

}  // namespace wellgyro

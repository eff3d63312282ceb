#pragma once

#include <vector>

#include "wellgyro/record/attitude_sample.h"
#include "wellgyro/record/north_fix.h"
#include "wellgyro/survey/run/run_history.h"

namespace wellgyro {

/// Which of a fix's two azimuths holds, by the one known before it.
void ChooseBranch(const AttitudeSample& before, NorthFix& fix);

/// The closure of a stop: what it says against what was known before it, errors that both share
/// left out. The variance of the step that the estimate makes is what the stop takes off the
/// azimuth's, and the step is that share of what the stop by itself is off.
void CloseOn(const AttitudeSample& before, const AttitudeSample& after, NorthFix& fix);

/// The closure of an azimuth from outside, which shares no error with what was known before it.
void CloseOnOutside(const AttitudeSample& before, NorthFix& tie);

/// The same of all that are listed, once the run is adjusted: each against the whole run without
/// it, see NorthClosures(), and of two azimuths the one that the run takes. What was said on the
/// way rests on a roll that gravity may not have shown, and may have taken a wrong branch.
void CloseOnWhole(const RunHistory& history, const SmoothedRun& run, std::vector<NorthFix>& listed);

}  // namespace wellgyro

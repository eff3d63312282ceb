#pragma once

#include <span>
#include <vector>

#include "wellgyro/record/attitude_sample.h"
#include "wellgyro/record/north_fix.h"
#include "wellgyro/survey/run_history.h"

namespace wellgyro {

/// Which of a fix's two azimuths holds, by the one known before it.
void ChooseBranch(const AttitudeSample& before, NorthFix& fix);

/// The closure of a stop: what it says against what was known before it, errors that both share
/// left out. The variance of the step that the estimate makes is what the stop takes off the
/// azimuth's, and the step is that share of what the stop by itself is off.
void CloseOn(const AttitudeSample& before, const AttitudeSample& after, NorthFix& fix);

/// The closure of an azimuth from outside, which shares no error with what was known before it.
void CloseOnOutside(const AttitudeSample& before, NorthFix& tie);

/// The closure of stops to which the tool came on a roll that gravity did not show, on which the
/// azimuth on the way then hangs: what the run as a whole, which every stop is part of, leaves of
/// the stop's own azimuth. The variance of that difference is the difference of the variances.
/// `whole`: attitudes at the end of every knot; `listed`: the run's fixes as told.
void CloseOnWhole(std::span<const FixAtNode> fixes, std::span<const AttitudeSample> whole,
                  std::vector<NorthFix>& listed);

}  // namespace wellgyro

#pragma once

#include <string>
#include <vector>

#include "wellgyro/fit/tool_adjust_internal.h"

namespace wellgyro {

/// Gives second order and anisoelasticity of which the readings cannot tell all (not in `seen`) the
/// prior sigmas of the setup; they are then needed, and join `seen`.
void GivePriors(const ToolReadings& readings, const ToolFitSetup& setup,
                std::vector<TermBundle>& bundles, std::vector<int>& seen);

/// Gives powers of the temperature that the readings cannot tell a prior sigma, the root mean
/// square of the coefficients of the power below, by the adjustment of all in `seen`; they are then
/// needed, and join `seen`. False: there are none.
bool GivePriorsByPower(const ToolAdjustment& full, std::vector<TermBundle>& bundles,
                       std::vector<int>& seen);

/// Remarks on the terms that rest on such priors: what each is confounded with, and which positions
/// or temperatures would tell.
std::vector<std::string> UntoldTerms(const ToolReadings& readings, const ToolModel& model,
                                     const ToolAdjustment& a);

}  // namespace wellgyro

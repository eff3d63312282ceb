#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/result.h"
#include "wellgyro/fit/tool_rows_internal.h"
#include "wellgyro/fit/tool_terms_internal.h"

namespace wellgyro {

/// Places of the bundles whose coefficients these readings tell apart from the others'.
std::vector<int> SeenBundles(const ToolReadings& readings, const ToolFitSetup& setup,
                             const std::vector<TermBundle>& bundles);

/// What the needed bundles have that the readings at their stated attitudes do not tell apart, but
/// for what the bench's tilt shows: one cone of attitudes gives no bias along its axis.
std::optional<Fault> UnseenNeeded(const ToolReadings& readings, const ToolFitSetup& setup,
                                  const std::vector<TermBundle>& bundles);

/// Of a direction in parameter space in which the readings say nothing: names those of `names` that
/// have a large part in it, and what to measure.
Fault Undetermined(const std::vector<std::string>& names, const Eigen::VectorXd& direction);

}  // namespace wellgyro

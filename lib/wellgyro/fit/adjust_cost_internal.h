#pragma once

#include <memory>

#include <ceres/cost_function.h>

#include "wellgyro/fit/adjust_layout_internal.h"
#include "wellgyro/fit/adjust_span_internal.h"

/// The residuals of a run's adjustment, each with its derivatives, each over its sigma.
namespace wellgyro {

/// Nodes before and after `span` and the common unknowns: growth of azimuth and inclination (at
/// rest: none) and how the drift goes on. All arguments must outlive the result.
std::unique_ptr<ceres::CostFunction> SpanCost(const AdjustLayout& layout, const AdjustSpan& span);

/// The same three: what the gyros read at rest against the Earth's rate.
std::unique_ptr<ceres::CostFunction> StillCost(const AdjustLayout& layout, const AdjustSpan& span);

/// The same three: the accelerometers' inclination.
std::unique_ptr<ceres::CostFunction> LevelCost(const AdjustLayout& layout, const AdjustSpan& span);

/// One node: its azimuth is `azimuth`, on whatever turn.
std::unique_ptr<ceres::CostFunction> AzimuthCost(const AdjustLayout& layout, double azimuth,
                                                 double sigma);

/// Two nodes at one depth, and the common unknowns: the same direction but for how the tool lies.
struct RepeatSigmas {
  double azimuth = 0, inclination = 0, sine = 1;  ///< [rad]; sine of the inclination
};
std::unique_ptr<ceres::CostFunction> RepeatCost(const AdjustLayout& layout,
                                                const RepeatSigmas& sigmas);

/// The first node: its drift is as large as its prior.
std::unique_ptr<ceres::CostFunction> DriftPriorCost(const AdjustLayout& layout);

/// The common unknowns are as large as their priors.
std::unique_ptr<ceres::CostFunction> CommonPriorCost(const AdjustLayout& layout);

}  // namespace wellgyro

#pragma once

#include "wellgyro/calibration/uncertainty_budget.h"
#include "wellgyro/fit/tool_adjust_internal.h"

namespace wellgyro {

/// What an adjustment's covariance is made of.
struct ToolParts {
  CovarianceParts cov;
  /// Sigmas of the readings that were found from their scatter: sigma_accel [its unit],
  /// sigma_gyro_deg_per_h, sigma_gyro_table_deg_per_h.
  std::vector<FitQuantity> found;
};

/// The covariance of an adjustment by its sources. With X the change of the readings y with the
/// parameters, R the readings' covariance, priors mu_j of sigma s_j and N their information,
///   x = C (X' R^-1 y + sum_j e_j mu_j / s_j^2),   C = (X' R^-1 X + N)^-1,
/// so that a prior contributes c c', c = C e_j / s_j, and a part V_k of R contributes
/// C X' R^-1 V_k R^-1 X C. Parts of R that the readings gave are "readings", of type A; those that
/// were stated, and the priors, are of type B, under the names of what was stated.
ToolParts PartsOf(const ToolReadings& readings, const ToolFitSetup& setup, const ToolModel& model,
                  const ToolAdjustment& adjustment);

}  // namespace wellgyro

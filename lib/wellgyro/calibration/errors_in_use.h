#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/record/error_covariance.h"
#include "wellgyro/record/tool_calibration.h"
#include "wellgyro/record/tool_use.h"

namespace wellgyro {

/// What one more of each member (calibration/members.h) does to the constant errors that the
/// estimator carries, a column each, in the mean of `uses`; to first order. What a gyro feels of
/// the force along the axis counts with its bias, and what it feels of products of the force with
/// what they amount to at this inclination in the mean of all toolfaces.
WELLGYRO_EXPORT Eigen::MatrixXd ErrorEffects(const ToolCalibration& tool,
                                             const std::vector<std::string>& members,
                                             std::span<const ToolUse> uses);

/// Covariance of these errors that the covariance of the tool model's members leaves, a straight
/// line in the temperature through those of `uses`; what differs from one use to the next beside it
/// counts with the constants by its mean square, and so do, with the biases, the gyros' squares of
/// the force, which go by twice the toolface, and what a third axis feels of the force across.
/// Nothing where the tool has no such covariance, or `uses` is empty.
WELLGYRO_EXPORT std::optional<ErrorCovariance> ErrorsInUse(const ToolCalibration& tool,
                                                           std::span<const ToolUse> uses);

}  // namespace wellgyro

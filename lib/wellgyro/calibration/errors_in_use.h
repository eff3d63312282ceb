#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/record/error_source.h"
#include "wellgyro/record/tool_calibration.h"
#include "wellgyro/record/tool_use.h"

namespace wellgyro {

/// What one more of each member (calibration/members.h) does to the constant errors that the
/// estimator carries, a column each, in the mean of `uses`; to first order. What a gyro feels of
/// the force along the axis counts with its bias, and the products of force with what they amount
/// to at this inclination in the mean of all toolfaces.
WELLGYRO_EXPORT Eigen::MatrixXd ErrorEffects(const ToolCalibration& tool,
                                             const std::vector<std::string>& members,
                                             std::span<const ToolUse> uses);

/// Covariance of these errors that the covariance of the tool model's members leaves, in the mean
/// of `uses`, none of which is one alone: force terms that go by twice the toolface count with the
/// biases by their mean square. Nothing where the tool has no such covariance, or `uses` is empty.
WELLGYRO_EXPORT std::optional<ErrorMatrix> ErrorsInUse(const ToolCalibration& tool,
                                                       std::span<const ToolUse> uses);

}  // namespace wellgyro

#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/record/tool_calibration.h"

namespace wellgyro {

/// Whether readings of this SHA-256 are among those that the tool's covariance rests on.
WELLGYRO_EXPORT bool RestsOn(const ToolCalibration& tool, const std::string& sha256);

struct JoinedTool {
  ToolCalibration tool;
  double chi_square = 0;   ///< of what both know, the difference over both covariances
  int dof = 0;             ///< of these numbers
  double probability = 1;  ///< that chance makes them differ as much
  /// That chance makes biases, sensitivities and force terms at the reference temperature differ as
  /// little: near 0 where both rest on the same readings.
  double likeness = 1;
  std::vector<std::string> members;
  Eigen::MatrixXd by_bench;      ///< members by what the bench found of them
  Eigen::MatrixXd cov_by_prior;  ///< of the members, what the prior contributes
};

/// `tool`, as a bench found it, joined with what was known of its members before, from an earlier
/// calibration or from runs (Taught): of members that both have, in the temperature scale of
/// `tool`. The two must not rest on the same readings, and the tool must not have changed between
/// them, which chi_square tests. Throws std::invalid_argument where either has no covariance of its
/// members, or where their groups of sensors differ in channels or axes.
WELLGYRO_EXPORT JoinedTool JoinPrior(ToolCalibration tool, const ToolCalibration& prior);

}  // namespace wellgyro

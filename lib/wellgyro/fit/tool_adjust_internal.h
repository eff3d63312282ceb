#pragma once

#include <array>
#include <vector>

#include "wellgyro/base/result.h"
#include "wellgyro/fit/least_squares_internal.h"
#include "wellgyro/fit/tool_model_internal.h"

namespace wellgyro {

/// An adjustment of the tool's readings.
struct ToolAdjustment {
  Eigen::VectorXd x;
  Eigen::MatrixXd cov;
  ToolNoise noise;
  std::vector<char> out;  ///< by row: left out
  LinearProblem linear;   ///< about x, whitened; rows' lines are places in readings.rows plus one
  LinearSolution solution;
  /// Of the wobble's variance, and of that on the rate table; 0 where it was given or there is
  /// none [rad^2].
  std::array<double, 2> sigma_wobble_square{};
};

/// The model about x with its priors, whitened, priors as rows of line 0; without the rows in
/// `out`.
LinearProblem LineariseTool(const ToolReadings& readings, const ToolModel& model,
                            const ToolNoise& noise, const std::vector<char>& out,
                            const Eigen::VectorXd& x);

/// Adjusts `terms`; outliers join `out`. The Fault when it does not settle.
Result<ToolAdjustment> AdjustTool(const ToolReadings& readings, const ToolFitSetup& setup,
                                  const std::vector<ToolTerm>& terms);

}  // namespace wellgyro

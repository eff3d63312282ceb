#pragma once

#include <vector>

#include <Eigen/Core>

#include "wellgyro/fit/tool_model_internal.h"

namespace wellgyro {

/// What was known of the parameters before any reading: rows A (x - x0) of unit variance.
struct ToolPrior {
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> A;
  Eigen::VectorXd x0;  ///< zeros: terms and bench are expected at their nominal values
};

/// Of the nuisances, and of terms that have one.
ToolPrior PriorOfTool(const ToolModel& model);

/// A row of readings, and the matrix that brings its residual to unit covariance.
struct WhitenedRow {
  const ToolRow* row = nullptr;
  Eigen::MatrixXd whitener;
};

/// Brings x to the least squares of the whitened rows and the prior, by Levenberg and Marquardt.
/// `robust`: rows count by Cauchy's loss, whose scale is twice the root of their channels. False
/// where it does not settle.
bool MinimiseTool(const ToolModel& model, const std::vector<WhitenedRow>& rows, bool robust,
                  Eigen::VectorXd& x);

}  // namespace wellgyro

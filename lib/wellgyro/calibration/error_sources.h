#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/calibration/uncertainty_budget.h"
#include "wellgyro/record/noise.h"
#include "wellgyro/record/tool_calibration.h"

namespace wellgyro {

/// Errors that a calibration leaves in calibrated samples at one temperature, measured less true,
/// in T and SI, with their whole covariance:
///   rate  + b + A w + G f,  force  + b + A f.
/// Names: gyro_bias_x [rad/s], gyro_scale_x, gyro_misalignment_xy (w_y seen by x), gyro_force_xy
/// (f_y seen by x) [rad/s per m/s2]; mass_unbalance and quadrature, what G has of
/// x: m f_x + q f_y, y: m f_y - q f_x; accel_bias_x [m/s2], accel_scale_x, accel_misalignment_xy.
struct CalibrationSources {
  std::vector<std::string> names;
  Eigen::MatrixXd cov;

  /// Place of a name; throws std::invalid_argument where it is none.
  Eigen::Index At(const std::string& name) const;
};

/// From the covariance of the tool model's members (calibration/members.h), to first order. Second
/// order counts by its mean over all attitudes, heating not at all: at rest in a hole there is
/// none. Outside the calibrated range as at its end. Zero where the tool has no such covariance.
WELLGYRO_EXPORT CalibrationSources SourcesOf(const ToolCalibration& tool, double temperature);

/// Their covariance by its sources, where that of `members` is the sum of `parts`; what the tool
/// has of other members is of an "earlier calibration".
WELLGYRO_EXPORT CovarianceParts SourcesByParts(const ToolCalibration& tool,
                                               const std::vector<std::string>& members,
                                               const CovarianceParts& parts, double temperature);

/// Of what these errors change by from one temperature to another.
WELLGYRO_EXPORT CalibrationSources ChangeOfSources(const ToolCalibration& tool, double from,
                                                   double to);

/// What one more of each member (calibration/members.h) does to the sources, a column each.
WELLGYRO_EXPORT Eigen::MatrixXd SourceEffects(const ToolCalibration& tool,
                                              const std::vector<std::string>& members,
                                              double temperature);

/// What two gyros across the hole see of the rate about the third axis, x and y in T [rad]: nothing
/// measures that rate, so that samples keep it. Zero where there are more channels, or none.
WELLGYRO_EXPORT Eigen::Vector2d AxialCoupling(const SensorGroup& gyro);

/// `errors` with the largest sigmas of these sources over the calibrated range in place of what it
/// holds of them; as it is where the tool has no covariance of members.
WELLGYRO_EXPORT ErrorPriors ErrorsLeft(const ToolCalibration& tool, ErrorPriors errors);

}  // namespace wellgyro

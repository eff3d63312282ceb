#pragma once

#include <Eigen/Core>

#include "wellgyro/record/tool_calibration.h"

namespace wellgyro {

/// A group of sensors at one temperature: from what its channels read to u in T.
struct GroupAt {
  double tau = 0;
  Eigen::Matrix<double, 3, 4> from_units = Eigen::Matrix<double, 3, 4>::Zero();
  Eigen::Matrix3d R_ST = Eigen::Matrix3d::Identity();
};

/// The temperature [degC] held at the end of the calibrated range.
GroupAt At(const SensorGroup& group, double temperature);

/// Whether its covariance is that of the tool model's members (calibration/members.h).
bool HasMembers(const SensorGroup& group);

}  // namespace wellgyro

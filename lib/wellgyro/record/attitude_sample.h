#pragma once

#include <Eigen/Core>

#include "wellgyro/base/time.h"
#include "wellgyro/record/quality.h"

namespace wellgyro {

/// The tool's attitude at one instant: R_LT = Rz(azimuth) Ry(inclination) Rz(toolface).
struct AttitudeSample {
  ToolTime time;
  double inclination = 0;      ///< [rad]
  double azimuth = 0;          ///< true, of the tool axis at the tool's own meridian [rad]
  double toolface = 0;         ///< from the high side to the reference mark [rad]
  bool azimuth_known = false;  ///< false: no north yet, `azimuth` counts from an arbitrary zero
  /// Of (inclination, azimuth, toolface) [rad^2].
  Eigen::Matrix3d cov_attitude = Eigen::Matrix3d::Zero();
  Quality quality = Quality::kGood;
};

}  // namespace wellgyro

#include "wellgyro/survey/hole_attitude.h"

#include <algorithm>
#include <cmath>

#include "wellgyro/base/angle.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/record/unknown_angle.h"

namespace wellgyro {

HoleAttitude AttitudeOfHole(const AttitudeSample& tool, const StringSpec& string) {
  const Eigen::Matrix3d R_LT = AttitudeMatrix(tool.azimuth, tool.inclination, tool.toolface);
  const Eigen::Vector3d high_side_L =
      RotationZ(tool.azimuth) * RotationY(tool.inclination) * Eigen::Vector3d::UnitX();
  const double sin_tool = std::sin(tool.inclination);
  const Eigen::Vector3d axis_L =
      R_LT * Eigen::Vector3d(-string.misalignment_x, -string.misalignment_y, 1) +
      string.sag * sin_tool * high_side_L;

  HoleAttitude hole{.tangent_L = axis_L.normalized()};
  const double horizontal = std::hypot(axis_L.x(), axis_L.y());
  hole.inclination = std::atan2(horizontal, axis_L.z());
  hole.azimuth = WrapTwoPi(horizontal > 0 ? std::atan2(axis_L.y(), axis_L.x()) : tool.azimuth);

  const double s = std::sin(hole.inclination);
  const double sag = string.sigma_sag * s;
  const double lean = string.sigma_misalignment;
  hole.cov = tool.cov_attitude.topLeftCorner<2, 2>();
  hole.cov(0, 0) += sag * sag + lean * lean;
  const double azimuth = hole.cov(1, 1) + (lean > 0 ? lean * lean / (s * s) : 0);
  if (azimuth < kUnknownAngleVariance) {
    hole.cov(1, 1) = azimuth;
  } else {
    hole.cov(1, 1) = kUnknownAngleVariance;
    hole.cov(0, 1) = hole.cov(1, 0) = 0;
  }
  return hole;
}

Eigen::Matrix3d CovarianceOfTangent(const HoleAttitude& hole, const Eigen::Matrix3d& cov_axis_L,
                                    const StringSpec& string) {
  const double sag = string.sigma_sag * std::sin(hole.inclination);
  const double lean = string.sigma_misalignment;
  const Eigen::Vector3d hangs = sag * TangentByAngles(hole.inclination, hole.azimuth).col(0);
  return cov_axis_L +
         lean * lean * (Eigen::Matrix3d::Identity() - hole.tangent_L * hole.tangent_L.transpose()) +
         hangs * hangs.transpose();
}

double DirectionOfMark(const AttitudeSample& tool) {
  // R_LT e_x = Rz(A) (cos I cos T, sin T, .)
  return WrapTwoPi(tool.azimuth + std::atan2(std::sin(tool.toolface),
                                             std::cos(tool.inclination) * std::cos(tool.toolface)));
}

}  // namespace wellgyro

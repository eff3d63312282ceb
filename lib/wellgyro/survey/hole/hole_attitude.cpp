#include "wellgyro/survey/hole/hole_attitude.h"

#include <cmath>

#include "wellgyro/base/angle.h"
#include "wellgyro/math/rotation.h"

namespace wellgyro {

Eigen::Vector3d TangentOfHole(const AttitudeSample& tool, const StringSpec& string) {
  const Eigen::Matrix3d R_LT = AttitudeMatrix(tool.azimuth, tool.inclination, tool.toolface);
  const Eigen::Vector3d high_side_L =
      RotationZ(tool.azimuth) * RotationY(tool.inclination) * Eigen::Vector3d::UnitX();
  const Eigen::Vector3d axis_L =
      R_LT * Eigen::Vector3d(-string.misalignment_x, -string.misalignment_y, 1) +
      string.sag * std::sin(tool.inclination) * high_side_L;
  return axis_L.normalized();
}

Eigen::Matrix3d CovarianceOfTangent(const Eigen::Vector3d& tangent_L,
                                    const Eigen::Matrix3d& cov_axis_L, const StringSpec& string) {
  const double inclination = InclinationOf(tangent_L);
  const double lean = string.sigma_misalignment, sag = string.sigma_sag * std::sin(inclination);
  const Eigen::Vector3d hangs = sag * TangentByAngles(inclination, AzimuthOf(tangent_L)).col(0);
  return cov_axis_L +
         lean * lean * (Eigen::Matrix3d::Identity() - tangent_L * tangent_L.transpose()) +
         hangs * hangs.transpose();
}

double DirectionOfMark(const AttitudeSample& tool) {
  // R_LT e_x = Rz(A) (cos I cos T, sin T, .)
  return WrapTwoPi(tool.azimuth + std::atan2(std::sin(tool.toolface),
                                             std::cos(tool.inclination) * std::cos(tool.toolface)));
}

}  // namespace wellgyro

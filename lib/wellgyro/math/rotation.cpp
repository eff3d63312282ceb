#include "wellgyro/math/rotation.h"

#include <cmath>

namespace wellgyro {

Eigen::Matrix3d RotationX(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return (Eigen::Matrix3d() << 1, 0, 0, 0, c, -s, 0, s, c).finished();
}

Eigen::Matrix3d RotationY(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return (Eigen::Matrix3d() << c, 0, s, 0, 1, 0, -s, 0, c).finished();
}

Eigen::Matrix3d RotationZ(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return (Eigen::Matrix3d() << c, -s, 0, s, c, 0, 0, 0, 1).finished();
}

Eigen::Matrix3d AttitudeMatrix(double azimuth, double inclination, double toolface) {
  return RotationZ(azimuth) * RotationY(inclination) * RotationZ(toolface);
}

Eigen::Vector3d Tangent(double inclination, double azimuth) {
  const double s = std::sin(inclination);
  return {s * std::cos(azimuth), s * std::sin(azimuth), std::cos(inclination)};
}

}  // namespace wellgyro

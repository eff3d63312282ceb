#include "wellgyro/math/rotation.h"

#include <cmath>

#include "wellgyro/base/angle.h"

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

double AngleAboutZ(const Eigen::Matrix3d& R) {
  return std::atan2(R(1, 0) - R(0, 1), R(0, 0) + R(1, 1));
}

Eigen::Matrix3d AttitudeMatrix(double azimuth, double inclination, double toolface) {
  return RotationZ(azimuth) * RotationY(inclination) * RotationZ(toolface);
}

Eigen::Vector3d Tangent(double inclination, double azimuth) {
  const double s = std::sin(inclination);
  return {s * std::cos(azimuth), s * std::sin(azimuth), std::cos(inclination)};
}

double InclinationOf(const Eigen::Vector3d& axis_L) {
  return std::atan2(std::hypot(axis_L.x(), axis_L.y()), axis_L.z());
}

double AzimuthOf(const Eigen::Vector3d& axis_L) {
  return WrapTwoPi(std::atan2(axis_L.y(), axis_L.x()));
}

Eigen::Matrix<double, 3, 2> TangentByAngles(double inclination, double azimuth) {
  const double si = std::sin(inclination), ci = std::cos(inclination);
  const double sa = std::sin(azimuth), ca = std::cos(azimuth);
  Eigen::Matrix<double, 3, 2> slope;
  slope << ci * ca, -si * sa, ci * sa, si * ca, -si, 0;
  return slope;
}

}  // namespace wellgyro

#include "wellgyro/math/so3.h"

#include <cmath>

#include <Eigen/Geometry>

namespace wellgyro {

Eigen::Matrix3d Skew(const Eigen::Vector3d& v) {
  return (Eigen::Matrix3d() << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0).finished();
}

Eigen::Matrix3d Exp(const Eigen::Vector3d& v) {
  const double square = v.squaredNorm();
  double sinc = 1 - square / 6, half = 0.5 - square / 24;
  if (square > 1e-8) {  // the next terms of the series, angle^4/120 and /720, are then below eps
    const double angle = std::sqrt(square);
    const double s = std::sin(0.5 * angle);
    sinc = std::sin(angle) / angle;
    half = 2 * s * s / square;  // (1 - cos)/angle^2 without cancellation
  }
  const Eigen::Matrix3d K = Skew(v);
  return Eigen::Matrix3d::Identity() + sinc * K + half * K * K;
}

Eigen::Vector3d Log(const Eigen::Matrix3d& R) {
  const Eigen::Vector3d axis(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
  const double sine = 0.5 * axis.norm();
  const double angle = std::atan2(sine, 0.5 * (R.trace() - 1));
  if (sine > 1e-8) return axis * (0.5 * angle / sine);
  if (R.trace() > 0) return 0.5 * axis;
  // Half a turn: R = 2 a a' - 1, and the largest column of R + 1 is the axis.
  const Eigen::Matrix3d twice = R + Eigen::Matrix3d::Identity();
  Eigen::Index column = 0;
  twice.diagonal().maxCoeff(&column);
  return angle * twice.col(column).normalized();
}

}  // namespace wellgyro

#include "wellgyro/math/so3.h"

#include <cmath>

#include <Eigen/Geometry>

namespace wellgyro {
namespace {

struct Ratios {
  double sinc = 1;         ///< sin(angle) / angle
  double half = 0.5;       ///< (1 - cos(angle)) / angle^2
  double third = 1.0 / 6;  ///< (angle - sin(angle)) / angle^3
};

Ratios RatiosAt(double square) {
  if (square < 0.01) {  // the next terms of the series are below 1e-17
    const double s = square;
    return {1 - s * (1. / 6 - s * (1. / 120 - s * (1. / 5040 - s * (1. / 362880)))),
            0.5 - s * (1. / 24 - s * (1. / 720 - s * (1. / 40320 - s * (1. / 3628800)))),
            1. / 6 - s * (1. / 120 - s * (1. / 5040 - s * (1. / 362880 - s * (1. / 39916800))))};
  }
  const double angle = std::sqrt(square);
  const double s = std::sin(0.5 * angle);
  const double sinc = std::sin(angle) / angle;
  return {sinc, 2 * s * s / square, (1 - sinc) / square};  // the second without cancellation
}

// 1 + a [v] + b [v]^2 with the cross product's matrix [v], [v]^2 = v v' - |v|^2.
Eigen::Matrix3d Sum(const Eigen::Vector3d& v, double a, double b) {
  Eigen::Matrix3d sum = b * v * v.transpose() + a * Skew(v);
  sum.diagonal().array() += 1 - b * v.squaredNorm();
  return sum;
}

}  // namespace

Eigen::Matrix3d Skew(const Eigen::Vector3d& v) {
  return (Eigen::Matrix3d() << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0).finished();
}

Eigen::Matrix3d Exp(const Eigen::Vector3d& v) {
  const Ratios at = RatiosAt(v.squaredNorm());
  return Sum(v, at.sinc, at.half);
}

Eigen::Matrix3d LeftJacobian(const Eigen::Vector3d& v) {
  const Ratios at = RatiosAt(v.squaredNorm());
  return Sum(v, at.half, at.third);
}

Eigen::Vector3d Log(const Eigen::Matrix3d& R) {
  const Eigen::Vector3d axis(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
  const double s = 0.25 * axis.squaredNorm(), trace = R.trace();
  if (s < 1e-3 && trace > 0) {  // the next term of the series of the arc sine is below 1e-17
    const double ratio =
        1 + s * (1. / 6 + s * (3. / 40 + s * (15. / 336 + s * (105. / 3456 + s * (945. / 42240)))));
    return 0.5 * ratio * axis;
  }
  const double sine = std::sqrt(s);
  const double angle = std::atan2(sine, 0.5 * (trace - 1));
  if (sine > 1e-8) return axis * (0.5 * angle / sine);
  // Half a turn: R = 2 a a' - 1, and the largest column of R + 1 is the axis.
  const Eigen::Matrix3d twice = R + Eigen::Matrix3d::Identity();
  Eigen::Index column = 0;
  twice.diagonal().maxCoeff(&column);
  return angle * twice.col(column).normalized();
}

}  // namespace wellgyro

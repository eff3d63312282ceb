#pragma once

#include <Eigen/Core>

#include "wellgyro/math/rotation.h"

namespace wellgyro {

/// Derivative of r = Log(R) on SO(3): for R -> Exp(-a) R Exp(b), dr = right b - left a with the
/// inverse Jacobians I +- [r]x / 2 + [r]x^2 / 12, to the second order of r. A heading change common
/// to both nodes then leaves r as it is. With unit matrices it would change r by |r|, one sigma a
/// radian, and over thousands of knots that linearisation error would observe a heading which no
/// sensor measures. Holds in any frame.
struct LogSlopes {
  explicit LogSlopes(const Eigen::Vector3d& r) {
    const Eigen::Matrix3d rx = Skew(r);
    const Eigen::Matrix3d even = Eigen::Matrix3d::Identity() + rx * rx / 12;
    left = even - 0.5 * rx;
    right = even + 0.5 * rx;
  }
  Eigen::Matrix3d left, right;
};

}  // namespace wellgyro

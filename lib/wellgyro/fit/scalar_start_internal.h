#pragma once

#include <vector>

#include <Eigen/Core>

namespace wellgyro {

/// M (lower triangle by rows, 6) and b (3) with |M (v - b)| about `length`: places to start from,
/// the best first guess last.
std::vector<Eigen::VectorXd> ScalarStarts(const Eigen::MatrixX3d& v, double length);

/// Lower triangle by rows.
Eigen::Matrix3d LowerOf(const Eigen::VectorXd& x);

}  // namespace wellgyro

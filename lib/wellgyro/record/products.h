#pragma once

#include <Eigen/Core>

namespace wellgyro {

/// q(a) = (ax^2, ay^2, az^2, ax ay, ay az, az ax) of a vector in any frame, as in the second order
/// of SensorGroup and of kAccelSecondOrder: product p is a[kFirstFactor[p]] a[kSecondFactor[p]].
using VectorProducts = Eigen::Matrix<double, 6, 1>;
inline constexpr int kFirstFactor[] = {0, 1, 2, 0, 1, 2}, kSecondFactor[] = {0, 1, 2, 1, 2, 0};
inline VectorProducts ProductsOf(const Eigen::Vector3d& a) {
  VectorProducts q;
  q << a.x() * a.x(), a.y() * a.y(), a.z() * a.z(), a.x() * a.y(), a.y() * a.z(), a.z() * a.x();
  return q;
}

/// Which product a_i a_j is.
constexpr int PlaceOfProduct(int i, int j) {
  int p = 0;
  const auto is = [&](int first, int second) {
    return kFirstFactor[p] == first && kSecondFactor[p] == second;
  };
  while (!is(i, j) && !is(j, i)) ++p;
  return p;
}

}  // namespace wellgyro

#include "wellgyro/math/interpolation.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Core>
#include <Eigen/LU>

namespace wellgyro {
namespace {

/// Moments of points that all but coincide determine no slope: the determinant, scaled to the
/// product of the diagonal, is then rounding.
template <int n>
bool Determined(const Eigen::Matrix<double, n, n>& moments) {
  return moments.determinant() > 1e-10 * moments.diagonal().prod();
}

template <int n>
LocalFit::Value Solve(const double* s, const double* w2, const double* y, double yy, int count,
                      bool& determined) {
  Eigen::Matrix<double, n, n> m, squares;
  Eigen::Matrix<double, n, 1> right;
  for (int i = 0; i < n; ++i) {
    right[i] = y[i];
    for (int j = 0; j < n; ++j) {
      m(i, j) = s[i + j];
      squares(i, j) = w2[i + j];
    }
  }
  determined = Determined<n>(m);
  if (!determined) return {};
  const Eigen::Matrix<double, n, n> inverse = m.inverse();
  const Eigen::Matrix<double, n, 1> c = inverse * right;
  LocalFit::Value value;
  value.value = c[0];
  if constexpr (n > 1) value.slope = c[1];
  if constexpr (n > 2) value.curvature = 2 * c[2];
  const Eigen::Matrix<double, n, n> variance = inverse * squares * inverse;
  value.variance_value = variance(0, 0);
  if constexpr (n > 1) value.variance_slope = variance(1, 1);
  if constexpr (n > 2) value.variance_curvature = 4 * variance(2, 2);
  // Weighted squares left over, by their expectation for unit variance. What a difference of large
  // sums leaves by rounding is none.
  const double left = yy - c.dot(right);
  const double expected = s[0] - (inverse * squares).trace();
  if (count > n && expected > 1e-6 * s[0] && left > 1e-12 * yy) {
    value.scatter = std::sqrt(left / expected);
  }
  value.freedom = std::max(0.0, s[0] * s[0] / w2[0] - n);
  return value;
}

}  // namespace

void LocalFit::Add(double t, double y, double weight) {
  if (!(weight > 0)) return;
  ++count_;
  double power = weight;
  for (int k = 0; k < 5; ++k, power *= t) {
    s_[k] += power;
    w2_[k] += power * weight;
    if (k < 3) y_[k] += power * y;
  }
  yy_ += weight * y * y;
}

LocalFit::Value LocalFit::Fit(int degree) const {
  bool determined = false;
  if (degree >= 2 && count_ >= 3) {
    const Value value = Solve<3>(s_, w2_, y_, yy_, count_, determined);
    if (determined) return value;
  }
  if (degree >= 1 && count_ >= 2) {
    const Value value = Solve<2>(s_, w2_, y_, yy_, count_, determined);
    if (determined) return value;
  }
  return count_ > 0 ? Solve<1>(s_, w2_, y_, yy_, count_, determined) : Value{};
}

}  // namespace wellgyro

#include "wellgyro/math/spline.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace wellgyro {
namespace {

using Eigen::Vector3d;

/// The greatest error of the slopes of f at `x`, by components.
template <typename F, typename Slope>
Vector3d Worst(const std::vector<double>& x, const F& f, const Slope& slope) {
  std::vector<Vector3d> y;
  for (const double at : x) y.push_back(f(at));
  const std::vector<Vector3d> s = SplineSlopes(x, y);
  Vector3d worst = Vector3d::Zero();
  for (std::size_t k = 0; k < x.size(); ++k) {
    worst = worst.cwiseMax((s[k] - slope(x[k])).cwiseAbs());
  }
  return worst;
}

// Of so many points a polynomial of so high a degree, unevenly spaced.
TEST(SplineSlopes, PolynomialsUpToTheThirdDegreeAreExact) {
  const std::vector<double> x = {-1, -0.7, 0.1, 0.4, 1.3, 1.5};
  for (std::size_t n = 2; n <= x.size(); ++n) {
    const Vector3d third = n > 3 ? Vector3d(2, -1, 0.5) : Vector3d::Zero();
    const Vector3d second = n > 2 ? Vector3d(-3, 1, 4) : Vector3d::Zero();
    const Vector3d first(1, 2, 3);
    const std::vector<double> some(x.begin(), x.begin() + static_cast<std::ptrdiff_t>(n));
    const auto f = [&](double t) -> Vector3d {
      return t * (first + t * (second + t * third)) + Vector3d::Ones();
    };
    const auto slope = [&](double t) -> Vector3d {
      return first + t * (2 * second + 3 * t * third);
    };
    EXPECT_LT(Worst(some, f, slope).maxCoeff(), 1e-13) << n;
  }
}

// Away from the ends they err by h^4 / 180 of the fifth derivative, and are less.
TEST(SplineSlopes, ErrByTheFourthPowerOfTheSpacing) {
  std::vector<double> x;
  for (int k = -40; k <= 40; ++k) x.push_back(0.25 * k);
  std::vector<Vector3d> y;
  for (const double at : x) y.emplace_back(std::sin(at), std::cos(at), 0);
  const std::vector<Vector3d> s = SplineSlopes(x, y);
  const double expected = std::pow(0.25, 4) / 180;
  EXPECT_NEAR(1 - s[40].x(), expected, 0.05 * expected);
}

}  // namespace
}  // namespace wellgyro

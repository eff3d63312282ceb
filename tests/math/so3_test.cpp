#include "wellgyro/math/so3.h"

#include <cmath>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "wellgyro/math/random.h"

namespace wellgyro {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// The defining series in long double, which converges for any angle: of Exp(v), or of the mean of
/// Exp(s v) over s from 0 to 1, which divides the power n of s by n + 1.
Matrix3d Series(const Vector3d& v, bool mean) {
  using MatrixL = Eigen::Matrix<long double, 3, 3>;
  const MatrixL K = Skew(v).cast<long double>();
  MatrixL sum = MatrixL::Identity(), term = sum;
  for (int n = 1; n < 60; ++n) {
    term = (term * K / static_cast<long double>(n)).eval();
    sum += term / static_cast<long double>(mean ? n + 1 : 1);
  }
  return sum.cast<double>();
}
Matrix3d SeriesExp(const Vector3d& v) { return Series(v, false); }

Vector3d RandomVector(Random& random, double length) {
  const Vector3d v{random.Normal(), random.Normal(), random.Normal()};
  return length * v.normalized();
}

TEST(So3, SkewIsTheCrossProduct) {
  Random random(1);
  const Vector3d u = RandomVector(random, 2), v = RandomVector(random, 3);
  EXPECT_LT((Skew(u) * v - u.cross(v)).norm(), 1e-15);
}

TEST(So3, ExpIsItsSeriesAtEveryAngle) {
  Random random(2);
  for (const double angle : {0.0, 1e-12, 1e-5, 1e-4, 0.01, 0.0999, 0.1001, 1.0, 3.0, 6.0}) {
    const Vector3d v = RandomVector(random, angle);
    EXPECT_LT((Exp(v) - SeriesExp(v)).norm(), 4e-15) << angle;
  }
}

TEST(So3, LeftJacobianIsTheMeanTurnAtEveryAngle) {
  Random random(5);
  for (const double angle : {0.0, 1e-12, 1e-8, 1e-5, 0.01, 0.0999, 0.1001, 1.0, 3.0, 6.0}) {
    const Vector3d v = RandomVector(random, angle);
    EXPECT_LT((LeftJacobian(v) - Series(v, true)).norm(), 4e-15) << angle;
    // What an error d of v turns beyond Exp(v), to the second order of d.
    const Vector3d d = RandomVector(random, 1e-6);
    const Vector3d turned = Log(Exp(v + d) * Exp(v).transpose());
    EXPECT_LT((turned - LeftJacobian(v) * d).norm(), 3e-12) << angle;
  }
}

TEST(So3, LogUndoesExp) {
  Random random(3);
  for (const double angle : {0.0, 1e-12, 1e-9, 1e-7, 1e-4, 0.0316, 0.0317, 0.5, 1.6, 3.0}) {
    const Vector3d v = RandomVector(random, angle);
    EXPECT_LT((Log(Exp(v)) - v).norm(), 1e-15 + 4e-15 * angle) << angle;
  }
}

TEST(So3, LogOfHalfATurnIsHalfATurn) {
  Random random(4);
  for (const double less : {0.0, 1e-10, 1e-7}) {
    const Vector3d v = RandomVector(random, M_PI - less);
    EXPECT_LT((Exp(Log(Exp(v))) - Exp(v)).norm(), 1e-7) << less;
    EXPECT_NEAR(Log(Exp(v)).norm(), M_PI - less, 1e-7) << less;
  }
}

}  // namespace
}  // namespace wellgyro

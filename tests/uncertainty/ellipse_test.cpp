#include "wellgyro/uncertainty/ellipse.h"

#include <cmath>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/math/rotation.h"

namespace wellgyro {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Tabulated: 95 % in one, two, three dimensions; two dimensions are sqrt(-2 ln(1 - p)).
TEST(Ellipse, ConfidenceFactors) {
  EXPECT_NEAR(ConfidenceFactor(0.95, 1), 1.959964, 1e-6);
  EXPECT_NEAR(ConfidenceFactor(0.95, 2), 2.447747, 1e-6);
  EXPECT_NEAR(ConfidenceFactor(0.95, 3), 2.795483, 1e-6);
  EXPECT_NEAR(ConfidenceFactor(0.6, 2), std::sqrt(-2 * std::log(0.4)), 1e-12);
  for (const double bad : {0.0, 1.0, -1.0, 2.0, std::nan("")})
    EXPECT_THROW(ConfidenceFactor(bad, 2), std::domain_error);
}

/// Axes of 5, 3 and 2 m at one sigma, turned.
Matrix3d Turned(const Matrix3d& r) { return r * Vector3d(25, 9, 4).asDiagonal() * r.transpose(); }

TEST(Ellipse, GivesBackAxesAndAzimuthInAllQuadrants) {
  const double k = ConfidenceFactor(0.9, 2);
  for (double azimuth = 0; azimuth < kPi; azimuth += 0.1) {
    for (const double whole : {0.0, kPi}) {
      const ErrorEllipse e = HorizontalEllipse(Turned(RotationZ(azimuth + whole)), 0.9);
      EXPECT_NEAR(e.semi_major, 5 * k, 1e-9);
      EXPECT_NEAR(e.semi_minor, 3 * k, 1e-9);
      EXPECT_NEAR(std::remainder(e.azimuth_major - azimuth, kPi), 0, 1e-9);
      EXPECT_GE(e.azimuth_major, 0);
      EXPECT_LT(e.azimuth_major, kPi);
    }
  }
  const ErrorEllipse line = HorizontalEllipse(Vector3d(1, 0, 0).asDiagonal(), 0.95);
  EXPECT_EQ(line.semi_minor, 0);
}

// The half width of e' E^-1 e <= 1 along n is sqrt(n' E n).
TEST(Ellipse, AboutASumHoldsEveryPairOfPointsAndTouchesWhereBothAreAlike) {
  Eigen::Matrix2d a, b;
  a << 9, 2, 2, 1;
  b << 0.5, -0.3, -0.3, 4;
  const Eigen::Matrix2d about = EllipseAboutSum(a, b), alike = EllipseAboutSum(a, 4 * a);
  for (double turn = 0; turn < kPi; turn += 0.05) {
    const Eigen::Vector2d n(std::cos(turn), std::sin(turn));
    const double of_a = std::sqrt(n.dot(a * n)), of_b = std::sqrt(n.dot(b * n));
    EXPECT_GE(std::sqrt(n.dot(about * n)), of_a + of_b);
    EXPECT_NEAR(std::sqrt(n.dot(alike * n)), 3 * of_a, 1e-12);
  }
  EXPECT_NEAR(std::sqrt(about.trace()), std::sqrt(10.0) + std::sqrt(4.5), 1e-12);
  EXPECT_EQ(EllipseAboutSum(a, Eigen::Matrix2d::Zero()), a);
  EXPECT_EQ(EllipseAboutSum(Eigen::Matrix2d::Zero(), b), b);
}

TEST(Ellipse, EllipsoidAndItsShadow) {
  const Matrix3d r = RotationZ(0.7) * RotationY(0.4) * RotationX(1.1);
  const Matrix3d cov = Turned(r);
  const ErrorEllipsoid e = Ellipsoid(cov, 0.95);
  EXPECT_NEAR(e.semi_axes(0), 5 * ConfidenceFactor(0.95, 3), 1e-9);
  EXPECT_NEAR(e.semi_axes(2), 2 * ConfidenceFactor(0.95, 3), 1e-9);
  EXPECT_NEAR(std::abs(e.axes.col(0).dot(r.col(0))), 1, 1e-12);
  EXPECT_NEAR(e.axes.determinant(), 1, 1e-12);
  // Along the longest axis the other two are seen.
  const SeenEllipse seen = EllipseSeenAlong(cov, r.col(0), 2);
  EXPECT_NEAR(seen.major.norm(), 6, 1e-9);
  EXPECT_NEAR(seen.minor.norm(), 4, 1e-9);
  EXPECT_NEAR(std::abs(seen.major.normalized().dot(r.col(1))), 1, 1e-12);
}

// High side, lateral and along are directions of the hole: a unit error along each comes out there.
TEST(Ellipse, HighSideFrame) {
  const double inclination = 0.8, azimuth = 2.5;
  const Matrix3d axes = AttitudeMatrix(azimuth, inclination, 0);  // columns: high, right, along
  for (int i = 0; i < 3; ++i) {
    Matrix3d expected = Matrix3d::Zero();
    expected(i, i) = 1;
    const Matrix3d cov = axes.col(i) * axes.col(i).transpose();
    EXPECT_LT((ToHighSide(cov, inclination, azimuth) - expected).norm(), 1e-14);
  }
}

TEST(Ellipse, AboutPointsIsTheLeastThatHoldsThemAll) {
  const std::vector<Eigen::Vector2d> points{{2, 0}, {0, 1}, {0.5, 0.5}, {-1, 0.2}};
  const Eigen::Matrix2d ellipse = EllipseAbout(points);
  EXPECT_NEAR(ellipse(0, 0), 4, 0.02);
  EXPECT_NEAR(ellipse(1, 1), 1, 0.02);
  EXPECT_NEAR(ellipse(0, 1), 0, 0.02);
  // One shift alone has an ellipse without width.
  const Eigen::Matrix2d line = EllipseAbout(std::vector<Eigen::Vector2d>{{3, 4}});
  EXPECT_NEAR(line.trace(), 25, 0.01);
  EXPECT_LT(line.determinant(), 0.01);
  EXPECT_TRUE(EllipseAbout({}).isZero());
}

}  // namespace
}  // namespace wellgyro

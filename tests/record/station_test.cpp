// Angles and their covariance by a tangent's, against differences of the angles themselves.
#include "wellgyro/record/station.h"

#include <cmath>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/record/unknown_angle.h"

namespace wellgyro {
namespace {

Station StationOf(double inclination_deg, double azimuth_deg) {
  Station s;
  s.tangent_L = Tangent(FromDegrees(inclination_deg), FromDegrees(azimuth_deg));
  // Of 1e-4 and 2e-4 rad in two directions, its part along the tangent taken out.
  const Eigen::Vector3d a(1e-4, 2e-5, 3e-5), b(-3e-5, 2e-4, 1e-5);
  const Eigen::Matrix3d across =
      Eigen::Matrix3d::Identity() - s.tangent_L * s.tangent_L.transpose();
  s.cov_tangent_L = across * (a * a.transpose() + b * b.transpose()) * across;
  return s;
}

TEST(StationAngles, HaveTheCovarianceOfTheirDifferences) {
  for (const double inclination : {2.0, 45.0, 90.0, 130.0}) {
    Station s = StationOf(inclination, 310);
    DeriveAngles(1, s);
    EXPECT_NEAR(s.inclination, FromDegrees(inclination), 1e-15);
    EXPECT_NEAR(s.azimuth, FromDegrees(310), 1e-14);
    Eigen::Matrix<double, 2, 3> slope;
    for (int i = 0; i < 3; ++i) {
      constexpr double kStep = 1e-6;
      const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(i);
      const Eigen::Vector3d after = s.tangent_L + step, before = s.tangent_L - step;
      slope.col(i) << (InclinationOf(after) - InclinationOf(before)) / (2 * kStep),
          WrapPi(AzimuthOf(after) - AzimuthOf(before)) / (2 * kStep);
    }
    const Eigen::Matrix2d cov = slope * s.cov_tangent_L * slope.transpose();
    EXPECT_LT((s.cov_md_inc_azi.bottomRightCorner<2, 2>() - cov).norm(), 1e-8 * cov.norm())
        << inclination;
  }
}

TEST(StationAngles, GoThereAndBack) {
  for (const double inclination : {0.01, 3.0, 90.0, 179.0}) {
    Station s = StationOf(inclination, 40);
    DeriveAngles(0, s);
    Station back = s;
    DeriveTangent(back);
    EXPECT_LT((back.tangent_L - s.tangent_L).norm(), 4e-16) << inclination;
    ASSERT_LT(s.cov_md_inc_azi(2, 2), kUnknownAngleVariance) << "a bound would not come back";
    EXPECT_LT((back.cov_tangent_L - s.cov_tangent_L).norm(), 1e-12 * s.cov_tangent_L.norm())
        << inclination;
  }
}

TEST(StationAngles, AtVerticalAnAzimuthIsTheToolsAndNotKnown) {
  Station s = StationOf(0, 0);
  DeriveAngles(FromDegrees(200), s);
  EXPECT_EQ(s.inclination, 0);
  EXPECT_EQ(s.azimuth, FromDegrees(200));
  EXPECT_EQ(s.cov_md_inc_azi(2, 2), kUnknownAngleVariance);
  EXPECT_EQ(s.cov_md_inc_azi(1, 2), 0);
  EXPECT_GT(s.cov_md_inc_azi(1, 1), 0);
  // A lean of a tenth of its sigma has no azimuth either.
  s = StationOf(1e-3, 90);
  DeriveAngles(0, s);
  EXPECT_NEAR(s.azimuth, FromDegrees(90), 1e-10);
  EXPECT_EQ(s.cov_md_inc_azi(2, 2), kUnknownAngleVariance);
}

}  // namespace
}  // namespace wellgyro

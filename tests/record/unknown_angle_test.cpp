#include "wellgyro/record/unknown_angle.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Core>
#include <gtest/gtest.h>

namespace wellgyro {
namespace {

// Of (inclination, azimuth, toolface) with these sigmas and correlations.
Eigen::Matrix3d Covariance(const Eigen::Vector3d& sigma, const Eigen::Matrix3d& correlation) {
  return sigma.asDiagonal() * correlation * sigma.asDiagonal();
}

Eigen::Matrix3d Correlation() {
  Eigen::Matrix3d r;
  r << 1, 0.3, -0.2, 0.3, 1, -0.9, -0.2, -0.9, 1;
  return r;
}

TEST(UnknownAngle, IsAFlatDistributionRoundTheCircle) {
  const int n = 1000000;
  double sum = 0;
  for (int i = 0; i < n; ++i) sum += std::pow(kPi * (2 * (i + 0.5) / n - 1), 2) / n;
  EXPECT_NEAR(kUnknownAngleVariance, sum, 1e-10);
}

TEST(UnknownAngle, LeavesWhatIsKnownAsItWas) {
  const Eigen::Matrix3d known = Covariance({3.0, 1.8, 1.7}, Correlation());
  Eigen::Matrix3d capped = known;
  CapAtUnknown(&capped);
  EXPECT_EQ(capped, known);
}

TEST(UnknownAngle, CapsAzimuthAndToolfaceAndKeepsCorrelations) {
  const double most = std::sqrt(kUnknownAngleVariance);
  for (const Eigen::Vector3d& sigma :
       {Eigen::Vector3d(3, 1e3, 0.5), Eigen::Vector3d(3, 0.5, 2), Eigen::Vector3d(3, 1e3, 1e4)}) {
    Eigen::Matrix3d cov = Covariance(sigma, Correlation());
    CapAtUnknown(&cov);
    const Eigen::Vector3d held(sigma[0], std::min(sigma[1], most), std::min(sigma[2], most));
    EXPECT_TRUE(cov.isApprox(Covariance(held, Correlation()), 1e-14)) << cov;
  }
}

}  // namespace
}  // namespace wellgyro

#include "wellgyro/alignment/rest_needed.h"

#include <cmath>
#include <complex>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/alignment/gyrocompass.h"
#include "wellgyro/base/units.h"

namespace wellgyro {
namespace {

using units::kDeg;

/// Two transverse axes at rest without error, toolface 0: We (cL cA cI + sL sI) - i We cL sA.
StillWindow Rest(double latitude, double inclination, double azimuth, double seconds, double walk) {
  constexpr double kEarthRate = 7.292115e-5;
  const double sI = std::sin(inclination), cI = std::cos(inclination);
  const double g = SiteAt(latitude, 0).gravity;
  StillWindow window;
  window.end = {Duration::Seconds(seconds).ns};
  window.samples = 100;
  window.w_IT_T = {
      kEarthRate * (std::cos(latitude) * std::cos(azimuth) * cI + std::sin(latitude) * sI),
      -kEarthRate * std::cos(latitude) * std::sin(azimuth), 0};
  window.f_T = {g * sI, 0, -g * cI};
  window.sigma_w_IT_T = Eigen::Vector3d::Constant(walk / std::sqrt(seconds));
  window.sigma_f_T = Eigen::Vector3d::Constant(1e-7);
  return window;
}

TEST(RestNeeded, AfterItAGyrocompassHasTheSigmaAsked) {
  const NoiseCoefficients gyro{.angle_random_walk = 0.01 * kDeg / 60};
  for (const double latitude : {-60.0, 0.0, 58.0}) {
    for (const double inclination : {10.0, 45.0, 80.0}) {
      for (const double azimuth : {0.0, 40.0, 300.0}) {
        for (const double sigma : {0.1, 0.4}) {
          const auto t =
              RestForSigma(sigma * kDeg, gyro, latitude * kDeg, inclination * kDeg, azimuth * kDeg);
          ASSERT_TRUE(t);
          const std::vector<StillWindow> windows = {Rest(
              latitude * kDeg, inclination * kDeg, azimuth * kDeg, *t, gyro.angle_random_walk)};
          const NorthFix fix =
              Gyrocompass(windows, SiteAt(latitude * kDeg, 0), {.sigma_gravity_ref = 1e-7});
          EXPECT_NEAR(std::sqrt(fix.cov_attitude(1, 1)) / kDeg, sigma, 0.02 * sigma)
              << latitude << ' ' << inclination << ' ' << azimuth;
        }
      }
    }
  }
}

TEST(RestNeeded, IsNotThereWhereNoRestIsLongEnough) {
  const NoiseCoefficients gyro{.angle_random_walk = 0.01 * kDeg / 60};
  EXPECT_FALSE(RestForSigma(0.1 * kDeg, gyro, 90 * kDeg, 30 * kDeg, 0));
  EXPECT_FALSE(RestForSigma(0.1 * kDeg, gyro, 60 * kDeg, 90 * kDeg, 90 * kDeg));
  EXPECT_FALSE(RestForSigma(0, gyro, 60 * kDeg, 30 * kDeg, 0));
}

}  // namespace
}  // namespace wellgyro

#include "wellgyro/earth/earth.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"

namespace wellgyro {
namespace {

// NIMA TR 8350.2 (2000), tables 3.1, 3.3 and 3.4.
constexpr double kA = 6378137;
constexpr double kF = 1 / 298.257223563;
constexpr double kE2 = 6.69437999014e-3;
constexpr double kGm = 3986004.418e8;
constexpr double kGravityEquator = 9.7803253359;
constexpr double kGravityPole = 9.8321849378;

TEST(SiteAt, GravityAtSeaLevelIsThePublishedOne) {
  EXPECT_NEAR(SiteAt(0, 0).gravity, kGravityEquator, 1e-9);
  EXPECT_NEAR(SiteAt(kPi / 2, 0).gravity, kGravityPole, 1e-9);
  EXPECT_NEAR(SiteAt(-kPi / 2, 0).gravity, kGravityPole, 1e-9);
  // Somigliana's closed formula with k from the published figures.
  const double k = kA * (1 - kF) * kGravityPole / (kA * kGravityEquator) - 1;
  for (const double latitude_deg : {-60.0, 15.0, 45.0, 58.3}) {
    const double s2 = std::pow(std::sin(FromDegrees(latitude_deg)), 2);
    const double expected = kGravityEquator * (1 + k * s2) / std::sqrt(1 - kE2 * s2);
    EXPECT_NEAR(SiteAt(FromDegrees(latitude_deg), 0).gravity, expected, 1e-9);
  }
}

// TR 8350.2 eq. 4-3: normal gravity above the ellipsoid to second order in height.
TEST(SiteAt, GravityFallsWithHeight) {
  const double m = kEarthRate * kEarthRate * kA * kA * kA * (1 - kF) / kGm;
  for (const double latitude_deg : {0.0, 30.0, -62.0}) {
    const double s2 = std::pow(std::sin(FromDegrees(latitude_deg)), 2);
    const double ground = SiteAt(FromDegrees(latitude_deg), 0).gravity;
    for (const double height : {100.0, 2000.0, 4000.0}) {
      const double factor =
          1 - 2 * height / kA * (1 + kF + m - 2 * kF * s2) + 3 * height * height / (kA * kA);
      // The formula leaves out f^2, f m and m^2 in the gradient: 4e-5 of 3.1e-6 per metre.
      EXPECT_NEAR(SiteAt(FromDegrees(latitude_deg), height).gravity, ground * factor,
                  1.2e-10 * height);
    }
  }
}

TEST(SiteAt, GravityGrowsInsideTheRock) {
  const double ground = SiteAt(FromDegrees(60), 0).gravity;
  const double deep = SiteAt(FromDegrees(60), -3000).gravity;
  // Poisson-Prey: free-air gradient less twice a Bouguer plate, with G = 6.6743e-11 (CODATA).
  const double gradient = 3.086e-6 - 4 * kPi * 6.6743e-11 * 2670;
  EXPECT_NEAR(deep - ground, 3000 * gradient, 3000 * 0.01e-6);
  EXPECT_GT(deep, ground + 2e-3);
}

TEST(SiteAt, RadiiAreThoseOfTheEllipse) {
  EXPECT_NEAR(SiteAt(0, 0).radius_east, kA, 1e-6);
  EXPECT_NEAR(SiteAt(0, 0).radius_north, kA * (1 - kE2), 1e-3);
  // At the pole both are the published polar radius of curvature.
  EXPECT_NEAR(SiteAt(kPi / 2, 0).radius_east, 6399593.6258, 1e-3);
  EXPECT_NEAR(SiteAt(kPi / 2, 0).radius_north, 6399593.6258, 1e-3);
  EXPECT_NEAR(SiteAt(0.3, -2500).radius_north, SiteAt(0.3, 0).radius_north - 2500, 1e-6);
}

// The meridian as a plane curve: ds/dlatitude by central differences of its coordinates.
TEST(SiteAt, MeridianRadiusIsArcPerAngle) {
  const double b = kA * (1 - kF);
  const auto x = [&](double latitude) {
    const double reduced = std::atan(b / kA * std::tan(latitude));
    return std::pair{kA * std::cos(reduced), b * std::sin(reduced)};
  };
  for (const double latitude : {0.2, 0.9, 1.3}) {
    const double h = 1e-4;
    const auto [x1, z1] = x(latitude - h);
    const auto [x2, z2] = x(latitude + h);
    EXPECT_NEAR(SiteAt(latitude, 0).radius_north / (std::hypot(x2 - x1, z2 - z1) / (2 * h)), 1,
                1e-8);
    EXPECT_NEAR(SiteAt(latitude, 0).radius_east / (x(latitude).first / std::cos(latitude)), 1,
                1e-12);
  }
}

TEST(SiteAt, RefusesWhatIsNoPlace) {
  EXPECT_THROW((void)SiteAt(1.6, 0), std::domain_error);
  EXPECT_THROW((void)SiteAt(std::numeric_limits<double>::quiet_NaN(), 0), std::domain_error);
  EXPECT_THROW((void)SiteAt(0, std::numeric_limits<double>::infinity()), std::domain_error);
}

}  // namespace
}  // namespace wellgyro

#include "wellgyro/simulate/ellipsoid.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/earth/earth.h"

namespace wellgyro {
namespace {

// NIMA TR8350.2 (2000), tables 3.3 and 3.4.
TEST(Ellipsoid, HasThePublishedFigures) {
  const EllipsoidPlace equator = EllipsoidAt(0, 0), pole = EllipsoidAt(1, 0);
  EXPECT_NEAR(equator.gravity, 9.7803253359, 5e-11);
  EXPECT_NEAR(pole.gravity, 9.8321849378, 5e-10);
  EXPECT_NEAR(equator.radius_east, 6378137.0, 1e-8);
  EXPECT_NEAR(pole.radius_north, 6399593.6258, 5e-5);
  EXPECT_NEAR(pole.radius_east, 6399593.6258, 5e-5);
  // b^2 / a with b = 6356752.3142.
  EXPECT_NEAR(equator.radius_north, 6356752.3142 * 6356752.3142 / 6378137.0, 2e-4);
}

// The estimators take theirs from GeographicLib's closed form of normal gravity.
TEST(Ellipsoid, AgreesWithTheEstimatorsEarth) {
  for (double latitude = -85; latitude <= 85; latitude += 17) {
    for (const double height : {-6000.0, -0.5, 0.0, 0.5, 900.0, 3000.0}) {
      const Site site = SiteAt(FromDegrees(latitude), height);
      const EllipsoidPlace place = EllipsoidAt(std::sin(FromDegrees(latitude)), height);
      EXPECT_NEAR(place.gravity, site.gravity, 1e-9 + 1.1e-10 * std::max(height, 0.0))
          << latitude << " " << height;
      EXPECT_NEAR(place.radius_north, site.radius_north, 1e-8);
      EXPECT_NEAR(place.radius_east, site.radius_east, 1e-8);
    }
  }
}

}  // namespace
}  // namespace wellgyro

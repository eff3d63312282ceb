#include <cmath>

#include <Eigen/QR>
#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/math/random.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/survey/stations/pass_covariance_internal.h"

namespace wellgyro {
namespace {

constexpr double kHoleLength = 1000, kHoleAzimuth = 0.7, kHoleInclination = 0.5;

// Variance along its way of the end of a straight hole [m^2].
double VarianceAlong(double sigma_azimuth) {
  PassItems pass;
  for (double md = 100; md <= kHoleLength; md += 100) {
    PassItem& item = pass.emplace_back();
    item.station.md = md;
    item.station.inclination = kHoleInclination;
    item.station.azimuth = kHoleAzimuth;
    item.station.cov_md_inc_azi(2, 2) = sigma_azimuth * sigma_azimuth;
  }
  PathStart start;
  start.point.station.md = 0;
  const Eigen::Vector3d along(std::cos(kHoleAzimuth), std::sin(kHoleAzimuth), 0);
  return along.dot(PassCovariancesOf({}, pass, start).covs_of_sensors_W.back() * along);
}

// Surveyed in one wrong direction, as drawn, its end falls short of its way.
TEST(PassCovariance, AnAzimuthFarOffFallsShortOfItsWay) {
  for (const double sigma_deg : {1., 5., 20., 60.}) {
    const double sigma = FromDegrees(sigma_deg);
    Random random(7);
    constexpr int kDraws = 200000;
    double square = 0;
    for (int i = 0; i < kDraws; ++i) {
      square += std::pow(1 - std::cos(sigma * random.Normal()), 2) / kDraws;
    }
    const double expected = square * std::pow(kHoleLength * std::sin(kHoleInclination), 2);
    EXPECT_NEAR(VarianceAlong(sigma) - VarianceAlong(0), expected, 0.03 * expected)
        << sigma_deg << " deg";
  }
}

// One error e of all depths moves where the tool was by e top, and the hole at that measured depth
// by e (top - tangent): neither has more than its one share in the covariance, and along a straight
// hole both are one.
TEST(PassCovariance, ACommonDepthErrorCountsOnce) {
  const Eigen::Vector3d top(0.1, 0, std::sqrt(0.99));
  for (const double inclination : {0.2, 0.8, 1.2, 1.6, 2.0}) {
    const Eigen::Vector3d tangent = Tangent(inclination, 0.3);
    const Eigen::Matrix3d cov = ByCommonDepth(top, tangent);
    // Of the plane of both, to which the covariance belongs.
    const Eigen::Matrix3d inverse = cov.completeOrthogonalDecomposition().pseudoInverse();
    for (const Eigen::Vector3d& error : {top, Eigen::Vector3d(top - tangent)}) {
      EXPECT_NEAR(error.dot(inverse * error), 1, 1e-9) << inclination;
    }
  }
  EXPECT_LT((ByCommonDepth(top, top) - top * top.transpose()).norm(), 1e-12);
}

}  // namespace
}  // namespace wellgyro

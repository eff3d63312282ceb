#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "wellgyro/alignment/gyrocompass.h"
#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/math/random.h"

#include "alignment/tool_at_rest.h"

namespace wellgyro {
namespace {

using test::Draw;
using test::ExpectInBand;
using test::Normalised;
using test::Sigma;
using test::ToolAtRest;
using units::kDeg;
using units::kDegPerHour;

TEST(Gyrocompass, NearVerticalTheAccelerometersOutweighTheGyros) {
  Random random(7);
  const ToolAtRest truth{.inclination = 1 * kDeg, .gyro_noise = 0.01 * kDegPerHour};
  const ErrorPriors errors{.accel_bias_sigma = 1e-4 * 9.81};
  const NorthFix fix = Gyrocompass(truth.Windows({1.2}, random), truth.Place(), {.errors = errors});
  // 0.1 mg at 1 degree: 1e-4 / sin(1 deg) = 0.328 deg, the gyros 0.076 deg.
  EXPECT_NEAR(ToDegrees(Sigma(fix)), 0.33, 0.02);
  EXPECT_FALSE(Has(fix.quality, Quality::kVertical));
}

// Near vertical an accelerometer that leans reads as much across as one with a bias; one that leans
// against the other turns the toolface too.
TEST(Gyrocompass, AccelerometersThatLeanCountNearVertical) {
  const ErrorPriors errors{
      .accel_bias_sigma = 5e-4, .accel_scale_sigma = 5e-5, .accel_misalignment_sigma = 1e-4};
  Random random(31);
  for (const double inclination : {0.1, 2.0}) {
    double sum = 0, tilt = 0;
    constexpr int kDraws = 400;
    for (int i = 0; i < kDraws; ++i) {
      const ToolAtRest truth{.inclination = inclination * kDeg,
                             .azimuth = kTwoPi * random.Uniform(),
                             .gyro_noise = 0.02 * kDegPerHour,
                             .accel_noise = 1e-5};
      const NorthFix fix = Draw(truth, errors, {0.7}, random);
      tilt += std::pow(fix.inclination - truth.inclination, 2) / fix.cov_attitude(0, 0);
      sum += Normalised(fix, truth, 0.7);
      // 5e-4 of 9.82 m/s^2 and 1e-4 rad.
      EXPECT_NEAR(std::sqrt(fix.cov_attitude(0, 0)), 1.122e-4, 4e-6);
    }
    ExpectInBand(tilt, kDraws, 1, "inclination");
    ExpectInBand(sum, kDraws, 3, "all angles");
  }
}

// At the vertical azimuth and toolface are not defined, their sum is.
TEST(Gyrocompass, VerticalKeepsTheSumOfAzimuthAndToolface) {
  const ErrorPriors errors{.accel_bias_sigma = 5e-4};
  for (const double inclination : {0.0, 0.001, 179.999}) {
    Random random(8);
    double sum = 0, azimuth = 0;
    int vertical = 0;
    constexpr int kDraws = 300;
    for (int i = 0; i < kDraws; ++i) {
      const ToolAtRest truth{.inclination = inclination * kDeg,
                             .azimuth = 1.1,
                             .gyro_noise = 0.02 * kDegPerHour,
                             .accel_noise = 1e-5};
      const NorthFix fix = Draw(truth, errors, {0.7}, random);
      vertical += Has(fix.quality, Quality::kVertical) ? 1 : 0;
      azimuth += fix.cov_attitude(1, 1) / kDraws;
      EXPECT_LE(fix.cov_attitude(1, 1), kPi * kPi / 3 + 1e-12);
      const double sign = inclination < 90 ? 1 : -1;
      const double variance =
          fix.cov_attitude(1, 1) + fix.cov_attitude(2, 2) + 2 * sign * fix.cov_attitude(1, 2);
      EXPECT_NEAR(std::sqrt(variance), 0.02 / 7.52, 0.0005);
      const double error = WrapPi(fix.azimuth + sign * fix.toolface - (1.1 + sign * 0.7));
      sum += error * error / variance;
    }
    ExpectInBand(sum, kDraws, 1, "azimuth + toolface");
    EXPECT_GT(vertical, 0.97 * kDraws);  // all but 1.1 % of tilts are within 3 sigma
    EXPECT_GT(azimuth, 2);               // of pi^2/3
  }
}

// At 80 degrees heading north-east the two axes hardly tell A from 180 deg - A.
TEST(Gyrocompass, TheMirrorIsKeptWhileTheDataDoNotExcludeIt) {
  Random random(9);
  ToolAtRest truth{
      .inclination = 89 * kDeg, .azimuth = 60 * kDeg, .gyro_noise = 0.05 * kDegPerHour};
  const NorthFix fix = Gyrocompass(truth.Windows({0.3}, random), truth.Place(), {});
  ASSERT_TRUE(fix.mirror_azimuth.has_value());
  EXPECT_TRUE(Has(fix.quality, Quality::kMirror));
  EXPECT_NEAR(WrapPi(fix.azimuth + *fix.mirror_azimuth - kPi), 0, 0.02);
  EXPECT_GE(fix.mirror_cost, 0);
  EXPECT_LT(fix.mirror_cost, 9);
  truth.gz = true;  // the third axis tells
  const NorthFix clear = Gyrocompass(truth.Windows({0.3}, random), truth.Place(), {});
  EXPECT_FALSE(clear.mirror_azimuth.has_value());
  EXPECT_NEAR(WrapPi(clear.azimuth - truth.azimuth), 0, 5 * Sigma(clear));
}

// East and horizontal: the cost is a quartic, the posterior some degrees wide. Exactly there the
// estimate is far better than it can know; over the azimuths about, it is as good as it says.
TEST(Gyrocompass, EastAndHorizontalIsSaidByTheCovariance) {
  Random random(10);
  for (const bool exact : {true, false}) {
    double sum = 0;
    constexpr int kDraws = 500;
    for (int i = 0; i < kDraws; ++i) {
      const ToolAtRest truth{.inclination = 90 * kDeg,
                             .azimuth = (exact ? 90 : 82 + 16 * random.Uniform()) * kDeg,
                             .gyro_noise = 0.02 * kDegPerHour};
      const NorthFix fix = Gyrocompass(truth.Windows({0.3}, random), truth.Place(), {});
      EXPECT_GT(ToDegrees(Sigma(fix)), 0.8);
      EXPECT_LT(ToDegrees(Sigma(fix)), 13);
      double error = std::abs(WrapPi(fix.azimuth - truth.azimuth));
      if (fix.mirror_azimuth) {
        error = std::min(error, std::abs(WrapPi(*fix.mirror_azimuth - truth.azimuth)));
      }
      sum += std::pow(error / Sigma(fix), 2);
    }
    EXPECT_LT(sum / kDraws, 1.2);
    if (!exact) {
      EXPECT_GT(sum / kDraws, 0.2);
    }
  }
}

// Azimuth and mirror between which the cost hardly rises are one candidate, whose sigma covers
// both: over all azimuths from which that comes, errors and sigma agree.
TEST(Gyrocompass, MirrorsThatHaveRunIntoOneAreOneCandidate) {
  const ErrorPriors errors{.gyro_bias_sigma = 0.1 * kDegPerHour};
  Random random(14);
  double sum = 0;
  int one = 0;
  for (int i = 0; i < 1000; ++i) {
    const ToolAtRest truth{.latitude = 60 * kDeg,
                           .inclination = 90 * kDeg,
                           .azimuth = (50 + 80 * random.Uniform()) * kDeg,
                           .gyro_noise = 0.02 * kDegPerHour};
    const NorthFix fix = Draw(truth, errors, {0.3}, random);
    if (fix.mirror_azimuth) {
      EXPECT_GT(std::abs(WrapPi(*fix.mirror_azimuth - fix.azimuth)), 5 * Sigma(fix));
      continue;
    }
    ++one;
    EXPECT_NEAR(fix.azimuth, 90 * kDeg, 0.1 * kDeg);
    sum += std::pow(WrapPi(fix.azimuth - truth.azimuth) / Sigma(fix), 2);
  }
  EXPECT_GT(one, 200);
  ExpectInBand(sum, one, 1, "one candidate");
}

// At the pole nothing tells north; the covariance is that of not knowing.
TEST(Gyrocompass, AtThePoleNorthIsUnknown) {
  Random random(15);
  const ToolAtRest truth{
      .latitude = 90 * kDeg, .gyro_noise = 0.02 * kDegPerHour, .accel_noise = 1e-4};
  const NorthFix fix = Gyrocompass(truth.Windows({0.3}, random), truth.Place(), {});
  EXPECT_NEAR(fix.cov_attitude(1, 1), kPi * kPi / 3, 0.1);
}

}  // namespace
}  // namespace wellgyro

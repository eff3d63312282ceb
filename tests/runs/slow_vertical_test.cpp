// Slow runs near vertical at the equator, where the Earth's rate turns an error of azimuth into a
// greater one within minutes, and only the growth of the inclination holds it.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/math/statistics.h"
#include "wellgyro/simulate/simulator.h"
#include "wellgyro/simulate/tool_errors.h"

#include "support/claims.h"
#include "support/hour.h"

namespace wellgyro {
namespace {

ErrorPriors Priors() {
  ErrorPriors p;
  p.gyro_bias_sigma = 0.1 * units::kDegPerHour;
  p.mass_unbalance_sigma = p.quadrature_sigma = 0.02 * units::kDegPerHourPerG;
  p.gyro_scale_sigma = p.gyro_misalignment_sigma = 1e-4;
  p.accel_bias_sigma = 5e-4;
  p.accel_noise = 2e-4;
  p.roll_offset_sigma = FromDegrees(0.02);
  return p;
}

NoiseCoefficients Noise() {
  NoiseCoefficients n;
  n.angle_random_walk = 0.005 * units::kDegPerSqrtHour;
  n.rate_random_walk = 0.01 * units::kDegPerHourSqrtHour;
  return n;
}

testing::Hour Tool() {
  testing::Hour tool;
  tool.latitude_deg = 0;
  tool.noise = Noise();
  tool.errors = Priors();
  return tool;
}

/// From 0.82 deg past 0.13 deg to 1.2 deg in an hour, its azimuth turning by half a circle.
Simulation SlowWell(double rpm, std::uint64_t seed) {
  Simulation s;
  s.well.stations = {{0, FromDegrees(0.82), FromDegrees(238)},
                     {350, FromDegrees(0.675), FromDegrees(79)},
                     {700, FromDegrees(1.2), FromDegrees(272.7)}};
  s.earth.latitude = 0;
  const RunRoll roll{rpm * kTwoPi / 60, 0, 15, 0};
  s.run.steps = {RunStop{.seconds = 180}, RunMove{.to_md = 350, .speed = 0.2, .roll = roll},
                 RunStop{.seconds = 20}, RunMove{.to_md = 700, .speed = 0.2, .roll = roll},
                 RunStop{.seconds = 180}};
  s.streams.imu_hz = 10;
  s.seed = seed;
  testing::DrawErrors(Priors(), Noise(), seed, s);
  return s;
}

testing::Flown FlyOf(const Simulation& simulation) {
  return testing::Fly(simulation, testing::JobOf(Tool()));
}

class SlowNearVertical : public ::testing::TestWithParam<double> {};

TEST_P(SlowNearVertical, KeepsItsAzimuthByTheMotion) {
  constexpr int kSeeds = WELLGYRO_LONG ? 6 : 2;
  const std::vector<double> depths = {100, 200, 300, 400, 500, 600};
  testing::Claims inclination[2], azimuth[2];
  double worst = 0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Simulation simulation = SlowWell(GetParam(), seed);
    const testing::Flown flown = FlyOf(simulation);
    const RunHistory& history = flown.history;
    const SmoothedRun estimated = EstimateOf(flown), known = testing::KnownOnTheWay(history);
    EXPECT_TRUE(estimated.fit->converged) << seed;
    std::size_t next = 0;
    for (std::size_t i = 0; i < history.knots.size() && next < depths.size(); ++i) {
      if (history.knots[i].along.md < depths[next]) continue;
      ++next;
      const TruthState t = flown.truth[i];
      for (const int by : {0, 1}) {
        const AttitudeSample& a = (by == 0 ? known : estimated).attitude[i];
        ASSERT_TRUE(a.azimuth_known) << seed << " at " << depths[next - 1];
        const double turned = WrapPi(a.azimuth - t.azimuth);
        inclination[by].Add(a.inclination - t.inclination, a.cov_attitude(0, 0));
        azimuth[by].Add(turned, a.cov_attitude(1, 1));
        worst = std::max(worst, std::abs(turned));
      }
    }
  }
  // Six depths of one run share their errors: as many degrees of freedom as runs.
  const double high = 6 * ChiSquareQuantile(0.9999, kSeeds);
  for (const int by : {0, 1}) {
    std::printf("%s: inclination %.2f of %.4f deg, azimuth %.2f of %.2f deg\n",
                by == 0 ? "on the way" : "estimated", inclination[by].mean(),
                inclination[by].sigma_deg(), azimuth[by].mean(), azimuth[by].sigma_deg());
    EXPECT_EQ(azimuth[by].count, 6 * kSeeds);
    EXPECT_LT(azimuth[by].normalised, high);
    EXPECT_GT(azimuth[by].normalised, 6 * ChiSquareQuantile(0.0001, kSeeds));
    EXPECT_LT(azimuth[by].sigma_deg(), 1.5);
  }
  EXPECT_LT(inclination[1].normalised, high);
  EXPECT_LT(ToDegrees(worst), 8);
}

INSTANTIATE_TEST_SUITE_P(Rolls, SlowNearVertical, ::testing::Values(0.3, 3.0));

}  // namespace
}  // namespace wellgyro

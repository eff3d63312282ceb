// Slow runs near vertical at the equator, where the Earth's rate turns an error of azimuth into a
// greater one within minutes, and only the growth of the inclination holds it.
#include <algorithm>
#include <cmath>
#include <complex>
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
#include "wellgyro/record/knot.h"
#include "wellgyro/record/knot_sources.h"
#include "wellgyro/simulate/simulator.h"
#include "wellgyro/simulate/tool_errors.h"

#include "support/claims.h"
#include "support/hour.h"

namespace wellgyro {
namespace {

constexpr double kEarth = 7.292115e-5;  // [rad/s]

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
  s.tool.errors = DrawToolErrors(Priors(), Noise(), seed);
  return s;
}

testing::Flown FlyOf(const Simulation& simulation) {
  return testing::Fly(simulation, testing::JobOf(Tool()));
}

Knot::SourceVector SourcesOf(const ToolErrors& e) {
  Knot::SourceVector sources = Knot::SourceVector::Zero();
  sources.head<8>() << e.gyro_bias[0], e.gyro_bias[1], e.mass_unbalance, e.quadrature,
      e.gyro_scale[0], e.gyro_scale[1], e.gyro_misalignment[0], e.gyro_misalignment[1];
  sources[Knot::kToolfaceOffset] = e.roll_offset;
  sources.tail<3>() = e.accel_bias;
  return sources;
}

double SecondsOf(const Knot& knot) { return (knot.time - ToolTime{}).seconds(); }

class SlowNearVertical : public ::testing::TestWithParam<double> {};

// At the equator the hole's inclination grows by the gyros and the Earth's rate along the azimuth.
TEST_P(SlowNearVertical, LiftsAreThoseOfTheHole) {
  const Simulation simulation = SlowWell(GetParam(), 5);
  const FilterHistory history = FlyOf(simulation).history;
  const Knot::SourceVector errors = SourcesOf(simulation.tool.errors);
  const Truth truth(simulation);
  const double g = history.setup.site.gravity;
  double lifts = 0, levels = 0, sum = 0, var_sum = 0;
  int count = 0;
  for (std::size_t i = 1; i < history.epochs.size(); ++i) {
    const Knot& k = history.epochs[i].knot;
    if (!k.lifts || k.still) continue;
    const TruthState a = truth.At(SecondsOf(k) - k.seconds), b = truth.At(SecondsOf(k));
    const double mean_azimuth = a.azimuth + WrapPi(b.azimuth - a.azimuth) / 2;
    const SecondOrderShare second = SecondOrderOf(k);
    const double lift = k.lift + kEarth * std::sin(mean_azimuth) * k.seconds -
                        k.d_lift.dot(errors) - errors.dot(second.lift * errors) -
                        (b.inclination - a.inclination);
    const double var = std::pow(Noise().angle_random_walk, 2) * k.seconds +
                       VarBeyondOf(k, Priors(), g, kEarth).lift;
    const std::complex<double> toward = k.rolled / k.seconds;
    const double level =
        k.inclination_accel - (a.inclination + b.inclination) / 2 -
        (toward.real() * errors[Knot::kAccelBiasX] - toward.imag() * errors[Knot::kAccelBiasY]) /
            g -
        errors.dot(SecondLevelOf(k) * errors) / k.seconds;
    lifts += lift * lift / var;
    levels += level * level / (std::pow(Priors().accel_noise / g, 2) / k.seconds);
    sum += lift;
    var_sum += var;
    ++count;
  }
  ASSERT_GT(count, 1000);
  std::printf("%d lifts: mean square %.2f, of all %.2f; levels %.2f\n", count, lifts / count,
              sum * sum / var_sum, levels / count);
  EXPECT_LT(lifts, ChiSquareQuantile(0.9999, count));
  EXPECT_GT(lifts, count / 4.0);  // errors that last are in each as if they were white
  EXPECT_LT(sum * sum, 11 * var_sum);
  EXPECT_LT(levels, 1.2 * ChiSquareQuantile(0.9999, count));
  EXPECT_GT(levels, ChiSquareQuantile(0.0001, count));
}

TEST_P(SlowNearVertical, KeepsItsAzimuthByTheMotion) {
  constexpr int kSeeds = 6;
  const std::vector<double> depths = {100, 200, 300, 400, 500, 600};
  testing::Claims inclination[2], azimuth[2];
  double worst = 0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Simulation simulation = SlowWell(GetParam(), seed);
    const testing::Flown flown = FlyOf(simulation);
    const FilterHistory& history = flown.history;
    const SmoothedRun estimated = EstimateOf(flown), smoothed = Smooth(history);
    EXPECT_TRUE(estimated.fit->converged) << seed;
    const Truth truth(simulation);
    std::size_t next = 0;
    for (std::size_t i = 0; i < history.epochs.size() && next < depths.size(); ++i) {
      if (history.epochs[i].knot.along.md < depths[next]) continue;
      ++next;
      const TruthState t = truth.At(SecondsOf(history.epochs[i].knot));
      for (const int by : {0, 1}) {
        const AttitudeSample& a = (by == 0 ? smoothed : estimated).attitude[i];
        ASSERT_TRUE(a.azimuth_known) << seed << " at " << depths[next - 1];
        const double turned = WrapPi(a.azimuth - t.azimuth);
        inclination[by].Add(a.inclination - t.inclination, a.cov_attitude(0, 0));
        azimuth[by].Add(turned, a.cov_attitude(1, 1));
        worst = std::max(worst, std::abs(turned));
      }
    }
  }
  // Six depths of one run share their errors: as many degrees of freedom as runs. What the smoother
  // tells of the inclination is its filter's, without what the whole run says of the tool's errors.
  const double high = 6 * ChiSquareQuantile(0.9999, kSeeds);
  for (const int by : {0, 1}) {
    std::printf("%s: inclination %.2f of %.4f deg, azimuth %.2f of %.2f deg\n",
                by == 0 ? "smoothed" : "estimated", inclination[by].mean(),
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

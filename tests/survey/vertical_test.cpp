// Holes that are vertical, nearly so, or begin so: errors against their covariance.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>

#include <Eigen/Core>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/math/random.h"
#include "wellgyro/math/square.h"
#include "wellgyro/math/statistics.h"
#include "wellgyro/record/force_errors.h"
#include "wellgyro/simulate/tool_errors.h"
#include "wellgyro/simulate/truth.h"
#include "wellgyro/survey/hole/node_attitude.h"

#include "support/simulated_survey.h"

namespace wellgyro {
namespace {

using testing::CollectingSink;
using testing::SurveyOf;

constexpr double kStopMd = 150, kEndMd = 300;

struct VerticalCase {
  std::string name;
  double inclination_deg, build_from, rpm;
};

Simulation SimulationOf(const VerticalCase& c) {
  Simulation s;
  s.well.begin_md = 0;
  s.well.end_md = kEndMd + 40;
  s.well.inclination.start = FromDegrees(c.inclination_deg);
  s.well.azimuth.start = FromDegrees(40);
  if (c.build_from > 0) {
    s.well.inclination.terms.push_back(
        {.begin_md = c.build_from, .ramp = 30, .rate = FromDegrees(4) / 30});
  }
  s.earth.latitude = FromDegrees(60);
  s.streams.imu_hz = 10;
  s.run.roll_reference = RollReference::kNorth;
  RunMove move;
  move.to_md = kStopMd;
  move.speed = 0.5;
  move.roll.rate = c.rpm * kTwoPi / 60;
  RunMove on = move;
  on.to_md = kEndMd;
  s.run.steps = {RunStop{.seconds = 180}, move, RunStop{.seconds = 180}, on, RunStop{.seconds = 5}};
  return s;
}

/// The horizontal part of the hole's direction.
Eigen::Vector2d LeanOf(double inclination, double azimuth) {
  return std::sin(inclination) * Eigen::Vector2d(std::cos(azimuth), std::sin(azimuth));
}

class NearVertical : public ::testing::TestWithParam<VerticalCase> {};

TEST_P(NearVertical, ErrorsAreWhatTheirCovarianceSays) {
  Simulation simulation = SimulationOf(GetParam());
  constexpr int kSeeds = 2;  // of a hundred in runs.long
  Job job;
  job.well.latitude = simulation.earth.latitude;
  job.noise.angle_random_walk = 0.01 * units::kDegPerSqrtHour;
  job.errors.gyro_bias_sigma = 0.1 * units::kDegPerHour;
  job.errors.accel_bias_sigma = 0.1 * units::kMilliG;
  job.errors.accel_noise = 0.05 * units::kMilliG;
  job.errors.depth_sigma = 0.01;
  // Of horizontal position at four depths, of azimuth where the hole leans enough to have one.
  // Of the tilt: in either direction where the hole is vertical, else of the inclination.
  double position = 0, azimuth = 0, tilt = 0;
  int azimuths = 0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    simulation.seed = static_cast<std::uint64_t>(seed);
    simulation.tool.errors = DrawToolErrors(job.errors, job.noise, simulation.seed);
    CollectingSink sink;
    const Survey survey = SurveyOf(simulation, job, sink);
    ASSERT_EQ(survey.unusable, "");
    const Truth truth(simulation);
    for (const Station& station : survey.chosen) {
      const bool last = std::abs(station.md - 280) < 1e-6;
      if (!last) continue;
      const WellPoint point = truth.well().PointAt(station.md);
      const Eigen::Vector2d off =
          (station.p_WT_W - truth.well().PlaceAt(station.md).p_WT_W).head<2>();
      const Eigen::Matrix2d cov = station.cov_p_WT_W.topLeftCorner<2, 2>();
      position += off.dot(cov.inverse() * off);
      const Eigen::Vector2d lean =
          LeanOf(station.inclination, station.azimuth) - LeanOf(point.inclination, point.azimuth);
      const double wrong = point.inclination > FromDegrees(0.9)
                               ? station.inclination - point.inclination
                               : lean.norm();
      tilt += wrong * wrong / station.cov_md_inc_azi(1, 1);
      if (point.inclination > FromDegrees(0.9)) {
        const double turn = WrapPi(station.azimuth - point.azimuth);
        azimuth += turn * turn / station.cov_md_inc_azi(2, 2);
        ++azimuths;
      } else {
        EXPECT_TRUE(Has(station.quality, Quality::kVertical));
        // Two of the accelerometers' biases: no run is given up.
        const double two_biases = kEndMd * 2e-4 * std::sqrt(2.0);
        EXPECT_LT(std::sqrt(cov.trace()), two_biases);
        EXPECT_GT(std::sqrt(station.cov_md_inc_azi(2, 2)), FromDegrees(20));
      }
    }
  }
  const double tail = 0.01 / 2 / (6 * 3);  // of all cases together one in a hundred
  EXPECT_GT(position, ChiSquareQuantile(tail, 2 * kSeeds));
  EXPECT_LT(position, ChiSquareQuantile(1 - tail, 2 * kSeeds));
  const int tilts = azimuths == 0 ? 2 * kSeeds : kSeeds;
  EXPECT_GT(tilt, ChiSquareQuantile(tail, tilts));
  EXPECT_LT(tilt, ChiSquareQuantile(1 - tail, tilts));
  if (azimuths == 0) return;
  EXPECT_EQ(azimuths, kSeeds);
  EXPECT_GT(azimuth, ChiSquareQuantile(tail, kSeeds));
  EXPECT_LT(azimuth, ChiSquareQuantile(1 - tail, kSeeds));
}

INSTANTIATE_TEST_SUITE_P(
    Holes, NearVertical,
    ::testing::Values(VerticalCase{"Vertical", 0, 0, 0}, VerticalCase{"VerticalRolling", 0, 0, 3},
                      VerticalCase{"Slant", 1, 0, 0}, VerticalCase{"SlantRolling", 1, 0, 3},
                      VerticalCase{"Build", 0, 100, 0}, VerticalCase{"BuildRolling", 0, 100, 3}),
    [](const auto& of) { return of.param.name; });

// Without north an inclination is as sure as what stands between the axes and gravity lets it be:
// forces of draws of every constant, against the sigmas. Exactly vertical there is no high side.
TEST(Level, IsAsSureAsItsAccelerometersAre) {
  constexpr double kGravity = 9.81;
  const ErrorPriors errors{
      .accel_bias_sigma = 5e-4, .accel_scale_sigma = 3e-4, .accel_misalignment_sigma = 2e-4};
  Random random(5);
  for (const double inclination : {0.5, 30.0, 85.0, 140.0}) {
    const double sine = std::sin(FromDegrees(inclination)), turn = 2.1;
    RunKnot knot;
    knot.increment.force_M =
        -kGravity * Eigen::Vector3d(-sine * std::cos(turn), sine * std::sin(turn),
                                    std::cos(FromDegrees(inclination)));
    const AttitudeSample level = LevelOf(knot, errors, kGravity);
    double tilt = 0, toolface = 0;
    constexpr int kDraws = 2000;
    for (int i = 0; i < kDraws; ++i) {
      RunKnot read = knot;
      for (int c = 0; c < kForceErrors; ++c) {
        read.increment.force_M +=
            random.Normal() * ForceErrors(errors, knot.increment.force_M).col(c);
      }
      const AttitudeSample off = LevelOf(read, errors, kGravity);
      tilt += Square(off.inclination - level.inclination) / level.cov_attitude(0, 0);
      toolface += Square(WrapPi(off.toolface - level.toolface)) / level.cov_attitude(2, 2);
    }
    for (const double sum : {tilt, toolface}) {
      EXPECT_GT(sum, ChiSquareQuantile(5e-4, kDraws)) << inclination;
      EXPECT_LT(sum, ChiSquareQuantile(1 - 5e-4, kDraws)) << inclination;
    }
  }
  RunKnot down;
  down.increment.force_M = {0, 0, -kGravity};
  const AttitudeSample vertical = LevelOf(down, errors, kGravity);
  EXPECT_NEAR(std::sqrt(vertical.cov_attitude(0, 0)), std::hypot(5e-4 / kGravity, 2e-4), 1e-9);
  EXPECT_TRUE(Has(vertical.quality, Quality::kVertical));
}

}  // namespace
}  // namespace wellgyro

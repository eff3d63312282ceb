// Rates and headings of a hidden roll against an axis that is turned by matrices alone.
#include "wellgyro/estimate/roll_track.h"

#include <cmath>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/earth/earth.h"
#include "wellgyro/estimate/swing.h"
#include "wellgyro/math/random.h"

namespace wellgyro {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kGravity = 9.81, kLatitude = 0.9;

/// What a tool does in a hole that leans and bends by little, at a time.
struct Motion {
  double rate = 0, swing = 0, period = 20, heading = 1;

  double HeadingAt(double t) const {
    return heading + rate * t + swing * std::sin(kTwoPi * t / period);
  }
  /// The lean circles with 0.05 deg about 0.1 deg north: the axis turns by half the Earth's rate.
  Matrix3d AttitudeAt(double t) const {
    const double north = FromDegrees(0.1 + 0.05 * std::cos(t / 120));
    const double east = FromDegrees(0.05 * std::sin(t / 120));
    // To lean north the axis, down, turns about east.
    const Matrix3d lean =
        (AngleAxisd(north, Vector3d::UnitY()) * AngleAxisd(-east, Vector3d::UnitX()))
            .toRotationMatrix();
    return lean * AngleAxisd(HeadingAt(t), Vector3d::UnitZ()).toRotationMatrix();
  }
};

EstimateSetup SetupOf() {
  EstimateSetup setup;
  setup.site.latitude = kLatitude;
  setup.site.gravity = kGravity;
  setup.gyro.angle_random_walk = FromDegrees(0.05) / 60;
  setup.errors.gyro_bias_sigma = FromDegrees(10) / 3600;
  setup.errors.gyro_misalignment_sigma = 1e-4;
  setup.errors.accel_bias_sigma = 1e-3;
  setup.errors.accel_noise = 1e-4;
  return setup;
}

/// The mean of what its sensors read over the second that begins at `t`, with a gyro bias as large
/// as the Earth's rate.
RunKnot KnotAt(const Motion& motion, double t, const EstimateSetup& setup, Random& random) {
  const Vector3d earth = kEarthRate * Vector3d(std::cos(kLatitude), 0, -std::sin(kLatitude));
  constexpr double kHalf = 1e-3;
  const Matrix3d R = motion.AttitudeAt(t + 0.5);
  const Matrix3d change =
      motion.AttitudeAt(t + 0.5 - kHalf).transpose() * motion.AttitudeAt(t + 0.5 + kHalf);
  const AngleAxisd turned(change);
  const Vector3d rate = turned.angle() / (2 * kHalf) * turned.axis() + R.transpose() * earth;
  RunKnot knot;
  knot.increment.seconds = 1;
  const double noise = setup.gyro.angle_random_walk;
  knot.increment.turn_M = rate.head<2>() + Eigen::Vector2d(kEarthRate, -0.5 * kEarthRate) +
                          noise * Eigen::Vector2d{random.Normal(), random.Normal()};
  knot.increment.force_M = R.transpose() * Vector3d(0, 0, -kGravity) + Vector3d(5e-4, -1e-3, 0);
  return knot;
}

struct TrackCase {
  Motion motion;
  const char* name;
};

class Tracked : public testing::TestWithParam<TrackCase> {};

TEST_P(Tracked, RatesAndHeadingsAreThoseOfTheTool) {
  const EstimateSetup setup = SetupOf();
  const Motion& motion = GetParam().motion;
  Random random(7);
  std::vector<RunKnot> knots;
  for (int k = 0; k < 600; ++k) knots.push_back(KnotAt(motion, k, setup, random));
  const RollTrack track = TrackRoll(knots, setup);
  ASSERT_GE(track.headings.size(), 40u);
  double squares = 0;
  for (const NodeHeading& h : track.headings) {
    const double off = WrapPi(h.heading - motion.HeadingAt(static_cast<double>(h.node)));
    EXPECT_LT(std::abs(off), 0.6 + motion.swing) << h.node;
    squares += off * off;
  }
  EXPECT_LT(std::sqrt(squares / static_cast<double>(track.headings.size())), 0.2 + motion.swing);
  for (std::size_t k = 0; k < knots.size(); ++k) {
    EXPECT_NEAR(track.beyond_psi[k], motion.rate, 0.02 + 0.1 * motion.swing) << k;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Hidden, Tracked,
    testing::Values(TrackCase{{.rate = 0.45}, "rolling"}, TrackCase{{.rate = -0.08}, "slowly"},
                    TrackCase{{.rate = 1.3}, "fast"},
                    TrackCase{{.rate = 0.3, .swing = FromDegrees(20)}, "swinging"},
                    TrackCase{{.rate = 0.3, .swing = FromDegrees(20), .period = 6}, "shaking"}),
    [](const auto& c) { return std::string(c.param.name); });

TEST(RollTrack, KnotsThatShowTheirRollAreLeftAlone) {
  const EstimateSetup setup = SetupOf();
  Random random(8);
  std::vector<RunKnot> knots;
  for (int k = 0; k < 200; ++k) knots.push_back(KnotAt({.rate = 0.4}, k, setup, random));
  for (std::size_t k = 0; k < 100; ++k) knots[k].still = true;
  for (std::size_t k = 100; k < 195; ++k) knots[k].increment.roll_seen = true;
  const RollTrack track = TrackRoll(knots, setup);  // five knots are too few
  EXPECT_TRUE(track.headings.empty());
  for (const double rate : track.beyond_psi) EXPECT_EQ(rate, 0);
  EXPECT_TRUE(TrackRoll({}, setup).headings.empty());
}

// A job may say that a tool has no such error.
TEST(RollTrack, StatedErrorsMayBeNone) {
  EstimateSetup setup = SetupOf();
  Random random(9);
  std::vector<RunKnot> knots;
  for (int k = 0; k < 200; ++k) {
    knots.push_back(KnotAt({.rate = 0.4}, k, setup, random));
    knots.back().increment.turn_M -= Eigen::Vector2d(kEarthRate, -0.5 * kEarthRate);
    knots.back().increment.force_M -= Vector3d(5e-4, -1e-3, 0);
  }
  setup.errors.gyro_bias_sigma = setup.errors.gyro_misalignment_sigma = 0;
  setup.errors.accel_bias_sigma = setup.errors.accel_noise = 0;
  setup.gyro.angle_random_walk = 0;
  const RollTrack track = TrackRoll(knots, setup);
  EXPECT_GE(track.headings.size(), 10u);
  for (const double rate : track.beyond_psi) EXPECT_NEAR(rate, 0.4, 0.02);
}

// Two legs whose swings begin with phases of their own: a line through both would lie between the
// lines of either, 2 pi / 700 s apart.
TEST(Swing, IsLookedForBetweenStops) {
  constexpr double kOmega = 0.9;
  std::vector<RunKnot> knots(900);
  std::vector<Node> nodes(knots.size() + 1);
  for (std::size_t k = 0; k < knots.size(); ++k) {
    knots[k].increment.seconds = 1;
    knots[k].still = k >= 350 && k < 500;
    const double phase = k < 350 ? 0.0 : 2.5;
    if (!knots[k].still) {
      nodes[k].roll_rate = 0.12 + 0.1 * std::cos(kOmega * static_cast<double>(k) + phase);
    }
  }
  const auto omega = SwingOf(knots, nodes);
  ASSERT_TRUE(omega.has_value());
  EXPECT_NEAR(*omega, kOmega, kSwingSigma);
  EXPECT_FALSE(SwingOf(knots).has_value());  // none of it is seen
}

}  // namespace
}  // namespace wellgyro

// Rates and headings of a hidden roll against an axis that is turned by matrices alone.
#include "wellgyro/estimate/hidden_roll.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/earth/earth.h"
#include "wellgyro/estimate/roll_window.h"
#include "wellgyro/estimate/swing.h"
#include "wellgyro/math/random.h"
#include "wellgyro/math/square.h"

namespace wellgyro {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kGravity = 9.81, kLatitude = 0.9;

/// What a tool does in a hole that leans and bends by little, at a time.
struct Motion {
  double rate = 0, swing = 0, period = 20, heading = 1;
  double build = 0;  // from 200 s on the lean grows as its square [rad/s^2]

  double HeadingAt(double t) const {
    return heading + rate * t + swing * std::sin(kTwoPi * t / period);
  }
  /// The lean circles with 0.05 deg about 0.1 deg north: the axis turns by half the Earth's rate.
  Matrix3d AttitudeAt(double t) const {
    const double built = build * Square(std::max(0.0, t - 200));
    const double north = FromDegrees(0.1 + 0.05 * std::cos(t / 120)) + built;
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

/// The first `count` seconds of it.
std::vector<RunKnot> KnotsOf(const Motion& motion, int count, const EstimateSetup& setup,
                             std::uint64_t seed) {
  Random random(seed);
  std::vector<RunKnot> knots;
  for (int k = 0; k < count; ++k) knots.push_back(KnotAt(motion, k, setup, random));
  return knots;
}

struct RollCase {
  Motion motion;
  const char* name;
};

class Hidden : public testing::TestWithParam<RollCase> {};

// A bend across the Earth's rate, half as large, turns what the path takes for north by 27 deg.
constexpr double kByBend = 0.5;  // [rad]

TEST_P(Hidden, RollIsCountedWithoutDrift) {
  const EstimateSetup setup = SetupOf();
  const Motion& motion = GetParam().motion;
  std::vector<RunKnot> knots = KnotsOf(motion, 600, setup, 7);
  const std::vector<double> rates = HiddenRoll(knots, setup);
  double turned = 0, squares = 0;
  for (std::size_t k = 0; k < knots.size(); ++k) {
    turned += rates[k];
    const double off = turned - (motion.HeadingAt(static_cast<double>(k + 1)) - motion.heading);
    EXPECT_LT(std::abs(off), kByBend + 0.3 + motion.swing) << k;
    squares += off * off;
  }
  EXPECT_LT(std::sqrt(squares / static_cast<double>(knots.size())), kByBend + motion.swing);
}

TEST_P(Hidden, WindowsFindRatesAndWhatIsFixedInTheTool) {
  const EstimateSetup setup = SetupOf();
  const Motion& motion = GetParam().motion;
  std::vector<RunKnot> knots = KnotsOf(motion, 600, setup, 7);
  const std::vector<RollWindow> windows = RollWindowsOf(knots, setup);
  ASSERT_GE(windows.size(), 50u);
  std::size_t north = 0;
  for (const RollWindow& w : windows) {
    EXPECT_NEAR(w.rate, motion.rate, 0.02 + 0.1 * motion.swing) << w.node;
    const std::complex<double> off = w.steady - kEarthRate * std::complex(1.0, -0.5);
    EXPECT_LT(std::abs(off), (0.2 + motion.swing) * kEarthRate) << w.node;
    north += w.finds_north ? 1 : 0;
  }
  EXPECT_GE(north, 40u);
}

INSTANTIATE_TEST_SUITE_P(
    Rolls, Hidden,
    testing::Values(RollCase{{.rate = 0.45}, "rolling"}, RollCase{{.rate = -0.08}, "slowly"},
                    RollCase{{.rate = 1.3}, "fast"},
                    RollCase{{.rate = 0.3, .swing = FromDegrees(20)}, "swinging"},
                    RollCase{{.rate = 0.3, .swing = FromDegrees(20), .period = 6}, "shaking"}),
    [](const auto& c) { return std::string(c.param.name); });

/// Rolls at 6 rpm from one rest to the next, with some seconds to start and to stop.
double StartedHeading(double sign, double t) {
  const auto ramp = [](double s) {  // the integral of a rate that goes from 0 to 1 in 6 s
    if (s < 0) return 0.0;
    return s < 6 ? s * s / 12 : s - 3;
  };
  return 1 + sign * 0.628 * (ramp(t - 60) - ramp(t - 241.3));
}

// What is fixed in the tool is larger than the Earth's rate and only there while it rolls, as a
// misalignment of the gyros is; what it turns by while it starts and stops is not what it turns by
// at other times, and the rests on both sides say so.
class TurnsCounted : public testing::TestWithParam<double> {};

TEST_P(TurnsCounted, FromRestToRest) {
  const double sign = GetParam();
  EstimateSetup setup = SetupOf();
  setup.gyro.angle_random_walk = FromDegrees(0.01) / 60;
  setup.errors.gyro_misalignment_sigma = 2e-4;
  Random random(10);
  std::vector<RunKnot> knots;
  std::vector<double> headings{StartedHeading(sign, 0)};
  for (int k = 0; k < 300; ++k) {
    const double t = k, begin = headings.back(), end = StartedHeading(sign, t + 1);
    Motion motion{.rate = end - begin, .heading = StartedHeading(sign, t + 0.5)};
    motion.heading -= motion.rate * (t + 0.5);
    RunKnot knot = KnotAt(motion, t, setup, random);
    const Eigen::Vector2d bias = kEarthRate * Eigen::Vector2d(1, -0.5);
    knot.increment.turn_M += motion.rate * 2e-4 * Eigen::Vector2d(0.8, 0.6) - bias;
    knot.still = begin == end;
    knot.along.known = true;
    knot.along.speed = 0.9 * std::abs(motion.rate);
    knot.along.sigma_speed = 0.01;
    knots.push_back(knot);
    headings.push_back(end);
  }
  const std::vector<double> rates = HiddenRoll(knots, setup);
  double turned = headings.front();
  for (std::size_t k = 0; k < knots.size(); ++k) {
    turned += rates[k];
    EXPECT_NEAR(turned, headings[k + 1], kByBend + 0.3) << k;
  }
  EXPECT_GT(sign * headings.back(), 17 * kTwoPi);
}

INSTANTIATE_TEST_SUITE_P(BothWays, TurnsCounted, testing::Values(1.0, -1.0));

TEST(HiddenRoll, KnotsThatShowTheirRollAreLeftAlone) {
  const EstimateSetup setup = SetupOf();
  std::vector<RunKnot> knots = KnotsOf({.rate = 0.4}, 200, setup, 8);
  for (std::size_t k = 0; k < 195; ++k) knots[k].increment.roll_seen = true;
  for (const double rate : HiddenRoll(knots, setup)) EXPECT_EQ(rate, 0);  // five are too few
  for (std::size_t k = 0; k < 100; ++k) knots[k].increment.roll_seen = false;
  for (std::size_t k = 0; k < 100; ++k) knots[k].still = true;
  for (const double rate : HiddenRoll(knots, setup)) EXPECT_EQ(rate, 0);
  EXPECT_TRUE(HiddenRoll({}, setup).empty());
  EXPECT_TRUE(RollWindowsOf({}, setup).empty());
}

// To half a degree within 30 s: what the gyros read turns from north to the bend, which becomes ten
// times the Earth's rate, while a tool that does not turn stands still and one that does goes on.
TEST(HiddenRoll, ABendThatGrowsIsNoRoll) {
  EstimateSetup setup = SetupOf();
  setup.errors.gyro_bias_sigma = FromDegrees(0.5) / 3600;
  for (const double rate : {0.0, 0.3}) {
    const Motion motion{.rate = rate, .build = FromDegrees(0.5) / 900};
    Random random(12);
    std::vector<RunKnot> knots;
    for (int k = 0; k < 235; ++k) {
      knots.push_back(KnotAt(motion, k, setup, random));
      knots.back().increment.turn_M -= kEarthRate * Eigen::Vector2d(1, -0.5);
    }
    const std::vector<double> rates = HiddenRoll(knots, setup);
    double turned = 0;
    for (std::size_t k = 0; k < knots.size(); ++k) {
      turned += rates[k];
      EXPECT_NEAR(turned, rate * static_cast<double>(k + 1), kByBend + 0.3) << rate << " " << k;
    }
  }
}

// A piece of the grid does not show where the next begins: 1300 knots are three.
TEST(HiddenRoll, LongStretchesAreSolvedInPieces) {
  const EstimateSetup setup = SetupOf();
  const Motion motion{.rate = 0.21};
  std::vector<RunKnot> knots = KnotsOf(motion, 1300, setup, 11);
  knots[620].increment.level = false;  // nothing of it is known
  knots[620].increment.turn_M.setZero();
  const std::vector<double> rates = HiddenRoll(knots, setup);
  double turned = 0;
  for (std::size_t k = 0; k < knots.size(); ++k) {
    turned += rates[k];
    EXPECT_NEAR(turned, motion.rate * static_cast<double>(k + 1), kByBend + 0.3) << k;
  }
}

// A roll of 0.1 rad/s that swings by 0.16 rad/s besides: what neighbours tell is the rate in the
// middle of the swing, a tool's fixed errors aside.
TEST(HiddenRoll, TheOtherStartHasTheMiddleOfASwing) {
  const EstimateSetup setup = SetupOf();
  constexpr double kRate = 0.1;
  std::vector<RunKnot> knots = KnotsOf({.rate = kRate, .swing = 0.3, .period = 12}, 400, setup, 3);
  for (RunKnot& knot : knots) {
    knot.increment.turn_M -= Eigen::Vector2d(kEarthRate, -0.5 * kEarthRate);
  }
  const std::vector<std::vector<double>> rolls = HiddenRolls(knots, setup);
  ASSERT_EQ(rolls.size(), 2u);
  ASSERT_EQ(rolls[1].size(), knots.size());
  double mean = 0, squares = 0;
  for (const double rate : rolls[1]) mean += rate / 400;
  for (const double rate : rolls[1]) squares += Square(rate - kRate) / 400;
  EXPECT_NEAR(mean, kRate, 0.2 * kRate);
  EXPECT_LT(std::sqrt(squares), 0.03) << "a swing has 0.11";
  // Where gravity shows every roll there is but one way to begin.
  for (RunKnot& knot : knots) knot.increment.roll_seen = true;
  EXPECT_EQ(HiddenRolls(knots, setup).size(), 1u);
}

// A solution that is right but for its roll, which it lost where the tool swings by 40 deg: the
// path about it finds the swing from what the solution knows of gyros and hole. An even roll within
// a second is 2.4 deg off this one, and the grid has steps of 2.8 deg.
TEST(HiddenRoll, AboutASolutionEverySwingIsFound) {
  EstimateSetup setup = SetupOf();
  setup.site = SiteAt(kLatitude, 0);
  setup.gyro.angle_random_walk = FromDegrees(0.01) / 60;
  const Motion motion{.rate = 0.1, .swing = FromDegrees(40), .period = 9};
  std::vector<RunKnot> knots = KnotsOf(motion, 200, setup, 4);
  for (RunKnot& knot : knots) {  // gyros without bias, in a hole that a matrix turns
    knot.increment.turn_M -= Eigen::Vector2d(kEarthRate, -0.5 * kEarthRate);
  }
  NodeGuess nodes(knots.size() + 1);
  const auto lost = [](std::size_t k) { return k > 50 && k < 150 ? 1.0 : 0.0; };  // [rad]
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const double t = static_cast<double>(k), swung = motion.swing * std::sin(kTwoPi * t / 9);
    const Vector3d z = Vector3d::UnitZ();
    nodes[k].R_LT = motion.AttitudeAt(t) * AngleAxisd(lost(k) - swung, z).toRotationMatrix();
    nodes[k].roll_rate = motion.rate;
    nodes[k].speed = 0.3;
    nodes[k].md = 0.3 * t;
  }
  const BorderVector border = BorderVector::Zero(LayoutOf(setup).border);
  const NodeGuess about = RollAbout(setup, knots, nullptr, nodes, border);
  ASSERT_EQ(about.size(), nodes.size());
  for (std::size_t k = 0; k < knots.size(); ++k) {
    const Matrix3d off = motion.AttitudeAt(static_cast<double>(k)).transpose() * about[k].R_LT;
    EXPECT_LT(std::abs(AngleAxisd(off).angle()), FromDegrees(12)) << k;
  }
}

// A job may say that a tool has no such error.
TEST(HiddenRoll, StatedErrorsMayBeNone) {
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
  double turned = 0;
  for (const double rate : HiddenRoll(knots, setup)) turned += rate;
  EXPECT_NEAR(turned, 80, kByBend + 0.3);
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

// The frequency at which a tool swings.
#include "wellgyro/estimate/swing.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/math/random.h"

namespace wellgyro {
namespace {

constexpr double kLegSeconds = 190, kRampSeconds = 10, kRestSeconds = 20;  // [s]

/// Three legs between rests, rolling at `rate` and swinging, at the ends of each slower.
std::vector<RunKnot> SwingingKnots(double rate, double swing, double omega) {
  Random random(7);
  std::vector<RunKnot> knots;
  double time = 0;
  const auto add = [&](double share, bool still) {
    RunKnot& knot = knots.emplace_back();
    knot.increment.seconds = 1;
    knot.increment.roll_seen = true;
    knot.increment.roll_before =
        share * (rate + swing * std::cos(omega * time)) + (still ? 0 : 0.01 * random.Normal());
    knot.still = still;
    knot.along.known = true;
    knot.along.speed = share;
    knot.along.sigma_speed = 1e-3;
    time += 1;
  };
  for (int leg = 0; leg < 3; ++leg) {
    for (int i = 0; i < kRestSeconds; ++i) add(0, true);
    for (int i = 0; i < kRampSeconds; ++i) add(i / kRampSeconds, false);
    for (int i = 0; i < kLegSeconds - 2 * kRampSeconds; ++i) add(1, false);
    for (int i = 0; i < kRampSeconds; ++i) add(1 - i / kRampSeconds, false);
  }
  return knots;
}

// 10 deg in 18 s at 2.8 rpm: the ramps of a leg have 1.7 times the square of the swing.
TEST(Swing, IsSeenBesideStartsAndStops) {
  constexpr double kOmega = kTwoPi / 18.06, kAmplitude = 0.06;
  for (const double rpm : {0.0, 2.8, 5.0}) {
    const auto found = SwingOf(SwingingKnots(rpm * kTwoPi / 60, kAmplitude, kOmega));
    ASSERT_TRUE(found) << rpm;
    EXPECT_NEAR(*found, kOmega, 2 * kSwingSigma) << rpm;
  }
}

TEST(Swing, OfASteadyRollIsNone) { EXPECT_FALSE(SwingOf(SwingingKnots(2.8 * kTwoPi / 60, 0, 1))); }

}  // namespace
}  // namespace wellgyro

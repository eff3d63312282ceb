// What the accelerometers' errors make of an increment through the phase of gravity, against
// increments of samples with and without them.
#include "wellgyro/estimate/wobble.h"

#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "attitude/tool_motion.h"

namespace wellgyro {
namespace {

using Eigen::Vector2d;

struct WobbleCase {
  int source;
  double rpm, rate_hz;
};
void PrintTo(const WobbleCase& c, std::ostream* out) {
  *out << "source " << c.source << ", " << c.rpm << " rpm, " << c.rate_hz << " Hz";
}

class Wobbles : public testing::TestWithParam<WobbleCase> {};

constexpr double kInclination = 40;
// Of what is foretold: at 10 Hz and 20 rpm a sample turns by 12 deg, and its mean falls short of a
// second harmonic by .7 %.
constexpr double kShare = 0.025;

/// The seconds from 8 to 10, of a tool whose gyros are skewed: the roll is the most that they see.
Increment WobblingFor(const WobbleCase& c, double error) {
  motion::Sensing sensing;
  if (c.source >= kTurnSources) {
    sensing.error[kMisalignmentX] = 2e-3;
    sensing.error[kMisalignmentY] = -1e-3;
  }
  sensing.error[c.source] = error;
  const motion::Attitude attitude = motion::InHole(kInclination, motion::Turning(c.rpm));
  IncrementOptions options;
  options.accel_noise = 5e-4;
  return motion::Increments(motion::Samples(attitude, sensing, c.rate_hz, 20), 2, options)[4];
}

TEST_P(Wobbles, DoWhatTheIncrementSays) {
  const WobbleCase& c = GetParam();
  const double size = c.source == kAccelBiasX || c.source == kAccelBiasY ? 2e-3 : 2e-4;
  const Increment plus = WobblingFor(c, size), minus = WobblingFor(c, -size),
                  none = WobblingFor(c, 0);
  const WobbleBy by = WobbleOf(plus);  // followed as closely as the smoother then takes it to be
  const PhaseErrors unit = PhaseErrorsOf(c.source, none.force_M.z());
  const double whole = 2 * size, roll = by.roll().norm() * unit.norm();
  EXPECT_NEAR((plus.roll_before - minus.roll_before) / whole, by.roll_before * unit, kShare * roll);
  EXPECT_NEAR((plus.roll_after - minus.roll_after) / whole, by.roll_after * unit, kShare * roll);
  const bool gyro = c.source < kTurnSources;
  Vector2d seen = Vector2d::Zero(), direct = Vector2d::Zero();
  if (gyro) seen = none.turn_by_error.col(c.source);
  if (!gyro) direct = none.ForceBy(c.source).head<2>();
  const Vector2d turn = (plus.turn_M - minus.turn_M) / whole, turn_by = seen + by.turn_M * unit;
  EXPECT_LT((turn - turn_by).norm(),
            kShare * (by.turn_M.norm() * unit.norm() + roll * none.turn_M.norm()))
      << turn.transpose() << " for " << turn_by.transpose();
  const Vector2d force = (plus.force_M - minus.force_M).head<2>() / whole;
  if (gyro) return;  // that what they seem to turn leans the force, is the estimator's business
  const Vector2d by_phase = by.force_M * unit;
  EXPECT_LT((force - direct - by_phase).norm(), kShare * (direct.norm() + by_phase.norm()))
      << force.transpose() << " for " << (direct + by_phase).transpose();
}

// The columns of skewed gyros go along: what is taken out at once is what is there without.
TEST_P(Wobbles, AreTakenOut) {
  const WobbleCase& c = GetParam();
  const double size = c.source == kAccelBiasX || c.source == kAccelBiasY ? 2e-3 : 2e-4;
  const Increment none = WobblingFor(c, 0), wobbling = WobblingFor(c, size);
  const PhaseErrors errors = size * PhaseErrorsOf(c.source, none.force_M.z());
  const WobbleBy by = WobbleOf(wobbling);
  Increment out = WithoutWobble(wobbling, by, errors);
  if (c.source < kTurnSources) out.turn_M -= size * out.turn_by_error.col(c.source);
  const double turned = (by.turn_M * errors).norm();
  const double rolled = by.roll().norm() * errors.norm();
  EXPECT_LT((out.turn_M - none.turn_M).norm(), kShare * (turned + rolled * none.turn_M.norm()));
  EXPECT_LT((out.turn_by_error - none.turn_by_error).col(kMisalignmentY).norm(), kShare * rolled);
}

// A third axis does not see gravity.
TEST(Wobble, OfAThirdAxisIsNone) {
  motion::Sensing sensing;
  sensing.has_gz = true;
  const auto increments = motion::Increments(
      motion::Samples(motion::InHole(kInclination, motion::Turning(5)), sensing, 10, 20), 2, {});
  EXPECT_TRUE(WobbleOf(increments[4]).roll().isZero(0));
  EXPECT_TRUE(WobbleOf(increments[4]).force_M.isZero(0));
}

std::vector<WobbleCase> AllWobbles() {
  std::vector<WobbleCase> cases;
  for (const int source : kPhaseSources) {
    for (const double rpm : {1., 5., 20.}) cases.push_back({source, rpm, 10});
    cases.push_back({source, 20, 100});
  }
  return cases;
}

INSTANTIATE_TEST_SUITE_P(All, Wobbles, testing::ValuesIn(AllWobbles()), [](const auto& param) {
  return "source_" + std::to_string(param.param.source) + "_" +
         std::to_string(static_cast<int>(param.param.rpm)) + "_rpm_" +
         std::to_string(static_cast<int>(param.param.rate_hz)) + "_Hz";
});

}  // namespace
}  // namespace wellgyro

#include "wellgyro/attitude/increment_builder.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"

#include "attitude/tool_motion.h"

namespace wellgyro {
namespace {

using motion::Angle;
using motion::Attitude;
using motion::InHole;
using motion::Tilt;
using motion::Turning;

IncrementOptions Options(IncrementOptions::Order order = IncrementOptions::kThird) {
  IncrementOptions options;
  options.order = order;
  options.accel_noise = 5e-4;
  options.angle_random_walk = 2.9e-6;
  return options;
}

Angle Swinging(double degrees, double hz, double rpm = 0) {
  return [=, turning = Turning(rpm)](double t) {
    return turning(t) + FromDegrees(degrees) * std::sin(kTwoPi * hz * t);
  };
}

Tilt Whirl(double degrees, double hz) {
  return [=](double t) {
    return Eigen::Vector2d(FromDegrees(degrees) * std::cos(kTwoPi * hz * t),
                           FromDegrees(degrees) * std::sin(kTwoPi * hz * t));
  };
}

double StartAndStop(double t) {
  const double spin = 2.0;  // 20 rpm within five seconds, and back
  if (t < 20) return 0.3;
  if (t < 25) return 0.3 + spin * (t - 20) * (t - 20) / 10;
  if (t < 40) return 0.3 + spin * (t - 22.5);
  if (t < 45) return 0.3 + spin * (17.5 + (t - 40) - (t - 40) * (t - 40) / 10);
  return 0.3 + spin * 20;
}

struct Bounds {
  double knot = 0;   // worst of the axis over a knot [rad]
  double drift = 0;  // of the axis but for the run's ends, were it linear in time [rad/s]
  double roll = 0;   // worst of the relative roll over a knot [rad]
};

Bounds Fly(const Attitude& attitude, double rate, const IncrementOptions& options, double every = 1,
           bool has_gz = false) {
  const double seconds = 60;
  const auto increments = motion::Increments(
      motion::Samples(attitude, {.has_gz = has_gz}, rate, seconds), every, options);
  EXPECT_GE(increments.size(), std::floor(seconds / every + 1e-9));
  Bounds worst;
  Eigen::Vector3d drift = Eigen::Vector3d::Zero();
  double t = 0;
  for (const Increment& i : increments) {
    double delta = 0;
    const Eigen::Vector2d miss = motion::Miss(i, attitude, t, delta);
    t += i.seconds;
    const bool inner = t > 1.5 * every && t < seconds - 0.5 * every;
    if (inner) {
      drift += motion::InertialAttitude(attitude, t) * Eigen::Vector3d(miss.x(), miss.y(), 0);
    }
    worst.knot = std::max(worst.knot, miss.norm());
    worst.roll = std::max(worst.roll, std::abs(delta));
  }
  worst.drift = drift.norm() / seconds;
  return worst;
}

struct Case {
  const char* name;
  Attitude attitude;
  double rate;
  double knot, drift, roll;  // bounds: some three times what is left to the order kept
};

class Motions : public testing::TestWithParam<Case> {};

TEST_P(Motions, TurnTheToolAsTheyDo) {
  const Case& c = GetParam();
  const Bounds worst = Fly(c.attitude, c.rate, Options());
  EXPECT_LT(worst.knot, c.knot);
  EXPECT_LT(worst.drift, c.drift);
  EXPECT_LT(worst.roll, c.roll);
}

// The first and the last second of a run have neighbours on one side only and are the worst.
std::vector<Case> AllMotions() {
  std::vector<Case> cases;
  for (const double rate : {10., 100.}) {
    const bool slow = rate < 50;
    for (const double inclination : {3., 30., 90., 110.}) {
      for (const double rpm : {0., 3., 20.}) {
        cases.push_back({"turning", InHole(inclination, Turning(rpm)), rate, 1e-9, 1e-10, 1e-3});
      }
    }
    for (const double inclination : {3., 60.}) {
      cases.push_back({"swing_8deg_0.7Hz", InHole(inclination, Swinging(8, 0.7)), rate,
                       slow ? 2e-6 : 2e-7, slow ? 3e-8 : 5e-9, 5e-3});
      cases.push_back({"swing_25deg_23s", InHole(inclination, Swinging(25, 1 / 23., 3)), rate,
                       slow ? 2e-7 : 2e-8, 5e-9, 3e-3});
      cases.push_back(
          {"start_and_stop", InHole(inclination, StartAndStop), rate, 1e-9, 1e-10, 1e-3});
    }
  }
  // Whirling tools, the worst case where the roll swings with them.
  for (const double inclination : {3., 60.}) {
    for (const double hz : {1., 1.7, 3., 5.}) {
      const bool fast = hz > 4;
      cases.push_back({"whirl", InHole(inclination, Turning(3), Whirl(0.1, hz)), 100, 6e-6,
                       fast ? 5e-7 : 1e-7, 5e-3});
      cases.push_back({"whirl_and_swing", InHole(inclination, Swinging(0.5, hz, 3), Whirl(0.1, hz)),
                       100, fast ? 1e-5 : 3e-6, fast ? 6e-6 : 7e-7, 1e-2});
    }
    cases.push_back(
        {"whirl_1.7Hz", InHole(inclination, Turning(3), Whirl(0.1, 1.7)), 10, 5e-6, 3e-7, 1e-2});
    cases.push_back({"whirl_and_swing_1Hz", InHole(inclination, Swinging(0.5, 1, 3), Whirl(0.1, 1)),
                     10, 1e-5, 1e-6, 1e-2});
  }
  return cases;
}

void PrintTo(const Case& c, std::ostream* out) { *out << c.name << " at " << c.rate << " Hz"; }

INSTANTIATE_TEST_SUITE_P(All, Motions, testing::ValuesIn(AllMotions()), [](const auto& param) {
  std::string name = std::to_string(param.index) + "_" + param.param.name;
  std::replace(name.begin(), name.end(), '.', 'p');
  return name;
});

// Law: second order falls as period^2, third by another two powers, once the roll is known.
TEST(IncrementBuilder, OrdersFallWithThePeriodAsTheyShould) {
  const Attitude attitude = InHole(60, Swinging(2, 0.5, 3), Whirl(0.02, 0.5));
  std::vector<double> second, third;
  for (const double rate : {5., 10., 20.}) {
    second.push_back(Fly(attitude, rate, Options(IncrementOptions::kSecond), 1, true).drift);
    third.push_back(Fly(attitude, rate, Options(), 1, true).drift);
  }
  EXPECT_THAT(second[0] / second[1], testing::AllOf(testing::Gt(3), testing::Lt(5)));
  EXPECT_THAT(second[1] / second[2], testing::AllOf(testing::Gt(3), testing::Lt(5)));
  EXPECT_GT(third[0] / third[1], 10);
  EXPECT_LT(third[1], 0.02 * second[1]);
}

// 0.6 s of 20 Hz: in doubles the middle is neither in the sample that ends there nor in the next.
TEST(IncrementBuilder, AMiddleBetweenTwoSamplesIsFound) {
  for (const double rate : {10., 20., 50., 100.}) {
    for (const double every : {0.2, 0.4, 0.6, 1.2, 1.4, 2.2}) {
      const auto increments =
          motion::Increments(motion::Samples(InHole(50, Turning(3)), {}, rate, 30), every, {});
      for (std::size_t k = 1; k + 1 < increments.size(); ++k) {
        const Increment& i = increments[k];
        EXPECT_NEAR(i.roll_before, i.roll_after, 0.01 * every) << rate << " Hz, " << every << " s";
        const Eigen::Vector2d rest = i.turn_M - 2 * i.turn_before_M;
        EXPECT_LT(rest.norm(), 0.1 * i.turn_M.norm()) << rate << " Hz, " << every << " s";
      }
    }
  }
}

TEST(IncrementBuilder, ThirdGyroGivesTheRollNearVerticalToo) {
  const Attitude attitude = InHole(0.6, Swinging(8, 0.7, 3), Whirl(0.05, 1));
  const Bounds worst = Fly(attitude, 20, Options(), 1, true);
  EXPECT_LT(worst.knot, 1e-6);
  EXPECT_LT(worst.roll, 1e-4);
  const auto increments =
      motion::Increments(motion::Samples(attitude, {.has_gz = true}, 20, 10), 1, Options());
  for (const Increment& i : increments) {
    ASSERT_TRUE(i.has_axial);
    EXPECT_TRUE(i.roll_seen);
  }
}

/// By how much the force of an increment, brought to its middle, is at most not gravity there
/// [m/s^2].
double ForceMiss(const Attitude& attitude, double rate, const IncrementOptions& options) {
  const auto increments = motion::Increments(motion::Samples(attitude, {}, rate, 40), 1, options);
  double worst = 0;
  for (std::size_t k = 3; k + 3 < increments.size(); ++k) {
    const Increment& i = increments[k];
    double delta = 0;
    motion::Miss(i, attitude, static_cast<double>(k), delta);
    Increment half = i;
    half.turn_M = i.turn_before_M;
    half.turn_per_roll.setZero();
    half.roll_after = -0.5 * delta;
    const Eigen::Matrix3d R_IM =
        motion::InertialAttitude(attitude, static_cast<double>(k)) * motion::Turned(half, delta);
    Eigen::Vector3d f = i.force_M;
    f.head<2>() += delta * i.force_per_roll;
    const double middle = static_cast<double>(k) + 0.5;
    const Eigen::Vector3d up = motion::InertialAttitude(attitude, middle) *
                               attitude(middle).transpose() *
                               Eigen::Vector3d(0, 0, -motion::kGravity);
    worst = std::max(worst, (R_IM * f - up).norm());
  }
  return worst;
}

TEST(IncrementBuilder, ForceIsGravityAtTheMiddle) {
  for (const double whirl : {0., 1.7}) {
    const Attitude attitude = InHole(50, Swinging(3, 0.4, 3), Whirl(whirl > 0 ? 0.1 : 0, whirl));
    EXPECT_LT(ForceMiss(attitude, 50, Options()), 3e-5 * motion::kGravity) << whirl << " Hz";
  }
}

// In a sample that rolls while the axis turns the force is another at either end, and its mean
// falls short of the middle's by the roll times that: the second order in the period, which the
// third gives back.
TEST(IncrementBuilder, ForceToTheThirdOrderOfASlowSample) {
  const Attitude attitude = InHole(30, Swinging(25, 1 / 23., 3));
  std::vector<double> second, third;
  for (const double rate : {1., 2.}) {
    second.push_back(ForceMiss(attitude, rate, Options(IncrementOptions::kSecond)));
    third.push_back(ForceMiss(attitude, rate, Options()));
    std::printf("%g Hz: force %.1e by second, %.1e m/s^2 by third order\n", rate, second.back(),
                third.back());
  }
  EXPECT_LT(third[1], 0.2 * second[1]);
  EXPECT_GT(third[0] / third[1], 6);
}

// Off by what the third axis did between its samples, over what the increment says of that.
struct Step {
  double off = 0, told = 0;  // sums of squares over the noise's
  bool elsewhere = false;    // told of a knot that is not beside the step
};

// A tool that lies still but for its roll, which begins at `when`; force across gravity alone.
Step RollBegins(double when, double rate, double hz) {
  const auto roll = [&](double t) { return rate * std::max(0.0, t - when); };
  constexpr double kAcross = 0.3;  // [m/s^2]
  IncrementOptions options = Options();
  IncrementBuilder builder(options);
  Step step;
  const double dt = 1 / hz;
  double begin = 0;
  for (int i = 0; i < 30 * hz; ++i) {
    ImuSample s{};
    s.has_gz = true;
    s.stamp.seq = i;
    s.stamp.period_ns = static_cast<std::int32_t>(std::llround(1e9 * dt));
    s.stamp.tool_time = {std::int64_t{i} * s.stamp.period_ns};
    constexpr int kParts = 1000;
    for (int j = 0; j < kParts; ++j) {
      const double psi = roll((i + (j + 0.5) / kParts) * dt);
      s.f_T += kAcross / kParts * Eigen::Vector3d(std::cos(psi), -std::sin(psi), 0);
    }
    s.f_T.z() = -9.8;
    s.w_IT_T.z() = (roll((i + 1) * dt) - roll(i * dt)) / dt;
    EXPECT_TRUE(builder.Push(s, false));
    if ((i + 1) % static_cast<int>(hz) == 0) builder.Cut();
    if (i + 1 == 30 * hz) builder.Flush();
    while (builder.Ready()) {
      const Increment inc = builder.Pop();
      const double stands = std::atan2(inc.force_M.y(), inc.force_M.x());
      const double off = kAcross * WrapPi(stands + roll(begin) + inc.roll_before);
      const double var = options.accel_noise * options.accel_noise / inc.seconds;
      if (std::abs(begin + 0.5 - when) < 3) {
        step.off += off * off / var;
        step.told += inc.lateral - 1;
      } else {
        step.elsewhere |= inc.lateral != 1;
      }
      // A third axis' integral ends with the sample, whatever comes behind it.
      const double rolled = roll(begin + inc.seconds) - roll(begin);
      EXPECT_NEAR(inc.roll_before + inc.roll_after, rolled, 1e-12);
      begin += inc.seconds;
    }
  }
  return step;
}

TEST(IncrementBuilder, WhatAThirdAxisDidBetweenSamplesIsInTheForcesVariance) {
  for (const double hz : {1., 2.}) {
    double off = 0, told = 0;
    for (int i = 0; i < 20; ++i) {
      const Step step = RollBegins(12 + 0.05 * i, 0.105, hz);
      EXPECT_LT(step.off, 1.4 * step.told + 0.1) << hz << " Hz, " << 0.05 * i;
      EXPECT_FALSE(step.elsewhere);
      off += step.off;
      told += step.told;
    }
    std::printf("%g Hz: squares %.1f, of them told %.1f\n", hz, off / 20, told / 20);
    EXPECT_GT(off, 0.1 * told) << hz;
  }
}

struct Injected {
  ErrorSource source;
  double size;
};
constexpr Injected kAllErrors[] = {
    {kGyroBiasX, 1e-6},     {kGyroBiasY, 1e-6},           {kMassUnbalance, 1e-7},
    {kQuadrature, 1e-7},    {kGyroScaleX, 1e-3},          {kGyroScaleY, 1e-3},
    {kMisalignmentX, 1e-6}, {kMisalignmentY, 1e-6},       {kToolfaceOffset, 1e-3},
    {kTimeSkew, 1e-3},      {kAccelBiasX, 1e-4},          {kAccelBiasY, 1e-4},
    {kAccelBiasZ, 1e-4},    {kAccelScaleX, 1e-5},         {kAccelScaleY, 1e-5},
    {kAccelScaleZ, 1e-5},   {kAccelMisalignmentX, 1e-5},  {kAccelMisalignmentY, 1e-5},
    {kAccelShear, 1e-5},    {kAccelMisalignmentZX, 1e-5}, {kAccelMisalignmentZY, 1e-5}};

class Errors : public testing::TestWithParam<Injected> {};

// Law: turn_by_error and force_by_error are what an error does to the increment. T is the
// accelerometers' frame: where those are turned against the gyros, it is the truth that changes.
TEST_P(Errors, DoWhatTheIncrementSays) {
  const ErrorSource source = GetParam().source;
  const double size = GetParam().size;
  const double rate = kTwoPi / 60 * 5;
  const bool turned = source == kToolfaceOffset || source == kTimeSkew;
  // Accelerometers' errors go round with the tool and wind the roll within a knot by half the
  // square of its turn: a slow one.
  const bool slow = source >= kAccelBiasX;
  const Attitude attitude = InHole(40, turned ? Turning(5)
                                       : slow ? Turning(0.5)
                                              : Swinging(4, 0.1, 5));
  const auto fly = [&](double error) {
    motion::Sensing sensing;
    sensing.error(source) = error;
    return motion::Increments(motion::Samples(attitude, sensing, 10, 12), 2, Options())[3];
  };
  const Increment increment = fly(size);
  const motion::Resolved plus = motion::AtBegin(increment, attitude, 6),
                         minus = motion::AtBegin(fly(-size), attitude, 6);
  const Eigen::Rotation2Dd to_begin(increment.roll_before);
  Eigen::Vector2d turn_by = Eigen::Vector2d::Zero();
  if (source < kTurnSources) turn_by = to_begin * increment.turn_by_error.col(source);
  Eigen::Vector3d force_by = Eigen::Vector3d::Zero();
  if (source >= kTurnSources) force_by = increment.ForceBy(source);
  force_by.head<2>() = to_begin * force_by.head<2>();
  Eigen::Vector2d turn = (plus.turn - minus.turn) / (2 * size);
  if (turned) {
    const double ahead = source == kTimeSkew ? rate : 1;
    turn += ahead * Eigen::Vector2d(-plus.turn.y(), plus.turn.x());
  }
  const Eigen::Vector3d force = (plus.force - minus.force) / (2 * size);
  EXPECT_LT((turn - turn_by).norm(), 0.01 * turn_by.norm() + 3e-3 * plus.turn.norm())
      << turn.transpose() << " for " << turn_by.transpose();
  if (source < kAccelBiasX) return;
  EXPECT_LT((force - force_by).norm(), 0.02 * force_by.norm())
      << force.transpose() << " for " << force_by.transpose();
}

INSTANTIATE_TEST_SUITE_P(All, Errors, testing::ValuesIn(kAllErrors), [](const auto& param) {
  return "source_" + std::to_string(param.param.source);
});

}  // namespace
}  // namespace wellgyro

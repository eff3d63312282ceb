#include "wellgyro/simulate/fault_player.h"

#include <cmath>
#include <stdexcept>
#include <variant>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/simulate/simulator.h"

namespace wellgyro {
namespace {

using Cause = SimulatedFault::Cause;

Simulation Slant() {
  Simulation s;
  s.well.end_md = 200;
  s.well.inclination.start = 0.7;
  s.earth.latitude = 1;
  s.run.steps = {RunStop{.seconds = 40}, RunMove{.to_md = 60, .speed = 1}};
  s.streams.imu_hz = 10;
  s.streams.depth_hz = 2;
  return s;
}

struct Played {
  std::vector<ImuSample> samples;
  std::vector<DepthMark> marks;
};

Played Play(const Simulation& simulation) {
  Played played;
  Simulator simulator(simulation);
  SimulatedStep step;
  while (simulator.Next(step)) {
    if (const auto* sample = std::get_if<ImuSample>(&step)) played.samples.push_back(*sample);
    if (const auto* mark = std::get_if<DepthMark>(&step)) played.marks.push_back(*mark);
  }
  return played;
}

Played Spoilt(const SimulatedFault& fault) {
  Simulation simulation = Slant();
  simulation.faults.push_back(fault);
  return Play(simulation);
}

TEST(FaultPlayer, AFaultTouchesNothingBeforeItBeginsOrAfterItEnds) {
  const Played clean = Play(Slant());
  for (int cause = 0; cause <= static_cast<int>(Cause::kUtcStep); ++cause) {
    if (static_cast<Cause>(cause) == Cause::kLatitude) continue;  // of the whole run
    const Played spoilt = Spoilt(
        {.cause = static_cast<Cause>(cause), .begin = 20, .end = 25, .size = 1.5, .period = 0.8});
    ASSERT_EQ(clean.samples.size(), spoilt.samples.size()) << cause;
    for (std::size_t k = 0; k < 200; ++k) {
      EXPECT_EQ(clean.samples[k].w_IT_T, spoilt.samples[k].w_IT_T) << cause << " " << k;
      EXPECT_EQ(clean.samples[k].f_T, spoilt.samples[k].f_T) << cause << " " << k;
      EXPECT_EQ(clean.samples[k].stamp.utc, spoilt.samples[k].stamp.utc) << cause << " " << k;
    }
    for (std::size_t k = 0; k < 40; ++k) EXPECT_EQ(clean.marks[k].md, spoilt.marks[k].md) << cause;
    const bool lasts = static_cast<Cause>(cause) == Cause::kSamplesLost ||
                       static_cast<Cause>(cause) == Cause::kRestTurn ||
                       static_cast<Cause>(cause) == Cause::kRestCreep;
    if (lasts) continue;
    for (std::size_t k = 260; k < clean.samples.size(); ++k) {
      EXPECT_EQ(clean.samples[k].w_IT_T, spoilt.samples[k].w_IT_T) << cause << " " << k;
    }
  }
}

TEST(FaultPlayer, AddsWhatItSays) {
  const Played clean = Play(Slant());
  const auto sample = [&](const SimulatedFault& fault) { return Spoilt(fault).samples[300]; };
  const ImuSample& was = clean.samples[300];
  EXPECT_NEAR(sample({.cause = Cause::kGyroStep, .axis = 1, .begin = 20, .size = 1e-5}).w_IT_T.y(),
              was.w_IT_T.y() + 1e-5, 1e-15);
  EXPECT_NEAR(sample({.cause = Cause::kGyroRamp, .begin = 20, .size = 1e-6}).w_IT_T.x(),
              was.w_IT_T.x() + 1e-5, 1e-12);
  EXPECT_NEAR(sample({.cause = Cause::kAccelBias, .axis = 2, .size = 3e-3}).f_T.z(),
              was.f_T.z() + 3e-3, 1e-12);
  EXPECT_EQ(sample({.cause = Cause::kAccelInverted, .axis = 2}).f_T.z(), -was.f_T.z());
  EXPECT_EQ(sample({.cause = Cause::kGyrosSwapped}).w_IT_T.x(), was.w_IT_T.y());
  EXPECT_EQ(sample({.cause = Cause::kGyroDead}).w_IT_T.x(), 0);
  EXPECT_EQ(sample({.cause = Cause::kAccelStuck, .begin = 20}).f_T.x(), clean.samples[200].f_T.x());
  // Sensors average over a sample, in which a whole turn in 10 s goes on by 7 deg.
  const Played turning = Spoilt({.cause = Cause::kRestTurn, .begin = 25, .size = kTwoPi});
  const auto across = [&](std::size_t k) -> Eigen::Vector2d {
    return turning.samples[k].f_T.head<2>();
  };
  const Eigen::Vector2d a = across(299), b = across(301);
  const double turn = std::abs(std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b))) / 2;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (int i = 0; i < 1000; ++i) {
    const double angle = turn * ((i + 0.5) / 1000 - 0.5);
    mean += Eigen::Rotation2Dd(angle) * was.f_T.head<2>() / 1000;
  }
  EXPECT_GT(turn, FromDegrees(3));
  EXPECT_NEAR(across(300).norm(), mean.norm(), 1e-5);
  EXPECT_EQ(turning.samples[300].f_T.z(), was.f_T.z());
  const ImuSample slipped = sample({.cause = Cause::kToolfaceSlip, .size = 0.1});
  EXPECT_NEAR(slipped.f_T.norm(), was.f_T.norm(), 1e-9) << "a turn";
  EXPECT_NEAR(std::atan2(-slipped.f_T.y(), slipped.f_T.x()),
              std::atan2(-was.f_T.y(), was.f_T.x()) + 0.1, 1e-9);
}

// Of a creep the gyros have the rate and gravity turns in the tool by the angle.
TEST(FaultPlayer, ATurnOfTheToolIsFeltByGyrosAndAccelerometersAlike) {
  const double rate = 1e-4;
  const Played clean = Play(Slant());
  const Played crept = Spoilt({.cause = Cause::kRestCreep, .begin = 10, .end = 35, .size = rate});
  EXPECT_NEAR(crept.samples[200].w_IT_T.y() - clean.samples[200].w_IT_T.y(), rate, 1e-9);
  const double turned = rate * (20.05 - 10);
  const Eigen::Vector3d &f = clean.samples[200].f_T, &g = crept.samples[200].f_T;
  EXPECT_NEAR(g.z() - f.z(), turned * f.x(), 1e-5);
  EXPECT_NEAR(g.x() - f.x(), -turned * f.z(), 1e-5);
  double angle = 0;
  for (std::size_t k = 0; k < clean.samples.size(); ++k) {
    angle += 0.1 * (crept.samples[k].w_IT_T.y() - clean.samples[k].w_IT_T.y());
  }
  EXPECT_NEAR(angle, 0, 1e-6) << "and back again";
}

// A tool that whirls while it rolls by 1 rad/s: over half a period its tilt phi goes from one side
// to the other, and the turn between is that of the tool without, seen from there. The stretch
// begins after 75 periods.
TEST(FaultPlayer, AWhirlIsATurnOfTheToolWhileItRolls) {
  Simulation simulation = Slant();
  simulation.run.steps = {RunMove{.to_md = 150, .speed = 1, .roll = {.rate = 1}}};
  simulation.tool.has_gz = true;
  simulation.streams.imu_hz = 100;
  const auto turn = [](const Played& played) {
    Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
    for (std::size_t k = 6000; k < 6040; ++k) {
      const Eigen::Vector3d by = 0.01 * played.samples[k].w_IT_T;
      R = R * Eigen::AngleAxisd(by.norm(), by.normalized());
    }
    return R;
  };
  const Eigen::Matrix3d clean = turn(Play(simulation));
  const double size = 2e-3;
  simulation.faults = {{.cause = Cause::kWhirl, .size = size, .period = 0.8}};
  const Eigen::Matrix3d tilt(Eigen::AngleAxisd(size, Eigen::Vector3d::UnitX()));
  EXPECT_LT((turn(Play(simulation)) - tilt.transpose() * clean * tilt.transpose()).norm(), 3e-6);
}

TEST(FaultPlayer, SpoilsMarks) {
  const Played clean = Play(Slant());
  EXPECT_NEAR(Spoilt({.cause = Cause::kDepthStep, .begin = 60, .size = 1.5}).marks[140].md,
              clean.marks[140].md + 1.5, 1e-12);
  // Half of it at half of the time, two marks a second, and all of it ever after.
  const auto slips = Spoilt({.cause = Cause::kDepthSlip, .begin = 60, .end = 80, .size = 2}).marks;
  EXPECT_EQ(slips[119].md, clean.marks[119].md);
  EXPECT_NEAR(slips[140].md, clean.marks[140].md - 1, 1e-9);
  EXPECT_NEAR(slips[170].md, clean.marks[170].md - 2, 1e-9);
  EXPECT_NEAR(Spoilt({.cause = Cause::kDepthScale, .size = 0.01}).marks[140].md,
              clean.marks[140].md * 1.01, 1e-9);
  EXPECT_NEAR(Spoilt({.cause = Cause::kDepthLag, .size = 0.5}).marks[140].md, clean.marks[139].md,
              1e-9);
  EXPECT_EQ(Spoilt({.cause = Cause::kDepthFrozen, .begin = 60}).marks[150].md, clean.marks[120].md);
}

TEST(FaultPlayer, RefusesWhatCannotBe) {
  const auto refused = [](const SimulatedFault& fault) {
    Simulation simulation = Slant();
    simulation.faults.push_back(fault);
    EXPECT_THROW(Simulator{simulation}, std::invalid_argument);
  };
  refused({.axis = 3});
  refused({.begin = 10, .end = 5});
  refused({.begin = -1});
  refused({.size = std::nan("")});
  refused({.cause = Cause::kWhirl, .size = 1});
  refused({.cause = Cause::kRestCreep, .size = 1});
  refused({.cause = Cause::kDepthSlip, .size = 1});
}

}  // namespace
}  // namespace wellgyro

#include "wellgyro/simulate/simulator.h"

#include <cmath>
#include <cstring>
#include <stdexcept>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "wellgyro/math/rotation.h"
#include "wellgyro/simulate/ellipsoid.h"

#include "allocation_count.h"
#include "cases.h"

namespace wellgyro {
namespace {

struct PlayedSteps {
  std::vector<SimulatedStep> steps;
  std::vector<ToolMode> modes;
  std::vector<ImuSample> samples;
  std::vector<DepthMark> marks;
};

PlayedSteps PlaySteps(const Simulation& simulation) {
  Simulator simulator(simulation);
  PlayedSteps played;
  SimulatedStep step;
  while (simulator.Next(step)) {
    played.steps.push_back(step);
    if (const auto* m = std::get_if<ToolMode>(&step)) played.modes.push_back(*m);
    if (const auto* s = std::get_if<ImuSample>(&step)) played.samples.push_back(*s);
    if (const auto* d = std::get_if<DepthMark>(&step)) played.marks.push_back(*d);
  }
  return played;
}

Simulation ShortRun() {
  Simulation s = WeavingRun();
  s.run.steps = {RunStop{.seconds = 20, .index_angles = {0, kPi}},
                 RunMove{.to_md = 180, .speed = 1, .ramp = 4}, RunStop{.seconds = 10}};
  s.streams.imu_hz = 50;
  s.streams.depth_hz = 4;
  s.tool.errors.gyro_noise = {.quantization = 1e-7,
                              .angle_random_walk = 1e-6,
                              .bias_instability = 1e-7,
                              .rate_random_walk = 1e-9};
  s.tool.errors.accel_noise = 1e-4;
  s.tool.errors.utc_jitter = 1e-3;
  s.tool.errors.depth_noise = 0.01;
  s.seed = 12;
  return s;
}

// Shortest sufficient comparison: every figure of every record, bit for bit.
bool SameBits(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::memcmp(a.data(), b.data(), sizeof(double) * 3) == 0;
}

TEST(Simulator, TheSameSeedGivesTheSameBits) {
  const PlayedSteps a = PlaySteps(ShortRun()), b = PlaySteps(ShortRun());
  Simulation other = ShortRun();
  other.seed = 13;
  const PlayedSteps c = PlaySteps(other);
  ASSERT_EQ(a.samples.size(), b.samples.size());
  ASSERT_EQ(a.marks.size(), b.marks.size());
  std::size_t same = 0;
  for (std::size_t i = 0; i < a.samples.size(); ++i) {
    ASSERT_TRUE(SameBits(a.samples[i].w_IT_T, b.samples[i].w_IT_T));
    ASSERT_TRUE(SameBits(a.samples[i].f_T, b.samples[i].f_T));
    ASSERT_EQ(a.samples[i].stamp.utc, b.samples[i].stamp.utc);
    same += SameBits(a.samples[i].f_T, c.samples[i].f_T);
  }
  EXPECT_EQ(same, 0u);
  for (std::size_t i = 0; i < a.marks.size(); ++i) ASSERT_EQ(a.marks[i].md, b.marks[i].md);
}

TEST(Simulator, StreamsComeInTimeAndWhole) {
  Simulation s = ShortRun();
  s.tool.errors.utc_jitter = 0;
  const PlayedSteps played = PlaySteps(s);
  // 20 + 10 + 20 stand and turn, 30 m and a ramp, 10.
  const double seconds = 50 + 34 + 10;
  ASSERT_EQ(played.samples.size(), static_cast<std::size_t>(seconds * 50));
  ASSERT_EQ(played.marks.size(), static_cast<std::size_t>(seconds * 4) + 1);
  UtcTime last = s.streams.begin_utc;
  for (const SimulatedStep& step : played.steps) {
    UtcTime known = last;
    if (const auto* sample = std::get_if<ImuSample>(&step)) {
      known = sample->stamp.utc + Duration{sample->stamp.period_ns};
    } else if (const auto* mark = std::get_if<DepthMark>(&step)) {
      known = mark->utc;
    } else {
      known = std::get<ToolMode>(step).utc;
    }
    EXPECT_GE(known, last);
    last = known;
  }
  for (std::size_t k = 0; k < played.samples.size(); ++k) {
    const SampleStamp& stamp = played.samples[k].stamp;
    EXPECT_EQ(stamp.seq, static_cast<std::int64_t>(k));
    EXPECT_EQ(stamp.tool_time.ns, static_cast<std::int64_t>(k) * 20'000'000);
    EXPECT_EQ(stamp.utc.ns, s.streams.begin_utc.ns + static_cast<std::int64_t>(k) * 20'000'000);
    EXPECT_TRUE(stamp.simulated);
  }
}

TEST(Simulator, ModesNameTheFirstSampleTheyHoldFor) {
  const PlayedSteps played = PlaySteps(ShortRun());
  ASSERT_EQ(played.modes.size(), 5u);
  const std::int64_t expected[5] = {0, 1000, 1500, 2500, 4200};
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(played.modes[i].imu_seq, expected[i]) << i;
  EXPECT_EQ(played.modes[2].index_angle, kPi);
}

TEST(Simulator, AtRestAPerfectToolFeelsTheEarthsGravity) {
  Simulation s = WeavingRun();
  s.streams.imu_hz = 10;
  Simulator simulator(s);
  SimulatedStep step;
  int still = 0;
  while (simulator.Next(step)) {
    const auto* sample = std::get_if<ImuSample>(&step);
    if (sample == nullptr) continue;
    const TruthState begin = simulator.truth().At(simulator.SampleTime(sample->stamp.seq));
    const TruthState end = simulator.truth().At(simulator.SampleTime(sample->stamp.seq + 1));
    if (!begin.still || !end.still) continue;
    const double g = EllipsoidAt(std::sin(begin.latitude), begin.height).gravity;
    EXPECT_NEAR(sample->f_T.norm(), g, 5e-14);
    ++still;
  }
  EXPECT_GT(still, 2000);
}

TEST(Simulator, ToolClockRunsAtItsOwnRate) {
  Simulation s = AtRest(0.3, 1, 0, 1000);
  s.streams.imu_hz = 10;
  s.tool.errors.clock_offset = 77.5;
  s.tool.errors.clock_drift = 1e-3;
  const PlayedSteps played = PlaySteps(s);
  ASSERT_EQ(played.samples.size(), 10010u);
  const SampleStamp& last = played.samples.back().stamp;
  EXPECT_EQ(last.tool_time.ns, 77'500'000'000 + 10009 * 100'000'000LL);
  EXPECT_NEAR((last.utc - s.streams.begin_utc).seconds(), 1000.9 / 1.001, 1e-6);
  EXPECT_EQ(last.utc.ns % 1000, 0);
}

TEST(Simulator, JitterOfUtcDoesNotTouchTheToolsClock) {
  Simulation s = AtRest(0.3, 1, 0, 100);
  s.tool.errors.utc_jitter = 0.02;
  double sum = 0;
  const PlayedSteps played = PlaySteps(s);
  for (const ImuSample& sample : played.samples) {
    const double off = (sample.stamp.utc - s.streams.begin_utc).seconds() -
                       static_cast<double>(sample.stamp.seq) * 0.01;
    sum += off * off;
    EXPECT_EQ(sample.stamp.tool_time.ns, sample.stamp.seq * 10'000'000);
  }
  EXPECT_NEAR(std::sqrt(sum / static_cast<double>(played.samples.size())), 0.02, 0.001);
}

TEST(Simulator, DepthMarksAreTheReferencesAndTheEncoders) {
  Simulation s = ShortRun();
  s.tool.errors.depth_noise = 0;
  s.tool.sensor_below_reference = 12.5;
  const PlayedSteps exact = PlaySteps(s);
  const Truth truth(s);
  for (const DepthMark& mark : exact.marks) {
    const double time = (mark.utc - s.streams.begin_utc).seconds();
    EXPECT_NEAR(mark.md, truth.At(time).md - 12.5, 1e-12);
    EXPECT_EQ(mark.stopped, truth.At(time).speed == 0);
  }
  s.tool.errors.depth_resolution = 0.1;
  s.tool.errors.depth_scale = 1e-3;
  s.tool.errors.depth_offset = 0.35;
  const PlayedSteps coarse = PlaySteps(s);
  for (std::size_t i = 0; i < exact.marks.size(); ++i) {
    EXPECT_NEAR(std::remainder(coarse.marks[i].md, 0.1), 0, 1e-12);
    EXPECT_NEAR(coarse.marks[i].md, exact.marks[i].md * 1.001 + 0.35, 0.05 + 1e-12);
  }
}

TEST(Simulator, NextAllocatesNothing) {
  Simulator simulator(ShortRun());
  SimulatedStep step;
  simulator.Next(step);
  const long before = AllocationCount();
  int steps = 0;
  while (simulator.Next(step)) ++steps;
  EXPECT_EQ(AllocationCount() - before, 0);
  EXPECT_GT(steps, 1000);
}

TEST(Simulator, NamesWhatMakesNoSense) {
  Simulation s = ShortRun();
  s.streams.imu_hz = 0;
  EXPECT_THROW(Simulator{s}, std::invalid_argument);
  s = ShortRun();
  s.streams.depth_hz = -1;
  EXPECT_THROW(Simulator{s}, std::invalid_argument);
  s = ShortRun();
  s.tool.errors.clock_drift = -1;
  EXPECT_THROW(Simulator{s}, std::invalid_argument);
}

// Strapdown in W from the samples alone: what an estimator with three axes would do, and so the
// one proof that samples, signs and positions belong together.
TEST(Simulator, SampledAnglesCarryTheAttitudeOfAPerfectTool) {
  Simulation s = WeavingRun();
  s.tool.has_gz = true;
  s.streams.depth_hz = 0;
  Simulator simulator(s);
  const TruthState begin = simulator.truth().At(0);
  // Two-sample coning in space; the Earth and the place enter only at the end.
  const auto in_space = [&](const TruthState& at) -> Eigen::Matrix3d {
    return RotationZ(at.longitude + s.earth.rate * at.time) * RotationY(-kPi / 2 - at.latitude) *
           at.R_LT;
  };
  Eigen::Quaterniond q(in_space(begin));
  Eigen::Vector3d previous = Eigen::Vector3d::Zero();
  SimulatedStep step;
  double worst = 0;
  while (simulator.Next(step)) {
    const auto* sample = std::get_if<ImuSample>(&step);
    if (sample == nullptr) continue;
    const double dt = sample->stamp.period_ns * 1e-9;
    const Eigen::Vector3d angle = sample->w_IT_T * dt;
    const Eigen::Vector3d turn = angle + previous.cross(angle) / 12;
    previous = angle;
    q = q * Eigen::Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
    if (sample->stamp.seq % 10000 != 9999) continue;
    q.normalize();
    const TruthState at = simulator.truth().At(simulator.SampleTime(sample->stamp.seq + 1));
    worst = std::max(worst, Eigen::Quaterniond(in_space(at)).angularDistance(q));
  }
  EXPECT_LT(worst, 1e-8);
  EXPECT_GT(simulator.sample_count(), 360000);
}

}  // namespace
}  // namespace wellgyro

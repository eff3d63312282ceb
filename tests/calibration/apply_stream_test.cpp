#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/base/units.h"
#include "wellgyro/calibration/apply.h"
#include "wellgyro/simulate/raw_counts.h"

#include "calibration/calibrated.h"
#include "calibration/random_tool.h"
#include "simulate/allocation_count.h"

namespace wellgyro {
namespace {

using test::Calibrate;
using test::RandomSample;
using test::RandomTool;

TEST(Apply, CountsOfPulsesArePerSecond) {
  ToolCalibration tool;
  tool.accel.n_channels = 3;
  tool.accel.channel = {0, 1, 2};
  tool.accel.per_second = true;
  tool.accel.sensitivity[0].topRows<3>() = 1200 * Eigen::Matrix3d::Identity();
  RawCounter counter(tool);
  ImuSample truth;
  truth.f_T = {9.8, -0.3, 1.0 / 3};
  truth.stamp.period_ns = 8'000'000;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  SampleCalibrator calibrator(tool);
  constexpr int kSamples = 1000;
  for (int i = 0; i < kSamples; ++i) {
    const RawSample raw = counter.Count(truth, 20);
    ImuSample out;
    ASSERT_EQ(calibrator.Apply({&raw, 1}, {&out, 1}), 1u);
    sum += out.f_T;
  }
  // The remainder is carried: over 8 s at most one pulse of 1/1200 m/s is missing.
  EXPECT_LT((sum / kSamples - truth.f_T).cwiseAbs().maxCoeff(), 1.0 / 1200 / 8);
  EXPECT_GT(sum.norm(), 1);
}

// Temperatures that stand still for a while, or that leave their cells again and again.
TEST(Apply, DoesNotDependOnTheCutsOfBatches) {
  ToolCalibration tool =
      RandomTool(7, {.temperature = true, .second_order = true, .g_terms = true, .rotated = true});
  tool.gyro.heating.setConstant(0.3);
  tool.accel.heating.setConstant(-0.2);
  for (const double noise : {0.0, 0.3}) {
    Random random(8);
    RawCounter counter(tool);
    std::vector<RawSample> raw;
    for (int i = 0; i < 300; ++i) {
      ImuSample truth = RandomSample(random, true);
      truth.stamp.tool_time.ns = i * std::int64_t{10'000'000};
      raw.push_back(counter.Count(truth, 50.0 + i / 40 + noise * random.Normal()));
    }
    std::vector<ImuSample> whole(raw.size()), cut(raw.size());
    SampleCalibrator one(tool), other(tool);
    ASSERT_EQ(one.Apply(raw, whole), raw.size());
    for (std::size_t begin = 0, n = 1; begin < raw.size(); begin += n, n = n % 7 + 1) {
      n = std::min(n, raw.size() - begin);
      ASSERT_EQ(other.Apply(std::span(raw).subspan(begin, n), std::span(cut).subspan(begin, n)), n);
    }
    for (std::size_t i = 0; i < raw.size(); ++i) {
      EXPECT_EQ(whole[i].w_IT_T, cut[i].w_IT_T);
      EXPECT_EQ(whole[i].f_T, cut[i].f_T);
      EXPECT_EQ(whole[i].b_T, cut[i].b_T);
      EXPECT_EQ(whole[i].stamp.temperature, cut[i].stamp.temperature);
    }
  }
}

// Channels that count pulses over periods that are never the same: as channels that do not, of
// units that have each sample's period in them.
TEST(Apply, PulsesArePerSecondOfTheirOwnSample) {
  const ToolCalibration plain = RandomTool(19, {.temperature = true});
  ToolCalibration pulses = plain;
  pulses.accel.per_second = true;
  Random random(20);
  RawCounter counter(plain);
  SampleCalibrator calibrator(pulses);
  std::vector<RawSample> raw;
  for (int i = 0; i < 100; ++i) {
    raw.push_back(counter.Count(RandomSample(random, true), 60 + 0.05 * i));
    raw.back().stamp.period_ns = 900'000'000 + static_cast<std::int32_t>(2e8 * random.Uniform());
  }
  std::vector<ImuSample> out(raw.size());
  ASSERT_EQ(calibrator.Apply(raw, out), raw.size());
  for (std::size_t i = 0; i < raw.size(); ++i) {
    ToolCalibration of_period = plain;
    of_period.accel.unit_per_count /= 1e-9 * raw[i].stamp.period_ns;
    const ImuSample expected = Calibrate(of_period, raw[i]);
    EXPECT_LT((out[i].f_T - expected.f_T).norm(), 1e-9 * units::kStandardGravity);
    EXPECT_EQ(out[i].w_IT_T, expected.w_IT_T);
  }
}

TEST(Apply, StopsAtASampleThatLacksChannels) {
  const ToolCalibration tool = RandomTool(15, {});
  std::array<RawSample, 3> raw;
  for (RawSample& sample : raw) sample.n_channels = 10, sample.n_temperatures = 2;
  raw[1].n_channels = 9;
  raw[1].stamp.seq = 77;
  std::array<ImuSample, 3> out;
  SampleCalibrator calibrator(tool);
  EXPECT_EQ(calibrator.Apply(raw, out), 1u);
  EXPECT_EQ(calibrator.WhyNot(raw[1]), "sample 77 has 9 channels where the tool model needs 10");
  raw[1].n_channels = 10;
  raw[1].n_temperatures = 1;
  EXPECT_EQ(calibrator.WhyNot(raw[1]), "sample 77 has 1 thermometers where the tool model needs 2");
  EXPECT_THROW(calibrator.Apply(raw, std::span(out).first(2)), std::invalid_argument);
}

TEST(Apply, AllocatesNothing) {
  const ToolCalibration tool = RandomTool(16, {.gyro_channels = 4,
                                               .temperature = true,
                                               .second_order = true,
                                               .g_terms = true,
                                               .rotated = true});
  Random random(17);
  RawCounter counter(tool);
  std::vector<RawSample> raw;
  for (int i = 0; i < 100; ++i)
    raw.push_back(counter.Count(RandomSample(random, true), 50 + 0.1 * i));
  std::vector<ImuSample> out(raw.size());
  SampleCalibrator calibrator(tool);
  const long before = AllocationCount();
  calibrator.Apply(raw, out);
  EXPECT_EQ(AllocationCount(), before);
}

}  // namespace
}  // namespace wellgyro

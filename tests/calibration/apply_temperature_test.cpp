#include <algorithm>
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "wellgyro/base/units.h"
#include "wellgyro/calibration/apply.h"
#include "wellgyro/calibration/thermometer.h"
#include "wellgyro/simulate/raw_counts.h"

#include "calibration/calibrated.h"
#include "calibration/random_tool.h"
#include "calibration/simple_calibration.h"

namespace wellgyro {
namespace {

using test::Calibrate;
using test::RandomSample;
using test::RandomTool;
using test::SimpleSolution;
using test::SolveSimply;

// A thermometer that reads anew with every sample, over the whole range, where what goes with
// temperature goes as far as its cube: against the formula solved at each sample's own.
TEST(Apply, TemperaturesBetweenThoseSolvedInFullAreRightToABillionth) {
  double worst = 0;
  for (const int channels : {3, 4}) {
    ToolCalibration tool = RandomTool(
        24, {.gyro_channels = channels, .temperature = true, .g_terms = true, .rotated = true});
    Random random(25);
    for (std::size_t n = 1; n < SensorGroup::kPowers; ++n) {
      tool.gyro.g_dependence[n] = 0.2 * tool.gyro.g_dependence[0];
    }
    tool.accel.second_order.setConstant(2e-6);
    RawCounter counter(tool);
    SampleCalibrator calibrator(tool);
    for (int i = 0; i < 500; ++i) {
      const ImuSample sample = RandomSample(random, true);
      const RawSample raw = counter.Count(sample, 20 + 140 * random.Uniform());
      ImuSample found;
      ASSERT_EQ(calibrator.Apply({&raw, 1}, {&found, 1}), 1u);
      const double temperature =
          TrueTemperature(tool.thermometers[0], static_cast<double>(raw.temperature_raw[1])).value;
      const auto check = [&](const SensorGroup& group, const Eigen::Vector3d& u, double unit) {
        const SimpleSolution simple = SolveSimply(group, raw, temperature, found.f_T);
        const double allowed =
            1e-9 * std::max(simple.u.norm(), unit) + (1e-5 + std::pow(2.0, -20)) * simple.small;
        worst = std::max(worst, (u - simple.u).cwiseAbs().maxCoeff() / allowed);
      };
      check(tool.gyro, found.w_IT_T, units::kDeg);
      check(tool.accel, found.f_T, units::kStandardGravity);
      check(tool.mag, found.b_T, 5e-5);
    }
  }
  EXPECT_LT(worst, 1);
  EXPECT_GT(worst, 0.01);
}

// Beyond the range what is calibrated stays, so that it bends where the range ends.
TEST(Apply, TemperaturesAtTheEndsOfTheRangeAreRightToABillionth) {
  const ToolCalibration tool = RandomTool(26, {.temperature = true});
  Random random(27);
  RawCounter counter(tool);
  SampleCalibrator calibrator(tool);
  double worst = 0;
  for (int i = 0; i < 400; ++i) {
    const double beyond = 0.2 * (random.Uniform() - 0.5);
    const RawSample raw =
        counter.Count(RandomSample(random, true), (i % 2 == 0 ? 20 : 160) + beyond);
    ImuSample found;
    ASSERT_EQ(calibrator.Apply({&raw, 1}, {&found, 1}), 1u);
    const double temperature =
        TrueTemperature(tool.thermometers[0], static_cast<double>(raw.temperature_raw[1])).value;
    EXPECT_EQ(found.stamp.temperature_outside, temperature < 20 || temperature > 160);
    const Eigen::Vector3d u = SolveSimply(tool.accel, raw, temperature, found.f_T).u;
    worst = std::max(
        worst, (found.f_T - u).cwiseAbs().maxCoeff() / std::max(u.norm(), units::kStandardGravity));
  }
  EXPECT_LT(worst, 1e-9);
  EXPECT_GT(worst, 0);
}

TEST(Apply, ANewSessionBeginsWithoutHeating) {
  ToolCalibration tool = RandomTool(23, {.temperature = true});
  tool.gyro.heating.setConstant(0.5);
  SampleCalibrator calibrator(tool), fresh(tool);
  RawSample raw;
  raw.n_channels = 10;
  raw.n_temperatures = 2;
  raw.stamp.period_ns = 50'000'000;
  ImuSample out, first;
  for (int i = 0; i < 50; ++i) {
    raw.stamp.tool_time.ns += 50'000'000;
    raw.temperature_raw[1] = static_cast<float>(1.1 + 0.001 * i);
    ASSERT_EQ(calibrator.Apply({&raw, 1}, {&out, 1}), 1u);
  }
  raw.stamp.session = 1;
  raw.temperature_raw[1] = 1.3F;
  ASSERT_EQ(fresh.Apply({&raw, 1}, {&first, 1}), 1u);
  EXPECT_NE(out.w_IT_T, first.w_IT_T);
  ASSERT_EQ(calibrator.Apply({&raw, 1}, {&out, 1}), 1u);
  EXPECT_EQ(out.w_IT_T, first.w_IT_T);
}

TEST(Apply, TakesTheHeatingRateFromALaggedTemperature) {
  ToolCalibration tool = RandomTool(9, {.temperature = true});
  tool.thermometers[0] = {.channel = 0};
  tool.gyro.heating.setConstant(0.5);
  tool.gyro.heating_lag = 20;
  // Sensitivity to temperature aside, a ramp of r shows as h r (1 - exp(-t / lag)).
  for (std::size_t n = 1; n < SensorGroup::kPowers; ++n) {
    tool.gyro.bias[n].setZero();
    tool.gyro.sensitivity[n].setZero();
  }
  ToolCalibration cold = tool;
  cold.gyro.heating.setZero();
  SampleCalibrator calibrator(tool), without(cold);
  const double ramp = 0.02, step = 0.05;
  RawSample raw;
  raw.n_channels = 10;
  raw.n_temperatures = 1;
  raw.stamp.period_ns = 50'000'000;
  Eigen::Matrix3d S = tool.gyro.sensitivity[0].topRows<3>();
  for (int i = 0; i < 2000; ++i) {
    raw.stamp.tool_time.ns = i * std::int64_t{50'000'000};
    raw.temperature_raw[0] = static_cast<float>(60 + ramp * step * i);
    ImuSample hot, plain;
    ASSERT_EQ(calibrator.Apply({&raw, 1}, {&hot, 1}), 1u);
    ASSERT_EQ(without.Apply({&raw, 1}, {&plain, 1}), 1u);
    if (i % 400 != 399) continue;
    const Eigen::Vector3d seen = S * (plain.w_IT_T - hot.w_IT_T);
    const double expected = 0.5 * ramp * (1 - std::exp(-i * step / 20));
    // The steps of the ramp and the thermometer's float.
    for (const double unit : seen) EXPECT_NEAR(unit, expected, 0.003 * expected);
  }
}

TEST(Apply, FlagsTemperaturesBeyondTheCalibratedAndHoldsTheirEnd) {
  const ToolCalibration tool = RandomTool(11, {.temperature = true});
  Random random(12);
  const ImuSample truth = RandomSample(random, true);
  RawCounter counter(tool);
  RawSample inside = counter.Count(truth, 159.99), above = inside, far = inside, none = inside;
  above.temperature_raw[1] = static_cast<float>(RawTemperature(tool.thermometers[0], 165));
  far.temperature_raw[1] = 50;  // beyond what the thermometer itself is calibrated for
  none.temperature_raw[1] = std::nanf("");
  const ImuSample at_end = Calibrate(tool, inside);
  EXPECT_FALSE(at_end.stamp.temperature_outside);
  for (const RawSample& raw : {above, far}) {
    const ImuSample found = Calibrate(tool, raw);
    EXPECT_TRUE(found.stamp.temperature_outside);
    EXPECT_LT((found.f_T - at_end.f_T).norm(), 1e-3);
    EXPECT_GT((found.f_T - at_end.f_T).norm(), 0);
  }
  const ImuSample found = Calibrate(tool, none);
  EXPECT_TRUE(found.stamp.temperature_outside);
  EXPECT_TRUE(found.f_T.allFinite());
}

}  // namespace
}  // namespace wellgyro

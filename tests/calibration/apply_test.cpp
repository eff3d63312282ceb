#include "wellgyro/calibration/apply.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "wellgyro/calibration/error_sources.h"
#include "wellgyro/calibration/thermometer.h"
#include "wellgyro/simulate/raw_counts.h"

#include "calibration/random_tool.h"
#include "calibration/simple_calibration.h"
#include "simulate/allocation_count.h"

namespace wellgyro {
namespace {

using test::RandomSample;
using test::RandomTool;
using test::SimpleSolution;
using test::SolveSimply;
using test::ToolShape;

ImuSample Calibrate(const ToolCalibration& tool, const RawSample& raw) {
  SampleCalibrator calibrator(tool);
  ImuSample out;
  EXPECT_EQ(calibrator.Apply({&raw, 1}, {&out, 1}), 1u);
  return out;
}

// Counts of 1e-8 V at some volts: rounding them leaves 2e-9 of full scale and the thermometer's
// float as much again.
void ExpectSame(const ImuSample& found, const ImuSample& truth) {
  EXPECT_LT((found.w_IT_T - truth.w_IT_T).norm(), 1e-8 * 1.0);
  EXPECT_LT((found.f_T - truth.f_T).norm(), 1e-8 * 30);
  EXPECT_LT((found.b_T - truth.b_T).norm(), 1e-8 * 1e-4);
}

TEST(Apply, UndoesWhatTheToolDoesToItsSensors) {
  std::uint64_t seed = 0;
  for (const ToolShape& shape :
       {ToolShape{}, ToolShape{.gyro_channels = 2}, ToolShape{.gyro_channels = 4},
        ToolShape{.temperature = true}, ToolShape{.second_order = true}, ToolShape{.g_terms = true},
        ToolShape{.rotated = true},
        ToolShape{.gyro_channels = 4,
        .temperature = true,
        .second_order = true,
        .g_terms = true,
        .rotated = true}}) {
    SCOPED_TRACE(++seed);
    const ToolCalibration tool = RandomTool(seed, shape);
    Random random(seed + 100);
    for (int i = 0; i < 50; ++i) {
      const ImuSample truth = RandomSample(random, shape.gyro_channels > 2);
      const double temperature = 25 + 130 * random.Uniform();
      RawCounter counter(tool);
      const ImuSample found = Calibrate(tool, counter.Count(truth, temperature));
      ExpectSame(found, truth);
      EXPECT_FALSE(found.stamp.temperature_outside);
      EXPECT_EQ(found.has_gz, shape.gyro_channels > 2);
      EXPECT_TRUE(found.has_mag);
      EXPECT_NEAR(static_cast<double>(found.stamp.temperature), temperature, 2e-5);
    }
  }
}

// Two gyros whose axes lean out of their plane: what their samples keep of the axial rate is told.
TEST(Apply, TwoGyrosKeepWhatTheySeeOfTheThirdAxis) {
  ToolCalibration tool = RandomTool(9, {.gyro_channels = 2});
  tool.gyro.sensitivity[0].topRows<2>() *=
      Eigen::AngleAxisd(2e-3, Eigen::Vector3d(3, 4, 0) / 5).toRotationMatrix();
  const Eigen::Vector2d known = AxialCoupling(tool.gyro);
  EXPECT_NEAR(known.norm(), 2e-3, 1e-4);
  RawCounter counter(tool);
  Random random(10);
  for (int i = 0; i < 20; ++i) {
    const ImuSample truth = RandomSample(random, true);
    const ImuSample found = Calibrate(tool, counter.Count(truth, 25));
    const Eigen::Vector2d kept = truth.w_IT_T.head<2>() + known * truth.w_IT_T.z();
    EXPECT_LT((found.w_IT_T.head<2>() - kept).norm(), 1e-8);
  }
  EXPECT_EQ(AxialCoupling(RandomTool(9, {}).gyro), Eigen::Vector2d::Zero());
}

TEST(Apply, FollowsTheFormulaOfAToolWrittenByHand) {
  ToolCalibration tool;
  tool.accel.n_channels = 3;
  tool.accel.channel = {2, 0, 1};
  tool.accel.unit_per_count.setConstant(1e-3);
  tool.accel.bias[0] << 0.5, -0.25, 0.125, 0;
  tool.accel.sensitivity[0].topRows<3>() = Eigen::Vector3d(2, 4, 8).asDiagonal();
  // Sensors of the trade's axes, giving gravity: T.x = -y, T.y = x, T.z = -z of them.
  tool.accel.R_TS << 0, -1, 0, 1, 0, 0, 0, 0, -1;
  RawSample raw;
  raw.n_channels = 3;
  raw.counts = {-8250, 40125, 4500};  // y: -8.25 V, z: 40.125 V, x: 4.5 V
  EXPECT_EQ(Calibrate(tool, raw).f_T, Eigen::Vector3d(2, 2, -5));
}

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

// What u leaves of the channels' formula, over its size: a fiftieth of the finest count at most,
// 2^-31 of full scale, however large the second order, beside samples of any size.
TEST(Apply, SecondOrderIsSolvedToAFiftiethOfACount) {
  for (const double size : {1e-5, 1e-3, 0.03, 0.19}) {
    Random random(31);
    ToolCalibration tool;
    SensorGroup& accel = tool.accel;
    accel.n_channels = 3;
    accel.channel = {0, 1, 2};
    accel.unit_per_count.setConstant(1e-8);
    accel.sensitivity[0].topRows<3>().setIdentity();
    // Rows whose sums are `size` at 1, which is full scale.
    for (int c = 0; c < 3; ++c) {
      for (int p = 0; p < 6; ++p) accel.second_order(c, p) = random.Normal();
      accel.second_order.row(c) *= size / accel.second_order.row(c).cwiseAbs().sum();
    }
    std::vector<RawSample> raw(64);
    for (RawSample& sample : raw) {
      sample.n_channels = 3;
      const double scale = std::pow(10, -3 * random.Uniform());
      for (std::size_t c = 0; c < 3; ++c) {
        sample.counts[c] = static_cast<std::int32_t>(1e8 * scale * (2 * random.Uniform() - 1));
      }
    }
    std::vector<ImuSample> out(raw.size());
    SampleCalibrator calibrator(tool);
    ASSERT_EQ(calibrator.Apply(raw, out), raw.size());
    for (std::size_t i = 0; i < raw.size(); ++i) {
      const Eigen::Vector3d& u = out[i].f_T;
      Eigen::Matrix<double, 6, 1> q;
      q << u.x() * u.x(), u.y() * u.y(), u.z() * u.z(), u.x() * u.y(), u.y() * u.z(), u.z() * u.x();
      for (int c = 0; c < 3; ++c) {
        const double v = 1e-8 * raw[i].counts[static_cast<std::size_t>(c)];
        EXPECT_NEAR(u[c] + accel.second_order.row(c).dot(q), v, 2e-11 * u.cwiseAbs().maxCoeff())
            << size;
      }
    }
  }
}

// Terms in the force, in its products and in heating are summed in single precision: to 2^-20 of
// the largest of them at most, against the formula in double.
TEST(Apply, SmallTermsAreRightToAMillionthOfThemselves) {
  ToolCalibration tool = RandomTool(21, {.g_terms = true});
  ToolCalibration without = tool;
  without.gyro.g_dependence[0].setZero();
  without.gyro.g_squared.setZero();
  SampleCalibrator whole(tool), bare(without);
  const Eigen::Matrix3d inverse = tool.gyro.sensitivity[0].topRows<3>().inverse();
  RawCounter counter(tool);
  Random random(22);
  double worst = 0;
  for (int i = 0; i < 500; ++i) {
    const RawSample raw = counter.Count(RandomSample(random, true), 20);
    ImuSample found, plain;
    ASSERT_EQ(whole.Apply({&raw, 1}, {&found, 1}), 1u);
    ASSERT_EQ(bare.Apply({&raw, 1}, {&plain, 1}), 1u);
    const Eigen::Vector3d& f = found.f_T;
    Eigen::Matrix<double, 6, 1> q;
    q << f.x() * f.x(), f.y() * f.y(), f.z() * f.z(), f.x() * f.y(), f.y() * f.z(), f.z() * f.x();
    const Eigen::Matrix3d G = inverse * tool.gyro.g_dependence[0].topRows<3>();
    const Eigen::Matrix<double, 3, 6> N = inverse * tool.gyro.g_squared.topRows<3>();
    const double largest = std::max((G.cwiseAbs() * f.cwiseAbs()).maxCoeff(),
                                    (N.cwiseAbs() * q.cwiseAbs()).maxCoeff());
    const Eigen::Vector3d expected = plain.w_IT_T - (G * f + N * q);
    worst = std::max(worst, (found.w_IT_T - expected).cwiseAbs().maxCoeff() / largest);
  }
  EXPECT_LT(worst, std::pow(2.0, -20));
  EXPECT_GT(worst, 0);
}

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

TEST(Apply, ParityShowsAChannelThatDoesNotBelong) {
  const ToolCalibration tool =
      RandomTool(13, {.gyro_channels = 4, .temperature = true, .g_terms = true, .rotated = true});
  Random random(14);
  SampleCalibrator calibrator(tool);
  for (int i = 0; i < 20; ++i) {
    RawCounter counter(tool);
    RawSample raw = counter.Count(RandomSample(random, true), 80);
    ImuSample out;
    ASSERT_EQ(calibrator.Apply({&raw, 1}, {&out, 1}), 1u);
    // Of some volts, with counts of 1e-8 V.
    EXPECT_LT(std::abs(*calibrator.Parity(raw)), 1e-7);
    // Channel 3 is minus channel 0: half of what one of them says wrong is parity, over sqrt(2).
    raw.counts[static_cast<std::size_t>(tool.gyro.channel[3])] += 1'000'000;
    const double moved = 1'000'000 * tool.gyro.unit_per_count[3];
    EXPECT_NEAR(std::abs(*calibrator.Parity(raw)), moved / std::sqrt(2.0), 0.03 * moved);
  }
  EXPECT_FALSE(SampleCalibrator(RandomTool(1, {})).Parity(RawSample{}).has_value());
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

TEST(Apply, RefusesModelsThatCannotBeUsed) {
  const auto complaint = [](auto&& spoil) {
    ToolCalibration tool = RandomTool(18, {.temperature = true});
    spoil(tool);
    EXPECT_THROW(SampleCalibrator{tool}, std::invalid_argument);
    return FindComplaint(tool).value_or("");
  };
  EXPECT_FALSE(FindComplaint(RandomTool(18, {.temperature = true})).has_value());
  using Tool = ToolCalibration;
  EXPECT_EQ(complaint([](Tool& t) { t.accel.channel[1] = 16; }),
            "accel: channel 16 is outside 0 to 15");
  EXPECT_EQ(complaint([](Tool& t) { t.accel.channel[1] = t.accel.channel[0]; }),
            "accel: channel 6 is named twice");
  EXPECT_EQ(complaint([](Tool& t) { t.gyro.sensitivity[0].setZero(); }),
            "gyro: the sensitivities do not separate the axes");
  EXPECT_EQ(complaint([](Tool& t) { t.mag.R_TS(0, 0) = 2; }),
            "mag: the axes are not at right angles");
  EXPECT_EQ(complaint([](Tool& t) { t.mag.thermometer = -1; }),
            "mag: terms in temperature, but no thermometer");
  EXPECT_EQ(complaint([](Tool& t) { t.mag.unit_per_count[2] = 0; }),
            "mag: unit_per_count of channel 7 is 0");
  EXPECT_EQ(complaint([](Tool& t) {
              t.accel = {};
              t.gyro.g_dependence[0](0, 0) = 1;
            }),
            "gyro: terms in the specific force, but no accelerometers");
}

}  // namespace
}  // namespace wellgyro

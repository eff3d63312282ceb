#include "wellgyro/calibration/apply.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "wellgyro/calibration/error_sources.h"
#include "wellgyro/simulate/raw_counts.h"

#include "calibration/calibrated.h"
#include "calibration/random_tool.h"

namespace wellgyro {
namespace {

using test::Calibrate;
using test::RandomSample;
using test::RandomTool;
using test::ToolShape;

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

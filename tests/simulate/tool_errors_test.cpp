#include "wellgyro/simulate/tool_errors.h"

#include <cmath>

#include <gtest/gtest.h>

#include "wellgyro/math/statistics.h"

#include "cases.h"

namespace wellgyro {
namespace {

ImuSample Measure(const Truth& truth, const SimulatedTool& tool, double begin, double end) {
  SensorErrors errors(tool, 77);
  ImuSample sample;
  errors.Measure(truth, begin, end, sample);
  return sample;
}

TEST(SensorErrors, WithoutErrorsTheSampleIsTheTruth) {
  const Truth truth(WeavingRun());
  const SimulatedTool tool{.has_gz = true, .has_mag = true};
  for (const double t : {10.0, 64.2, 133.0, 800.0}) {
    const SensorTruth mean = truth.MeanOver(t, t + 0.01);
    const ImuSample sample = Measure(truth, tool, t, t + 0.01);
    EXPECT_EQ(sample.w_IT_T, mean.w_IT_T);
    EXPECT_EQ(sample.f_T, mean.f_T);
    EXPECT_EQ(sample.b_T, mean.b_T);
    EXPECT_FALSE(sample.stamp.gyro_saturated || sample.stamp.accel_saturated);
  }
}

TEST(SensorErrors, EachDoesWhatItIsNamedAfter) {
  const Truth truth(WeavingRun());
  const double t = 700;
  const SensorTruth mean = truth.MeanOver(t, t + 0.1);
  const Eigen::Vector3d &w = mean.w_IT_T, &f = mean.f_T;
  const auto rate = [&](const ToolErrors& e) -> Eigen::Vector3d {
    return Measure(truth, {.has_gz = true, .errors = e}, t, t + 0.1).w_IT_T - w;
  };
  const auto force = [&](const ToolErrors& e) -> Eigen::Vector3d {
    return Measure(truth, {.errors = e}, t, t + 0.1).f_T - f;
  };
  const auto expect = [](const Eigen::Vector3d& got, const Eigen::Vector3d& want) {
    EXPECT_LT((got - want).norm(), 1e-14) << got.transpose() << " | " << want.transpose();
  };
  const Eigen::Vector3d three(1e-6, -2e-6, 3e-6);
  expect(rate({.gyro_bias = three}), three);
  expect(rate({.gyro_scale = three}), three.cwiseProduct(w));
  expect(rate({.gyro_misalignment = {1e-3, -2e-3}}), {1e-3 * w.z(), -2e-3 * w.z(), 0});
  expect(rate({.mass_unbalance = 1e-7}), {1e-7 * f.x(), 1e-7 * f.y(), 0});
  expect(rate({.quadrature = 1e-7}), {1e-7 * f.y(), -1e-7 * f.x(), 0});
  expect(force({.accel_bias = three}), three);
  expect(force({.accel_scale = three}), three.cwiseProduct(f));
  Eigen::Matrix3d leaning;
  leaning << 0, 1e-6, 2e-6, 3e-6, 0, 4e-6, 5e-6, 6e-6, 0;
  expect(force({.accel_misalignment = leaning}),
         {1e-6 * f.y() + 2e-6 * f.z(), 3e-6 * f.x() + 4e-6 * f.z(), 5e-6 * f.x() + 6e-6 * f.y()});
  EXPECT_GT(std::abs(w.z()), 0.1);
}

double Toolface(const Eigen::Vector3d& f) { return std::atan2(-f.y(), f.x()); }

TEST(SensorErrors, RollOffsetReadsTheToolfaceTooLarge) {
  const Truth truth(AtRest(0.6, 1, 0.4, 20));
  const ImuSample sample = Measure(truth, {.errors = {.roll_offset = 0.01}}, 5, 6);
  EXPECT_NEAR(Toolface(sample.f_T), 0.41, 1e-14);
}

TEST(SensorErrors, TimeSkewReadsTheAccelerometersLater) {
  const Truth truth(WeavingRun());
  const ImuSample sample = Measure(truth, {.errors = {.time_skew = 0.02}}, 700, 700.01);
  EXPECT_EQ(sample.f_T, truth.MeanOver(700.02, 700.03).f_T);
  EXPECT_EQ(sample.w_IT_T.head<2>(), truth.MeanOver(700, 700.01).w_IT_T.head<2>());
}

TEST(SensorErrors, SaturationClipsAndSaysSo) {
  const Truth truth(WeavingRun());
  const ImuSample gyro =
      Measure(truth, {.has_gz = true, .errors = {.gyro_full_scale = 0.1}}, 700, 700.01);
  EXPECT_TRUE(gyro.stamp.gyro_saturated);
  EXPECT_FALSE(gyro.stamp.accel_saturated);
  EXPECT_EQ(gyro.w_IT_T.z(), 0.1);
  // Without the third axis nobody sees that it would saturate.
  EXPECT_FALSE(
      Measure(truth, {.errors = {.gyro_full_scale = 0.1}}, 700, 700.01).stamp.gyro_saturated);
  const ImuSample accel = Measure(truth, {.errors = {.accel_full_scale = 5}}, 30, 30.01);
  EXPECT_TRUE(accel.stamp.accel_saturated);
  EXPECT_EQ(accel.f_T.z(), -5);
}

TEST(SensorErrors, NoiseOfTheAccelerometersFillsItsBand) {
  const Truth truth(AtRest(0.6, 1, 0.4, 300));
  const double noise = 5e-4, dt = 0.25;
  SensorErrors errors({.errors = {.accel_noise = noise}}, 5);
  const Eigen::Vector3d rest = truth.MeanOver(0, dt).f_T;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  const int n = 1000;
  for (int i = 0; i < n; ++i) {
    ImuSample sample;
    errors.Measure(truth, i * dt, (i + 1) * dt, sample);
    sum += (sample.f_T - rest).cwiseAbs2() / (noise * noise / dt);
  }
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_GT(sum[axis], ChiSquareQuantile(1e-5, n));
    EXPECT_LT(sum[axis], ChiSquareQuantile(1 - 1e-5, n));
  }
}

TEST(DrawToolErrors, FillsThePriorsOverManyTools) {
  const ErrorPriors priors{.gyro_bias_sigma = 1,
                           .mass_unbalance_sigma = 2,
                           .quadrature_sigma = 3,
                           .gyro_scale_sigma = 4,
                           .gyro_misalignment_sigma = 5,
                           .accel_bias_sigma = 6,
                           .accel_scale_sigma = 11,
                           .accel_misalignment_sigma = 12,
                           .accel_noise = 7,
                           .roll_offset_sigma = 8,
                           .time_skew_sigma = 9,
                           .depth_sigma = 10,
                           .depth_scale_sigma = 13};
  const int tools = 2000;
  double chi2[26] = {};
  for (int tool = 0; tool < tools; ++tool) {
    const ToolErrors e =
        DrawToolErrors(priors, {.angle_random_walk = 11}, static_cast<std::uint64_t>(tool));
    const double drawn[26] = {e.gyro_bias.x(),
                              e.gyro_bias.y(),
                              e.gyro_bias.z(),
                              e.mass_unbalance / 2,
                              e.quadrature / 3,
                              e.gyro_scale.x() / 4,
                              e.gyro_scale.y() / 4,
                              e.gyro_scale.z() / 4,
                              e.gyro_misalignment.x() / 5,
                              e.gyro_misalignment.y() / 5,
                              e.accel_bias.x() / 6,
                              e.accel_bias.y() / 6,
                              e.accel_bias.z() / 6,
                              e.roll_offset / 8,
                              e.time_skew / 9,
                              e.depth_offset / 10,
                              e.depth_scale / 13,
                              e.accel_scale.x() / 11,
                              e.accel_scale.y() / 11,
                              e.accel_scale.z() / 11,
                              e.accel_misalignment(0, 1) / 12,
                              e.accel_misalignment(0, 2) / 12,
                              e.accel_misalignment(1, 0) / 12,
                              e.accel_misalignment(1, 2) / 12,
                              e.accel_misalignment(2, 0) / 12,
                              e.accel_misalignment(2, 1) / 12};
    for (int i = 0; i < 26; ++i) chi2[i] += drawn[i] * drawn[i];
    EXPECT_EQ(e.accel_noise, 7);
    EXPECT_EQ(e.gyro_noise.angle_random_walk, 11);
  }
  for (const double x : chi2) {
    EXPECT_GT(x, ChiSquareQuantile(1e-5, tools));
    EXPECT_LT(x, ChiSquareQuantile(1 - 1e-5, tools));
  }
}

}  // namespace
}  // namespace wellgyro

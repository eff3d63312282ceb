#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/alignment/gyrocompass.h"
#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/math/random.h"
#include "wellgyro/math/statistics.h"

#include "alignment/tool_at_rest.h"

namespace wellgyro {
namespace {

using test::kOmega;
using test::Sigma;
using test::ToolAtRest;
using units::kDeg;
using units::kDegPerHour;

TEST(Gyrocompass, BiasInstabilityIsAFloorThatNoLongWindowPasses) {
  Random random(11);
  ToolAtRest truth{.gyro_noise = 1e-4 * kDegPerHour};
  NoiseCoefficients gyro{.bias_instability = 0.05 * kDegPerHour};
  const auto sigma = [&](std::vector<double> toolfaces) {
    return ToDegrees(
        Sigma(Gyrocompass(truth.Windows(toolfaces, random), truth.Place(), {.gyro = gyro})));
  };
  const double constant = sigma({0.3}), paired = sigma({0.3, 0.3 + kPi});
  EXPECT_NEAR(constant, 0.05 / 7.52 / kDeg * std::sqrt(1 / (0.5 + 0.5 * 0.75)), 0.01);
  EXPECT_LT(paired, 0.01 * constant) << "a constant cancels";
  gyro.bias_instability_correlation_time = 600;
  EXPECT_NEAR(sigma({0.3}), 1.075 * constant, 0.01);
  // exp(-210/600) = 0.705 of it cancels.
  EXPECT_NEAR(sigma({0.3, 0.3 + kPi}), 1.075 * constant * std::sqrt((1 - 0.705) / 2), 0.01);
}

TEST(Gyrocompass, GravityAndEarthRateAreCheckedAgainstTheirOwnSigma) {
  Random random(12);
  ToolAtRest truth{.gyro_noise = 0.02 * kDegPerHour, .accel_noise = 1e-4};
  const auto quality = [&](const ToolAtRest& t) {
    return Gyrocompass(t.Windows({0.3}, random), truth.Place(), {}).quality;
  };
  EXPECT_EQ(quality(truth), Quality::kGood);
  ToolAtRest heavy = truth;
  heavy.accel_bias = {0, 0, -0.01};
  EXPECT_TRUE(Has(quality(heavy), Quality::kGravity));
  ToolAtRest biased = truth;
  biased.bias_x = 0.5 * kDegPerHour;
  EXPECT_TRUE(Has(quality(biased), Quality::kEarthRate));
  EXPECT_FALSE(Has(quality(biased), Quality::kGravity));
}

// Biases, scales and misalignments of the accelerometers and gravity itself, at one toolface and at
// three, where part of them cancels.
TEST(Gyrocompass, GravityIsOffAsItsSigmaSays) {
  Random random(21);
  const ErrorPriors errors{
      .accel_bias_sigma = 5e-4, .accel_scale_sigma = 7e-5, .accel_misalignment_sigma = 1.5e-4};
  const auto three = [&random](double sigma) {
    return Eigen::Vector3d{sigma * random.Normal(), sigma * random.Normal(),
                           sigma * random.Normal()};
  };
  constexpr int kTools = 400;
  for (const std::vector<double>& toolfaces : {std::vector{0.7}, {0.7, 2.0, 4.5}}) {
    double squares = 0;
    for (int tool = 0; tool < kTools; ++tool) {
      const ToolAtRest truth{
          .inclination = kPi * random.Uniform(), .gyro_noise = 1e-7, .accel_noise = 3e-4};
      std::vector<StillWindow> windows = truth.Windows(toolfaces, random);
      Eigen::Matrix3d A;
      A << three(1.5e-4), three(1.5e-4), three(1.5e-4);
      A.diagonal() = three(7e-5);
      const Eigen::Vector3d bias = three(5e-4);
      for (StillWindow& window : windows) window.f_T += (A * window.f_T).eval() + bias;
      Site place = truth.Place();
      place.gravity += 5e-4 * random.Normal();
      const NorthFix fix = Gyrocompass(windows, place, {.errors = errors});
      squares += std::pow((fix.gravity - fix.gravity_ref) / fix.sigma_gravity, 2);
    }
    EXPECT_GT(squares, ChiSquareQuantile(5e-4, kTools)) << toolfaces.size();
    EXPECT_LT(squares, ChiSquareQuantile(1 - 5e-4, kTools)) << toolfaces.size();
  }
}

TEST(Gyrocompass, TheFixCarriesItsWindows) {
  Random random(13);
  const ToolAtRest truth{.gyro_noise = 0.02 * kDegPerHour, .accel_noise = 1e-4};
  auto windows = truth.Windows({0.3, 2.0}, random);
  windows[0].seq_begin = 500;
  windows[1].seq_end = 900;
  windows[1].md = 1234.5;
  windows[0].quality = Quality::kSaturated;
  const NorthFix fix = Gyrocompass(windows, truth.Place(), {});
  EXPECT_EQ(fix.seq_begin, 500);
  EXPECT_EQ(fix.seq_end, 900);
  EXPECT_EQ(fix.md, 1234.5);
  EXPECT_EQ(fix.begin, windows[0].begin);
  EXPECT_EQ(fix.end, windows[1].end);
  EXPECT_TRUE(fix.from_samples);
  EXPECT_FALSE(fix.external);
  EXPECT_TRUE(Has(fix.quality, Quality::kSaturated));
  EXPECT_NEAR(WrapPi(fix.toolface - 2), 0, 1e-3);
}

// Two gyros that see two and three thousandths of the axial rate: known, it takes nothing off the
// azimuth; unknown, some of it.
TEST(Gyrocompass, WhatIsKnownOfTheAxialRateIsNoError) {
  Random random(16);
  const ToolAtRest truth{.inclination = 70 * kDeg, .azimuth = 40 * kDeg};
  auto windows = truth.Windows({20 * kDeg}, random);
  const double sL = std::sin(truth.latitude), cL = std::cos(truth.latitude);
  const double axial = kOmega * (cL * std::cos(truth.azimuth) * std::sin(truth.inclination) -
                                 sL * std::cos(truth.inclination));
  windows[0].w_IT_T += Eigen::Vector3d(2e-3 * axial, -3e-3 * axial, 0);
  GyrocompassSetup setup;
  const double off = WrapPi(Gyrocompass(windows, truth.Place(), setup).azimuth - truth.azimuth);
  EXPECT_GT(std::abs(off), 1e-4);
  setup.errors.gyro_misalignment_x = 2e-3;
  setup.errors.gyro_misalignment_y = -3e-3;
  const NorthFix known = Gyrocompass(windows, truth.Place(), setup);
  EXPECT_NEAR(WrapPi(known.azimuth - truth.azimuth), 0, 1e-6);
}

}  // namespace
}  // namespace wellgyro

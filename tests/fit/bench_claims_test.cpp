// What each bench method is said to do, on generated runs.
#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "wellgyro/base/units.h"
#include "wellgyro/fit/affine_fit.h"
#include "wellgyro/fit/gyro_fit.h"
#include "wellgyro/fit/multi_station_fit.h"
#include "wellgyro/fit/position_fit.h"
#include "wellgyro/fit/scalar_fit.h"
#include "wellgyro/fit/settled_run.h"

#include "fit/attitude_simulation.h"
#include "fit/bench_simulation.h"
#include "fit/truth_file.h"

namespace wellgyro::test {
namespace {

TEST(TwentyFourPositions, TiltOfTheBenchLeavesTheBias) {
  // Up to half a degree, with second-order terms of 20 ug/g^2.
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Random random(seed);
    const VoltTool tool = VoltTool::Any(random);
    const double lean = 0.5 * std::sqrt(random.Uniform()), to = 360 * random.Uniform();
    VoltBench bench{lean * std::cos(to * kRad), lean * std::sin(to * kRad)};
    const auto tilted = FitTwentyFourPositions(TwentyFour(tool, bench, random), {});
    ASSERT_TRUE(tilted.has_value()) << tilted.fault().text;
    EXPECT_LT((Found(tilted->report, "Vb_V") - tool.Vb).cwiseAbs().maxCoeff(), 1e-6) << seed;
    EXPECT_NEAR(Found(tilted->report, "tilt_deg")[0], lean, 0.02 * lean + 1e-4) << seed;
    const Eigen::VectorXd S = Eigen::MatrixXd(tool.S.transpose()).reshaped();
    EXPECT_LT((Found(tilted->report, "S_V_per_g") - S).cwiseAbs().maxCoeff(), 3e-6) << seed;
  }
}

TEST(TwentyFourPositions, TransientHardlyLeaksIntoTheMeans) {
  // 2 mV at the begin of every position, gone after some readings or many; noise of 20 uV.
  double worst = 0, stopped = 0;
  int cases = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    Random random(seed);
    const double lag = 2 + 10 * random.Uniform();
    std::vector<double> readings;
    for (int i = 0; i < 80; ++i)
      readings.push_back(3 + 2e-3 * std::exp(-i / lag) + 20e-6 * random.Normal());
    const SettledRun run = Settle(readings, 1e-4);
    EXPECT_TRUE(run.settled);
    worst = std::max(worst, std::abs(run.value - 3));
    // The rule of the patent: stop when the last three agree, here within 0.1 mV.
    for (std::size_t i = 2; i < readings.size(); ++i) {
      const double a = readings[i - 2], b = readings[i - 1], c = readings[i];
      if (std::max({a, b, c}) - std::min({a, b, c}) > 1e-4) continue;
      stopped += std::abs((a + b + c) / 3 - 3);
      ++cases;
      break;
    }
  }
  fmt::print("  transient of 2 mV: at most {:.4f} mV; stopping at three that agree {:.3f} mV\n",
             1e3 * worst, 1e3 * stopped / cases);
  EXPECT_LT(worst, 20e-6);
  EXPECT_GT(stopped / cases, 20e-6);
}

TEST(TwentyFourPositions, PolynomialsTakeTheDegreeThatTheToolHas) {
  for (const int degree : {1, 2}) {
    Random random(static_cast<std::uint64_t>(degree));
    const VoltTool at_middle = VoltTool::Any(random);
    TableMaker table({"T_C", "axis", "dir", "rot_deg", "channel", "sample", "volt"});
    for (const double T : {20.0, 50.0, 80.0, 110.0, 140.0, 170.0}) {
      const double tau = (T - 95) / 75;
      VoltTool tool = at_middle;
      tool.Vb += Eigen::Vector3d(2e-3, -1e-3, 3e-3) * tau;
      tool.S *= 1 + 1e-3 * tau;
      if (degree == 2) tool.Vb += Eigen::Vector3d(5e-4, 4e-4, -6e-4) * tau * tau;
      AddPositions(tool, {.sigma = 1e-5}, random, {T}, table);
    }
    const auto fit = FitTwentyFourPositions(table.Finish(), {.settle_tolerance = 1e-3});
    ASSERT_TRUE(fit.has_value()) << fit.fault().text;
    const SensorGroup& accel = fit->accel;
    EXPECT_EQ(accel.bias[2].isZero(0), degree == 1);
    EXPECT_TRUE(accel.bias[3].isZero(0));
    EXPECT_NEAR(accel.bias[1][0], 2e-3, 2e-5);
    EXPECT_EQ(accel.reference, 95);
    EXPECT_EQ(accel.min, 20);
    EXPECT_EQ(accel.max, 170);
  }
}

/// Root mean square over 200 benches of the bias's error [ug].
double SixPositionBias(const PulseBench& bench, bool second_order) {
  double square = 0;
  constexpr int kBenches = 200;
  for (std::uint64_t seed = 1; seed <= kBenches; ++seed) {
    Random random(seed);
    const PulseTool tool = PulseTool::Any(random);
    const auto fit =
        FitSixPositions(SixPositions(tool, bench, random), {.second_order = second_order});
    EXPECT_TRUE(fit.has_value());
    square += (Found(fit->report, "a0_mps2") - tool.a0).squaredNorm() / 3;
  }
  return std::sqrt(square / kBenches) / 9.80665e-6;
}

TEST(SixPositions, SecondOrderAgainstTilt) {
  const double tilt = 20 * units::kArcsec;
  const double own = SixPositionBias({0, 4, 1}, false), level = SixPositionBias({0, 4, 1}, true);
  const double own_tilted = SixPositionBias({tilt, 4, 1}, false);
  const double level_tilted = SixPositionBias({tilt, 4, 1}, true);
  const double level_repeated = SixPositionBias({tilt, 4, 4}, true);
  fmt::print(
      "  bias, rms of 200 benches, k2 of 15 to 30 ug/g2 [ug]: exact fixture, own pair {:.1f}, "
      "level positions {:.1f}; 20 arcsec of tilt, own pair {:.1f}, level {:.1f}, level and "
      "four rotations {:.1f}\n",
      own, level, own_tilted, level_tilted, level_repeated);
  // Root mean square of k2 over [15, 30]: 22.9; four positions of 97 ug each: 48.5, repeated 24.2.
  EXPECT_NEAR(own, 22.9, 1.2);
  EXPECT_NEAR(own_tilted, 22.9, 1.5);
  EXPECT_LT(level, 3);
  EXPECT_NEAR(level_tilted, 48.5, 5);
  EXPECT_NEAR(level_repeated, 24.2, 2.5);
}

VectorTool PublishedErrors() {
  VectorTool tool;
  tool.Ka << 0.006, 0.004, -0.012, -0.005, -0.008, 0.009, 0.011, -0.007, 0.005;
  tool.Km << -0.007, 0.006, 0.01, 0.004, 0.009, -0.008, -0.006, 0.012, -0.004;
  tool.Ka += Eigen::Matrix3d::Identity();
  tool.Km += Eigen::Matrix3d::Identity();
  tool.ba = {4e-3, -3e-3, 6e-3};
  tool.bm = {150, -220, 90};
  return tool;
}

TEST(Orthogonality, TrigonometricAgainstAffineAtFortyAttitudes) {
  // Means over 20 benches; errors of one per cent, 0.1 mg and 20 nT of noise.
  OrthogonalityCheck::Errors sums[3] = {};
  constexpr int kBenches = 20;
  for (std::uint64_t seed = 1; seed <= kBenches; ++seed) {
    Random random(seed);
    const Field field;
    const auto fit = FitOrthogonality(Sequences(PublishedErrors(), field, {1e-4, 20}, 40, random),
                                      {.reference = {.field = field.nt, .dip = field.dip * kRad}});
    ASSERT_TRUE(fit.has_value()) << fit.fault().text;
    const auto& check = *fit->check;
    EXPECT_EQ(check.attitudes, 40);
    const OrthogonalityCheck::Errors* errors[] = {&check.raw, &check.trigonometric, &check.affine};
    for (int i = 0; i < 3; ++i) {
      sums[i].G_mg += errors[i]->G_mg / kBenches;
      sums[i].M_nT += errors[i]->M_nT / kBenches;
      sums[i].inclination_deg += errors[i]->inclination_deg / kBenches;
      sums[i].azimuth_deg += errors[i]->azimuth_deg / kBenches;
    }
  }
  const char* names[] = {"raw", "trigonometric", "affine"};
  for (int i = 0; i < 3; ++i)
    fmt::print(
        "  {:<14} G {:6.2f} mg, M {:6.1f} nT, inclination {:.4f} deg rms, azimuth {:.3f} deg "
        "median\n",
        names[i], sums[i].G_mg, sums[i].M_nT, sums[i].inclination_deg, sums[i].azimuth_deg);
  EXPECT_NEAR(sums[0].G_mg, 9.4, 0.5);
  EXPECT_NEAR(sums[1].G_mg, 7.4, 0.8);
  EXPECT_NEAR(sums[2].G_mg, 0.11, 0.01);
  EXPECT_NEAR(sums[2].M_nT, 19, 3);
  EXPECT_LT(sums[2].inclination_deg, sums[1].inclination_deg / 20);
  EXPECT_LT(sums[2].azimuth_deg, sums[1].azimuth_deg / 10);
}

TEST(Scalar, FindsFourGrossRowsAmongFortyEight) {
  double clean = 0, found = 0;
  constexpr int kBenches = 50;
  for (std::uint64_t seed = 1; seed <= kBenches; ++seed) {
    Random random(seed);
    VectorTool tool = VectorTool::Any(random);
    tool.TieToSensors();
    BenchTable data = AtAttitudes(tool, 48, {}, {2e-5, 20}, random);
    const auto of_all = FitScalar(data, {});
    std::vector<int> spoilt;
    for (int i = 0; i < 4; ++i) {
      const int row = 3 + 11 * i;
      // 20 mg and more along gravity's length.
      const double sign = random.Uniform() < 0.5 ? -1 : 1;
      const double size = sign * (0.02 + 0.08 * random.Uniform());
      data.values.block<1, 3>(row, 3) *= 1 + size;
      spoilt.push_back(data.lines[static_cast<std::size_t>(row)]);
    }
    const auto fit = FitScalar(data, {});
    ASSERT_TRUE(fit.has_value() && of_all.has_value());
    EXPECT_EQ(fit->report.outlier_lines, spoilt) << seed;
    clean += (Found(of_all->report, "ba") - tool.ba).squaredNorm();
    found += (Found(fit->report, "ba") - tool.ba).squaredNorm();
  }
  fmt::print("  bias's error with four gross rows: {:.2f} of that of clean readings\n",
             std::sqrt(found / clean));
  EXPECT_LT(std::sqrt(found / clean), 1.5);
}

TEST(Gyros, NorthOffsetOfTheFixture) {
  Random random(5);
  const GyroTool tool = GyroTool::Any(random);
  const auto fit =
      FitGyro(GyrosAtRest(tool, 60, 0.02, random, 7.3), {},
              {.reference = {.latitude = 60 * kRad}, .fit_north = true, .sigma = 0.02});
  ASSERT_TRUE(fit.has_value()) << fit.fault().text;
  const double sigma = Found(fit->report, "north_deg", true)[0];
  EXPECT_NEAR(Found(fit->report, "north_deg")[0], 7.3, 3.5 * sigma);
  EXPECT_NEAR(sigma, 0.013, 0.006);
}

TEST(Gyros, AnisoelasticTermsAreLeftOutWhereNothingSeesThem) {
  Random random(6);
  const GyroTool tool = GyroTool::Any(random);
  BenchTable rest = GyrosAtRest(tool, 45, 0, random, 0, 90);
  // Inclinations of 0, 90, 180 alone.
  std::vector<Eigen::Index> kept;
  std::vector<int> lines;
  for (int i = 0; i < rest.rows(); ++i) {
    if (std::fmod(rest.values(i, 0), 90) != 0) continue;
    kept.push_back(i);
    lines.push_back(rest.lines[static_cast<std::size_t>(i)]);
  }
  rest.values = Eigen::MatrixXd(rest.values(kept, Eigen::all));
  rest.lines = lines;
  const auto fit = FitGyro(rest, {}, {.reference = {.latitude = 45 * kRad}});
  ASSERT_TRUE(fit.has_value()) << fit.fault().text;
  EXPECT_THAT(fit->report.remarks,
              testing::Contains(testing::HasSubstr("anisoelastic terms are left out")));
  EXPECT_LT((Found(fit->report, "b_degh") - tool.b).norm(), 1e-9);
}

TEST(Gyros, OneVerticalRollIsRefusedWithWhatItDoesNotSee) {
  Random random(7);
  const GyroTool tool = GyroTool::Any(random);
  BenchTable rest = GyrosAtRest(tool, 45, 0, random);
  rest.values = Eigen::MatrixXd(rest.values.topRows(6));
  rest.lines.resize(6);
  const auto fit = FitGyro(rest, {}, {.reference = {.latitude = 45 * kRad}});
  ASSERT_FALSE(fit.has_value());
  EXPECT_THAT(fit.fault().text, testing::HasSubstr("do not determine"));
  EXPECT_THAT(fit.fault().text, testing::HasSubstr("U["));
  EXPECT_THAT(fit.fault().text, testing::HasSubstr("inclinations every 45 deg"));
}

}  // namespace
}  // namespace wellgyro::test

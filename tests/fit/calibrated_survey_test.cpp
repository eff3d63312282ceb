// From a simulated bench to a survey: tools with errors, calibrated on a noisy bench, in the hole.
#include <cmath>
#include <memory>
#include <variant>
#include <vector>

#include <Eigen/Cholesky>
#include <fmt/core.h>
#include <gtest/gtest.h>

#include "wellgyro/base/units.h"
#include "wellgyro/calibration/tool_update.h"
#include "wellgyro/fit/gyro_fit.h"
#include "wellgyro/fit/position_fit.h"
#include "wellgyro/io/toml/tool_file.h"
#include "wellgyro/math/statistics.h"
#include "wellgyro/simulate/raw_counts.h"

#include "fit/attitude_simulation.h"
#include "fit/bench_simulation.h"
#include "support/hour.h"

namespace wellgyro::test {
namespace {

constexpr double kG = 9.80665;
constexpr double kGyroCount = 1e-4;  // deg/h
constexpr double kVoltCount = 1e-7;  // V

/// The tool as it is: what its channels read, in the bench's axes (x of the bench is -y of the
/// tool, y of the bench its x).
ToolCalibration TrueModel(const GyroTool& gyros, const VoltTool& accels) {
  Eigen::Matrix3d R;
  R << 0, 1, 0, -1, 0, 0, 0, 0, 1;
  ToolCalibration tool;
  SensorGroup& gyro = tool.gyro;
  gyro.n_channels = 4;
  gyro.channel = {0, 1, 2, 3};
  gyro.unit_per_count.setConstant(kGyroCount);
  gyro.R_TS = R;
  gyro.bias[0] = gyros.b;
  gyro.sensitivity[0] = gyros.U * (3600 / kRad);
  const double M1 = gyros.MQ[0] / kG, Q1 = gyros.MQ[1] / kG;
  const double M2 = gyros.MQ[2] / kG, Q2 = gyros.MQ[3] / kG;
  gyro.g_dependence[0] << M1, Q1, 0, -Q1, M1, 0, -Q2, 0, M2, M2, 0, Q2;
  const Eigen::Vector4d N = gyros.N / (kG * kG);
  gyro.g_squared(0, 5) = N[0];  // z x
  gyro.g_squared(1, 4) = N[1];  // y z
  gyro.g_squared(2, 4) = N[2];
  gyro.g_squared(3, 3) = N[3];  // x y
  SensorGroup& accel = tool.accel;
  accel.n_channels = 3;
  accel.channel = {4, 5, 6, 0};
  accel.unit_per_count.setConstant(kVoltCount);
  accel.R_TS = R;
  accel.bias[0].head<3>() = accels.Vb;
  accel.sensitivity[0].topRows<3>() = accels.S / kG;
  for (int i = 0; i < 3; ++i) accel.second_order(i, i) = accels.K2[i] / (kG * kG);
  return tool;
}

/// What the bench makes of it, through the tool file.
Result<ToolCalibration> Calibrated(const GyroTool& gyros, const VoltTool& accels, Random& random) {
  const auto volts = FitTwentyFourPositions(
      TwentyFour(accels, {0.2 * random.Normal(), 0.2 * random.Normal(), 1e-4}, random),
      {.settle_tolerance = 1e-2, .sigma = 1e-4 / std::sqrt(3.0)});
  if (!volts) return volts.fault();
  const BenchTable at_rest = GyrosAtRest(gyros, 60, 0.1, random);
  const auto rates =
      FitGyro(at_rest, GyrosOnTable(gyros, 60, 2, random),
              {.reference = {.latitude = 60 * kRad}, .sigma = 0.1, .sigma_table = 2.0});
  if (!rates) return rates.fault();
  ToolCalibration tool = Updated({}, *rates, {.unit_per_count = std::vector<double>{kGyroCount}});
  tool = Updated(
      tool, *volts,
      {.channels = std::vector<int>{4, 5, 6}, .unit_per_count = std::vector<double>{kVoltCount}});
  return ParseTool(ToolToml(tool), "tool.toml");
}

Simulation HoleRun(std::uint64_t seed) {
  wellgyro::testing::Hour hour;
  hour.inclination_deg = 35;
  hour.azimuth_deg = 70;
  hour.swing_deg = 30;
  hour.minutes = 20;
  hour.stops = 2;
  Simulation simulation = SimulationOf(hour, 0);
  simulation.seed = seed;
  simulation.tool.has_gz = true;
  simulation.tool.errors.gyro_noise.angle_random_walk = 1e-3 * units::kDegPerSqrtHour;
  simulation.tool.errors.accel_noise = 1e-5;
  return simulation;
}

/// The survey of the counts that a tool makes of the run.
Survey SurveyOfCounts(const Simulation& simulation, const Job& job, RawCounter& counter) {
  Sink sink;
  Surveyor surveyor(job, sink);
  wellgyro::testing::Play(simulation, surveyor, [&](SimulatedStep& step) {
    const auto* sample = std::get_if<ImuSample>(&step);
    if (sample == nullptr) return true;
    const RawSample raw = counter.Count(*sample, 20);
    surveyor.Push(std::span<const RawSample>(&raw, 1));
    return false;
  });
  surveyor.Finish();
  return surveyor.Current(simulation.streams.tool);
}

/// Squared difference over the covariance, of what it can tell.
double Normalised(const Eigen::VectorXd& error, const Eigen::MatrixXd& cov) {
  return error.dot(cov.ldlt().solve(error));
}

TEST(CalibratedSurvey, OfRawCountsIsThatOfThePerfectToolWithinItsCovariance) {
  constexpr int kTools = WELLGYRO_LONG ? 16 : 6;
  double direction = 0, place = 0, worst_azimuth = 0, uncalibrated = 0;
  for (std::uint64_t seed = 1; seed <= kTools; ++seed) {
    Random random(100 + seed);
    const GyroTool gyros = GyroTool::Any(random);
    const VoltTool accels = VoltTool::Any(random);
    const auto tool = Calibrated(gyros, accels, random);
    ASSERT_TRUE(tool.has_value()) << tool.fault().text;

    const Simulation simulation = HoleRun(seed);
    Job job;
    job.well.latitude = simulation.earth.latitude;
    job.noise.angle_random_walk = 1e-3 * units::kDegPerSqrtHour;
    job.errors.accel_noise = 1e-5;
    job.tie_in.md = 5;
    job.tie_in.tvd = 0;
    job.stations.every = 10;
    Sink sink;
    const Survey perfect = wellgyro::testing::SurveyOf(simulation, job, sink);
    job.errors = *tool->errors;
    job.errors.accel_noise = 1e-5;
    job.tool = *tool;
    RawCounter counter(TrueModel(gyros, accels));
    const Survey survey = SurveyOfCounts(simulation, job, counter);
    ASSERT_GT(survey.chosen.size(), 40u) << survey.unusable;
    ASSERT_EQ(survey.chosen.size(), perfect.chosen.size());

    const Station &a = survey.chosen.back(), &b = perfect.chosen.back();
    const Eigen::Vector2d turned(a.inclination - b.inclination,
                                 std::remainder(a.azimuth - b.azimuth, 2 * kPi));
    // What both have from noise and from the depth is not in their difference.
    const Eigen::Matrix3d cov = a.cov_md_inc_azi - b.cov_md_inc_azi;
    direction += Normalised(turned, cov.bottomRightCorner<2, 2>());
    const Eigen::Matrix3d cov_p_W = a.cov_p_WT_W - b.cov_p_WT_W;
    place += Normalised((a.p_WT_W - b.p_WT_W).head<2>(), cov_p_W.topLeftCorner<2, 2>());
    worst_azimuth = std::max(worst_azimuth, std::abs(turned[1]));
    // Unknown, the same errors would cost so much: one degree an hour against the level rate.
    uncalibrated += std::abs(gyros.b[0]) / (kEarth * std::cos(60 * kRad)) / kTools;
  }
  fmt::print(
      "  {} tools: normalised errors squared, direction {:.2f}, place {:.2f} of 2; worst "
      "azimuth {:.4f} deg; uncalibrated {:.1f} deg\n",
      kTools, direction / kTools, place / kTools, worst_azimuth / kRad, uncalibrated / kRad);
  for (const double sum : {direction, place}) {
    EXPECT_LT(sum, ChiSquareQuantile(0.995, 2 * kTools));
    EXPECT_GT(sum, ChiSquareQuantile(0.005, 2 * kTools));
  }
  EXPECT_LT(worst_azimuth, 0.1 * uncalibrated);
}

}  // namespace
}  // namespace wellgyro::test

// What a job does not say: errors are not zero, noise is not silence, a depth is not guessed.
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/toml/coefficients_internal.h"
#include "wellgyro/io/toml/job_file.h"

namespace wellgyro {
namespace {

using ::testing::HasSubstr;
using units::kDeg;
using units::kDegPerHour;
using units::kDegPerHourPerG;

const std::string kWellHead = "format = \"wellgyro.job/1\"\n[well]\nlatitude_deg = 60\n";

Job JobOf(const std::string& text) {
  const Result<JobFile> file = ParseJob(kWellHead + text, "job.toml", ".");
  if (!file) ADD_FAILURE() << file.fault().text;
  return file ? file->job : Job{};
}

std::string DefaultsFault(const std::string& text) {
  const Result<JobFile> file = ParseJob(kWellHead + text, "job.toml", ".");
  return file ? "" : file.fault().text;
}

// The example tools of SPE 90408, Appendix D, and OWSG Set A Rev 5.1 for depth.
TEST(JobDefaults, ErrorsThatNobodyStatesAreThoseOfPublishedTools) {
  const ErrorPriors e = JobOf("").errors;
  EXPECT_DOUBLE_EQ(e.gyro_bias_sigma, 0.1 * kDegPerHour);
  EXPECT_DOUBLE_EQ(e.mass_unbalance_sigma, 0.5 * kDegPerHourPerG);
  EXPECT_DOUBLE_EQ(e.quadrature_sigma, 0.5 * kDegPerHourPerG);
  EXPECT_DOUBLE_EQ(e.gyro_scale_sigma, 1e-3);
  EXPECT_DOUBLE_EQ(e.gyro_misalignment_sigma, 0.05 * kDeg);
  EXPECT_DOUBLE_EQ(e.accel_bias_sigma, 5e-3);
  EXPECT_DOUBLE_EQ(e.accel_scale_sigma, 5e-4);
  EXPECT_DOUBLE_EQ(e.accel_misalignment_sigma, 0.05 * kDeg);
  EXPECT_DOUBLE_EQ(e.accel_noise, 2e-4);
  EXPECT_DOUBLE_EQ(e.time_skew_sigma, 1e-3);
  EXPECT_DOUBLE_EQ(e.depth_sigma, 0.35);
  EXPECT_DOUBLE_EQ(e.depth_scale_sigma, 5.6e-4);
}

TEST(JobDefaults, WhatIsStatedSetsTheScaleOfWhatIsNot) {
  const ErrorPriors e = JobOf(
                            "[errors]\nmass_unbalance_sigma_deg_per_h_per_g = 0.02\n"
                            "accel_bias_sigma_mps2 = 0.000980665\n"
                            "gyro_misalignment_sigma_rad = 1e-4\n")
                            .errors;
  EXPECT_DOUBLE_EQ(e.quadrature_sigma, 0.02 * kDegPerHourPerG);
  EXPECT_DOUBLE_EQ(e.accel_scale_sigma, 1e-4);
  EXPECT_DOUBLE_EQ(e.accel_misalignment_sigma, 1e-4);
  EXPECT_DOUBLE_EQ(e.roll_offset_sigma, 1e-4);
}

TEST(JobDefaults, AnExplicitZeroIsZero) {
  const ErrorPriors e = JobOf(
                            "[errors]\nquadrature_sigma_deg_per_h_per_g = 0\n"
                            "time_skew_sigma_s = 0\ndepth_scale_sigma = 0.0\n")
                            .errors;
  EXPECT_EQ(e.quadrature_sigma, 0);
  EXPECT_EQ(e.time_skew_sigma, 0);
  EXPECT_EQ(e.depth_scale_sigma, 0);
  EXPECT_GT(e.mass_unbalance_sigma, 0);
}

TEST(JobDefaults, JobAndToolMergeKeyByKeyAndTheJobWins) {
  ToolCalibration tool;
  tool.errors = ErrorPriors{.gyro_bias_sigma = 2 * kDegPerHour, .accel_bias_sigma = 1e-3};
  tool.errors_none = {"time_skew_sigma_s"};
  const ErrorPriors e = PriorsOfJob(nullptr, &tool);
  EXPECT_EQ(e.gyro_bias_sigma, 2 * kDegPerHour);
  EXPECT_EQ(e.time_skew_sigma, 0) << "the tool's own word";
  EXPECT_DOUBLE_EQ(e.accel_scale_sigma, 1e-3 / units::kStandardGravity);
  EXPECT_DOUBLE_EQ(e.gyro_scale_sigma, 1e-3) << "nobody's";
}

TEST(JobDefaults, WhatATwoAxisToolSeesOfTheThirdIsKnown) {
  ToolCalibration tool;
  tool.gyro.n_channels = 2;
  tool.gyro.sensitivity[0].topRows<2>() << 2, 0, 0.004, 0, 4, -0.004;
  const ErrorPriors e = PriorsOfJob(nullptr, &tool);
  EXPECT_DOUBLE_EQ(e.gyro_misalignment_x, 0.002);
  EXPECT_DOUBLE_EQ(e.gyro_misalignment_y, -0.001);
  EXPECT_EQ(PriorsOfJob(nullptr, nullptr).gyro_misalignment_x, 0);
}

TEST(JobDefaults, ANoiseThatNobodyStatesIsTold) {
  const Job silent = JobOf("");
  EXPECT_FALSE(silent.noise_stated);
  EXPECT_NEAR(silent.noise.angle_random_walk, 0.1 * kDegPerHour * 13.416, 1e-9);
  EXPECT_TRUE(JobOf("[noise]\nangle_random_walk_deg_per_sqrt_h = 0\n").noise_stated);
  EXPECT_EQ(JobOf("[noise]\nangle_random_walk_deg_per_sqrt_h = 0\n").noise.angle_random_walk, 0);
}

TEST(JobDefaults, ATieInBelowTheDatumSaysHowDeepItIs) {
  EXPECT_THAT(DefaultsFault("[tie_in]\nmd_m = 100\n"), HasSubstr("tvd_m: is missing beside md_m"));
  EXPECT_EQ(DefaultsFault("[tie_in]\nmd_m = 100\ntvd_m = 99\n"), "");
  EXPECT_EQ(DefaultsFault("[tie_in]\nmd_m = 0\n"), "");
  EXPECT_FALSE(JobOf("[tie_in]\nmd_m = 100\ntvd_m = 99\neast_m = 1\n").tie_in.place_stated);
  EXPECT_TRUE(
      JobOf("[tie_in]\nmd_m = 9\ntvd_m = 9\neast_m = 1\nnorth_m = 0\n").tie_in.place_stated);
  EXPECT_TRUE(JobOf("").tie_in.place_stated);
}

}  // namespace
}  // namespace wellgyro

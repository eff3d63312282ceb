#include "wellgyro/io/toml/job_file.h"

#include <filesystem>
#include <string>

#include <gmock/gmock.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/sha256.h"

#include "io/toml/whole_job.h"
#include "support/scratch.h"

namespace wellgyro {
namespace {

using test::kWholeJob;
using test::ParsedJob;
using testing::HasSubstr;
using units::kDeg;
using units::kDegPerHour;

TEST(ReadJob, TakesEveryKeyInItsUnit) {
  const auto file = ParsedJob(kWholeJob);
  ASSERT_TRUE(file) << file.fault().line << " " << file.fault().text;
  const Job& job = file->job;
  EXPECT_EQ(job.well.name, "A-1");
  EXPECT_DOUBLE_EQ(job.well.latitude, 60.5 * kDeg);
  EXPECT_DOUBLE_EQ(job.well.longitude, 4.25 * kDeg);
  EXPECT_EQ(job.well.datum_elevation, 30);
  EXPECT_THAT(job.identity, testing::ElementsAre(testing::Pair("uwi", "NO 30/9"),
                                                 testing::Pair("field", "Oseberg"),
                                                 testing::Pair("job_number", "4711")));
  EXPECT_EQ(job.tie_in.md, 100);
  EXPECT_EQ(job.tie_in.north, 1);
  EXPECT_EQ(job.tie_in.east, -2);
  EXPECT_EQ(job.tie_in.tvd, 99);
  EXPECT_DOUBLE_EQ(job.tie_in.inclination.value(), 1.5 * kDeg);
  EXPECT_DOUBLE_EQ(job.tie_in.azimuth.value(), 270 * kDeg);
  EXPECT_EQ(job.tie_in.cov_p_WT_W(1, 1), 9);
  EXPECT_EQ(job.tie_in.cov_p_WT_W(0, 1), 0.1);
}

TEST(ReadJob, TakesGrids) {
  const GridSpec grid = ParsedJob(kWholeJob)->job.grid.value();
  EXPECT_EQ(grid.projection, GridSpec::Projection::kLambertConformalConic);
  EXPECT_EQ(grid.name, "ours");
  EXPECT_EQ(grid.semi_major, 6378137);
  EXPECT_EQ(grid.inverse_flattening, 298.257223563);
  EXPECT_DOUBLE_EQ(grid.latitude_origin, 58 * kDeg);
  EXPECT_DOUBLE_EQ(grid.longitude_origin, 5 * kDeg);
  EXPECT_DOUBLE_EQ(grid.parallel_1, 57 * kDeg);
  EXPECT_DOUBLE_EQ(grid.parallel_2, 62 * kDeg);
  EXPECT_EQ(grid.scale_origin, 1);
  EXPECT_EQ(grid.false_easting, 500'000);
  EXPECT_EQ(grid.false_northing, 1000);
  EXPECT_DOUBLE_EQ(grid.convergence.value(), -0.5 * kDeg);
  EXPECT_EQ(grid.scale, 0.9997);
  EXPECT_EQ(grid.epsg, "23031");
  const auto utm = ParsedJob(
      "format = \"wellgyro.job/1\"\nwell = {latitude_deg = -33.0, "
      "longitude_deg = -57.5}\ngrid.utm_zone = \"21S\"\n");
  ASSERT_TRUE(utm) << utm.fault().text;
  EXPECT_EQ(utm->job.grid->name, "UTM 21S");
  const auto polar = ParsedJob(
      "format = \"wellgyro.job/1\"\nwell = {latitude_deg = -75, longitude_deg = 10}\n"
      "[grid]\nprojection = \"polar_stereographic\"\npole = \"south\"\nscale_origin = 0.994");
  ASSERT_TRUE(polar) << polar.fault().text;
  EXPECT_FALSE(polar->job.grid->north_pole);
}

TEST(ReadJob, TakesNoiseAndPriors) {
  const Job job = ParsedJob(kWholeJob)->job;
  EXPECT_DOUBLE_EQ(job.noise.quantization, 0.02 * units::kArcsec);
  EXPECT_DOUBLE_EQ(job.noise.angle_random_walk, 0.01 * kDeg / 60);
  EXPECT_DOUBLE_EQ(job.noise.bias_instability, 0.05 * kDegPerHour);
  EXPECT_DOUBLE_EQ(job.noise.rate_random_walk, 0.02 * kDegPerHour / 60);
  EXPECT_EQ(job.noise.rate_ramp, 0);
  EXPECT_EQ(job.noise.bias_instability_correlation_time, 1800);
  EXPECT_DOUBLE_EQ(job.errors.gyro_bias_sigma, kDegPerHour);
  EXPECT_DOUBLE_EQ(job.errors.mass_unbalance_sigma, 0.5 * kDegPerHour / 9.80665);
  EXPECT_DOUBLE_EQ(job.errors.quadrature_sigma, 0.25 * kDegPerHour / 9.80665);
  EXPECT_EQ(job.errors.gyro_scale_sigma, 1e-4);
  EXPECT_EQ(job.errors.gyro_misalignment_sigma, 2e-4);
  EXPECT_EQ(job.errors.accel_bias_sigma, 1e-3);
  EXPECT_EQ(job.errors.accel_noise, 2e-4);
  EXPECT_DOUBLE_EQ(job.errors.roll_offset_sigma, 0.1 * kDeg);
  EXPECT_EQ(job.errors.time_skew_sigma, 1e-3);
  EXPECT_EQ(job.errors.depth_sigma, 0.5);
  EXPECT_DOUBLE_EQ(job.errors.latitude_sigma, 0.001 * kDeg);
}

TEST(ReadJob, TakesWhatTheRunIsLike) {
  const Job job = ParsedJob(kWholeJob)->job;
  EXPECT_EQ(job.channels.raw + job.channels.imu + job.channels.still + job.channels.depth +
                job.channels.mode + job.channels.tool + job.channels.event + job.channels.command +
                job.channels.station + job.channels.status,
            "ABCDEFGHIJ");
  EXPECT_EQ(job.alignment.method, AlignmentSpec::Method::kExternal);
  EXPECT_EQ(job.alignment.of, AlignmentSpec::Of::kMark);
  EXPECT_NEAR(job.alignment.azimuth, kDeg, 1e-15);
  EXPECT_DOUBLE_EQ(job.alignment.sigma_azimuth, 0.1 * kDeg);
  EXPECT_EQ(job.alignment.at_md, 12);
  EXPECT_FALSE(job.alignment.at_utc);
  EXPECT_FALSE(job.alignment.use_fixes);
  EXPECT_EQ(job.alignment.min_still, 45);
  EXPECT_EQ(job.attitude.order, AttitudeSpec::Order::kSecond);
  EXPECT_EQ(job.stations.every, 5);
  EXPECT_THAT(job.stations.at, testing::ElementsAre(100, 120.5));
  EXPECT_TRUE(job.stations.at_stops);
  EXPECT_EQ(job.depth.kind, DepthKind::kDrillPipe);
  EXPECT_EQ(job.depth.latency, 2.5);
  EXPECT_EQ(job.depth.max_gap, 12.5);
  EXPECT_DOUBLE_EQ(job.depth.cable.stretch, 0.135e-6);
  EXPECT_EQ(job.depth.cable.weight, 4.2);
  EXPECT_EQ(job.depth.cable.tool_weight, 1200);
  EXPECT_EQ(job.depth.cable.measuring_tension, 2000);
  EXPECT_EQ(job.depth.cable.expansion, 1.2e-5);
  EXPECT_DOUBLE_EQ(job.depth.cable.gradient, 0.03);
  EXPECT_EQ(job.depth.cable.mark_spacing, 25);
  EXPECT_EQ(job.depth.cable.first_mark.value_or(0), 12.5);
  EXPECT_THAT(job.depth.corrections,
              testing::ElementsAre(testing::Pair(0, 0), testing::Pair(1000, 0.5)));
  EXPECT_EQ(job.string.sensor_below_reference, 4.5);
  EXPECT_DOUBLE_EQ(job.string.sag, 0.05 * kDeg);
  EXPECT_DOUBLE_EQ(job.string.sigma_sag, 0.02 * kDeg);
  EXPECT_DOUBLE_EQ(job.string.misalignment_x, 0.01 * kDeg);
  EXPECT_DOUBLE_EQ(job.string.misalignment_y, -0.02 * kDeg);
  EXPECT_DOUBLE_EQ(job.string.sigma_misalignment, 0.03 * kDeg);
}

TEST(ReadJob, TakesLimitsRunsAndEvents) {
  const Job job = ParsedJob(kWholeJob)->job;
  ASSERT_TRUE(job.magnetic.has_value());
  EXPECT_DOUBLE_EQ(job.magnetic->declination, -3.5 * kDeg);
  EXPECT_DOUBLE_EQ(job.magnetic->sigma, 0.4 * kDeg);
  EXPECT_TRUE(job.magnetic->tie);
  EXPECT_EQ(job.acceptance.gravity, 0.006);
  EXPECT_DOUBLE_EQ(job.acceptance.earth_rate.value(), 0.67 * kDegPerHour);
  EXPECT_DOUBLE_EQ(job.acceptance.inclination_difference.value(), 0.23 * kDeg);
  EXPECT_DOUBLE_EQ(job.acceptance.azimuth_difference.value(), kDeg);
  EXPECT_DOUBLE_EQ(job.acceptance.foresight.value(), 0.5 * kDeg);
  EXPECT_EQ(job.acceptance.depth_closure, 1.25);
  ASSERT_EQ(job.runs.size(), 2u);
  EXPECT_EQ(job.runs[0].begin->ns, 1767225600000000000);
  EXPECT_EQ(job.runs[0].end->ns, 1767225700000000000);
  EXPECT_TRUE(job.runs[0].misrun);
  EXPECT_EQ(job.runs[0].remark, "cable");
  EXPECT_EQ(job.runs[1].number, 2);
  EXPECT_FALSE(job.runs[1].misrun);
  ASSERT_EQ(job.events.size(), 2u);
  const Event& rezero = job.events[0];
  EXPECT_EQ(rezero.kind, Event::Kind::kDepthRezero);
  EXPECT_EQ(rezero.utc.ns, 1767225650000001000);
  EXPECT_EQ(rezero.run, 2);
  EXPECT_EQ(rezero.event_id, 7);
  EXPECT_EQ(rezero.seq, 3);
  EXPECT_EQ(rezero.session, 4);
  EXPECT_TRUE(rezero.has_value);
  EXPECT_EQ(rezero.value_m, 1.5);
  EXPECT_EQ(rezero.sigma_m, 0.1);
  EXPECT_EQ(rezero.what + rezero.who + rezero.text, "markN.N.slipped");
  EXPECT_EQ(job.events[1].kind, Event::Kind::kForesight);
  EXPECT_EQ(job.events[1].value_rad, 0.5);
  EXPECT_EQ(job.events[1].sigma_rad, 0.001);
}

TEST(ReadJob, TheLeastJobKeepsTheDefaults) {
  const auto file = ParsedJob("format = \"wellgyro.job/1\"\n[well]\nlatitude_deg = 60\n");
  ASSERT_TRUE(file) << file.fault().text;
  EXPECT_EQ(file->job.stations.every, 10);
  EXPECT_EQ(file->job.channels.imu, "WELLGYRO_IMU");
  EXPECT_EQ(file->job.alignment.min_still, 60);
  EXPECT_EQ(file->job.attitude.order, AttitudeSpec::Order::kThird);
  EXPECT_FALSE(file->job.grid);
  ASSERT_EQ(file->files.size(), 1u);
  EXPECT_EQ(file->files[0].role, "job");
  EXPECT_EQ(file->files[0].name, "job.toml");
}

TEST(ReadJob, AnUnknownOrderIsRefusedWithTheKnownOnes) {
  const std::string head = "format = \"wellgyro.job/1\"\nwell = {latitude_deg = 60}\n";
  EXPECT_EQ(ParsedJob(head + "attitude.order = 'third'")->job.attitude.order,
            AttitudeSpec::Order::kThird);
  const auto file = ParsedJob(head + "attitude.order = 'fourth'");
  ASSERT_FALSE(file);
  EXPECT_THAT(file.fault().text, AllOf(HasSubstr("order"), HasSubstr("fourth"), HasSubstr("second"),
                                       HasSubstr("third")));
  EXPECT_EQ(file.fault().line, 3);
}

TEST(ReadJob, StationsAtDepthsAloneHaveNoSpacing) {
  const std::string head = "format = \"wellgyro.job/1\"\nwell = {latitude_deg = 60}\n";
  EXPECT_EQ(ParsedJob(head + "stations.at_m = [1.0, 2.0]")->job.stations.every, 0);
  EXPECT_EQ(ParsedJob(head + "stations = {every_m = 0, at_stops = true}")->job.stations.every, 0);
  EXPECT_FALSE(ParsedJob(head + "stations.every_m = 0"));
}

TEST(ReadJob, FilesItNamesAreRelativeToItAndHashed) {
  const support::Scratch scratch;
  const std::string noise =
      "format = \"wellgyro.noise/1\"\n[coefficients]\nangle_random_walk_deg_per_sqrt_h = 0.03\n";
  const std::string survey =
      "MD[m],INC[deg],AZI_TRUE[deg],GTF[deg],TVD[m],N[m],E[m],DLS[deg/30m],VAR_NN[m2],"
      "COV_NE[m2],COV_NV[m2],VAR_EE[m2],COV_EV[m2],VAR_VV[m2],SIG_INC[deg],SIG_AZI[deg],KIND,"
      "QUALITY\n0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,tie_in,good\n"
      "500,2,350,0,499,-3,4,0,1,0.5,0,2,0,3,0.1,0.2,continuous,good\n";
  const std::string job =
      "format = \"wellgyro.job/1\"\nwell.latitude_deg = 60\nnoise.file = \"n.toml\"\n"
      "tie_in.survey = \"old/survey.csv\"\n";
  scratch.Write("job.toml", job);
  scratch.Write("n.toml", noise);
  scratch.Write("old/survey.csv", survey);
  const auto file = ReadJob(scratch.path() / "job.toml");
  ASSERT_TRUE(file) << file.fault().text;
  EXPECT_DOUBLE_EQ(file->job.noise.angle_random_walk, 0.03 * kDeg / 60);
  EXPECT_EQ(file->job.tie_in.md, 500);
  EXPECT_EQ(file->job.tie_in.north, -3);
  EXPECT_EQ(file->job.tie_in.tvd, 499);
  EXPECT_DOUBLE_EQ(file->job.tie_in.azimuth.value(), 350 * kDeg);
  EXPECT_EQ(file->job.tie_in.cov_p_WT_W(1, 0), 0.5);
  ASSERT_EQ(file->files.size(), 3u);
  EXPECT_EQ(file->files[0].sha256, Sha256Hex(job));
  EXPECT_EQ(file->files[1].role, "tie_in");
  EXPECT_EQ(file->files[1].name, "old/survey.csv");
  EXPECT_EQ(file->files[1].sha256, Sha256Hex(survey));
  EXPECT_EQ(file->files[2].role, "noise");

  scratch.Write("n.toml", noise + "bias = 1\n");
  const auto odd = ReadJob(scratch.path() / "job.toml");
  ASSERT_FALSE(odd);
  EXPECT_EQ(odd.fault().line, 4);
  EXPECT_THAT(odd.fault().source, HasSubstr("n.toml"));
  std::filesystem::remove(scratch.path() / "n.toml");
  EXPECT_EQ(ReadJob(scratch.path() / "job.toml").fault().code, FaultCode::kIo);
}

}  // namespace
}  // namespace wellgyro

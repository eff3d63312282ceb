#include "wellgyro/io/toml/job_file.h"

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/sha256.h"

#include "support/scratch.h"

namespace wellgyro {
namespace {

using testing::HasSubstr;
using units::kDeg;
using units::kDegPerHour;

// Every key of a job, but for those that exclude one another.
constexpr std::string_view kWhole = R"(format = "wellgyro.job/1"
[well]
name = "A-1"
latitude_deg = 60.5
longitude_deg = 4.25
datum_elevation_m = 30
[identity]
uwi = "NO 30/9"
field = "Oseberg"
job_number = 4711
[grid]
projection = "lambert_conformal_conic"
name = "ours"
semi_major_m = 6378137.0
inverse_flattening = 298.257223563
latitude_origin_deg = 58.0
longitude_origin_deg = 5.0
parallel_1_deg = 57.0
parallel_2_deg = 62.0
scale_origin = 1.0
false_easting_m = 500000.0
false_northing_m = 1000.0
convergence_deg = -0.5
scale = 0.9997
epsg = "23031"
[tie_in]
md_m = 100.0
north_m = 1.0
east_m = -2.0
tvd_m = 99.0
inclination_deg = 1.5
azimuth_true_deg = -90.0
covariance_m2 = [[4.0, 0.1, 0.0], [0.1, 9.0, 0.0], [0.0, 0.0, 1.0]]
[noise]
quantization_arcsec = 0.02
angle_random_walk_deg_per_sqrt_h = 0.01
angle_random_walk_deg_per_sqrt_h_sigma = 0.001
bias_instability_deg_per_h = 0.05
rate_random_walk_deg_per_h_sqrt_h = 0.02
rate_ramp_deg_per_h2_upper95 = 0.003
bias_instability_correlation_time_h = 0.5
[errors]
gyro_bias_sigma_deg_per_h = 1.0
mass_unbalance_sigma_deg_per_h_per_g = 0.5
quadrature_sigma_deg_per_h_per_g = 0.25
gyro_scale_sigma = 1e-4
gyro_misalignment_sigma_rad = 2e-4
accel_bias_sigma_mps2 = 1e-3
accel_noise_mps2_per_sqrt_hz = 2e-4
roll_offset_sigma_deg = 0.1
time_skew_sigma_s = 1e-3
depth_sigma_m = 0.5
latitude_sigma_deg = 0.001
[channels]
raw = "A"
imu = "B"
still = "C"
depth = "D"
mode = "E"
tool = "F"
event = "G"
command = "H"
station = "I"
status = "J"
[alignment]
method = "external"
of = "mark"
azimuth_true_deg = -359.0
sigma_azimuth_deg = 0.1
at_md_m = 12.0
use_fixes = false
min_still_s = 45
[attitude]
order = "second"
[stations]
every_m = 5
at_m = [100.0, 120.5]
at_stops = true
[depth]
kind = "drill_pipe"
latency_s = 2.5
corrections = [[0.0, 0.0], [1000, 0.5]]
max_gap_s = 12.5
[depth.cable]
stretch_m_per_km_kn = 0.135
weight_n_per_m = 4.2
tool_weight_n = 1200.0
measuring_tension_n = 2000.0
expansion_per_degc = 1.2e-5
gradient_degc_per_km = 30.0
mark_spacing_m = 25.0
first_mark_m = 12.5
[string]
sensor_below_reference_m = 4.5
sag_deg = 0.05
sag_sigma_deg = 0.02
misalignment_x_deg = 0.01
misalignment_y_deg = -0.02
misalignment_sigma_deg = 0.03
[magnetic]
declination_deg = -3.5
sigma_deg = 0.4
tie = true
[acceptance]
gravity_mps2 = 0.006
earth_rate_deg_per_h = 0.67
inclination_difference_deg = 0.23
azimuth_difference_deg = 1.0
foresight_deg = 0.5
depth_closure_m = 1.25
[[run]]
number = 1
begin_utime_us = 1767225600000000
end_utime_us = 1767225700000000
verdict = "misrun"
remark = "cable"
[[run]]
number = 2
[[event]]
utime_us = 1767225650000001
event = "depth_rezero"
run = 2
event_id = 7
seq = 3
session = 4
value_m = 1.5
sigma_m = 0.1
what = "mark"
who = "N.N."
text = "slipped"
[[event]]
utime_us = 1767225650000002
event = "foresight"
value_rad = 0.5
sigma_rad = 0.001
)";

Result<JobFile> Parse(std::string_view text) { return ParseJob(text, "a/job.toml", "a"); }

TEST(ReadJob, TakesEveryKeyInItsUnit) {
  const auto file = Parse(kWhole);
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
  const GridSpec grid = Parse(kWhole)->job.grid.value();
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
  const auto utm = Parse(
      "format = \"wellgyro.job/1\"\nwell = {latitude_deg = -33.0, "
      "longitude_deg = -57.5}\ngrid.utm_zone = \"21S\"\n");
  ASSERT_TRUE(utm) << utm.fault().text;
  EXPECT_EQ(utm->job.grid->name, "UTM 21S");
  const auto polar = Parse(
      "format = \"wellgyro.job/1\"\nwell = {latitude_deg = -75, longitude_deg = 10}\n"
      "[grid]\nprojection = \"polar_stereographic\"\npole = \"south\"\nscale_origin = 0.994");
  ASSERT_TRUE(polar) << polar.fault().text;
  EXPECT_FALSE(polar->job.grid->north_pole);
}

TEST(ReadJob, TakesNoiseAndPriors) {
  const Job job = Parse(kWhole)->job;
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
  const Job job = Parse(kWhole)->job;
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
  const Job job = Parse(kWhole)->job;
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
  const auto file = Parse("format = \"wellgyro.job/1\"\n[well]\nlatitude_deg = 60\n");
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
  EXPECT_EQ(Parse(head + "attitude.order = 'third'")->job.attitude.order,
            AttitudeSpec::Order::kThird);
  const auto file = Parse(head + "attitude.order = 'fourth'");
  ASSERT_FALSE(file);
  EXPECT_THAT(file.fault().text, AllOf(HasSubstr("order"), HasSubstr("fourth"), HasSubstr("second"),
                                       HasSubstr("third")));
  EXPECT_EQ(file.fault().line, 3);
}

TEST(ReadJob, StationsAtDepthsAloneHaveNoSpacing) {
  const std::string head = "format = \"wellgyro.job/1\"\nwell = {latitude_deg = 60}\n";
  EXPECT_EQ(Parse(head + "stations.at_m = [1.0, 2.0]")->job.stations.every, 0);
  EXPECT_EQ(Parse(head + "stations = {every_m = 0, at_stops = true}")->job.stations.every, 0);
  EXPECT_FALSE(Parse(head + "stations.every_m = 0"));
}

// Every "key = value" line of kWhole with its number, from 1.
std::vector<std::pair<int, std::string>> KeyLines() {
  std::vector<std::pair<int, std::string>> lines;
  std::istringstream text{std::string(kWhole)};
  std::string line;
  for (int number = 1; std::getline(text, line); ++number) {
    if (line.find(" = ") != std::string::npos) lines.emplace_back(number, line);
  }
  return lines;
}

std::string WithLine(int wanted, const std::string& replacement) {
  std::istringstream text{std::string(kWhole)};
  std::string line, all;
  for (int number = 1; std::getline(text, line); ++number) {
    all += (number == wanted ? replacement : line) + "\n";
  }
  return all;
}

TEST(ReadJob, AnUnknownKeyIsAnErrorWithItsLine) {
  for (const auto& [number, line] : KeyLines()) {
    if (number >= 8 && number <= 10) continue;  // identity: keys are free
    const std::string key = line.substr(0, line.find(' '));
    const auto file = Parse(WithLine(number, key + "_x" + line.substr(key.size())));
    ASSERT_FALSE(file) << line;
    // The first line may be missing altogether, but a format line always stands at the head.
    EXPECT_EQ(file.fault().line, number) << line << ": " << file.fault().text;
    if (number > 1) {
      EXPECT_THAT(file.fault().text, HasSubstr(key + "_x")) << line;
    }
    EXPECT_EQ(file.fault().source, "a/job.toml");
  }
}

TEST(ReadJob, AWrongTypeIsAnErrorWithItsLine) {
  for (const auto& [number, line] : KeyLines()) {
    const std::string key = line.substr(0, line.find(' '));
    const bool identity = number >= 8 && number <= 10;
    const bool text = line.find('"') != std::string::npos;
    for (const char* value : {"{}", "[1, 'x']", "1979-05-27", "true", "'word'", "nan", "-inf"}) {
      if (identity && value[0] != '{' && value[0] != '[') continue;
      if (value[0] == '\'' && text) continue;
      if (value[0] == 't' && (key == "use_fixes" || key == "at_stops" || key == "tie")) continue;
      const auto file = Parse(WithLine(number, key + " = " + value));
      ASSERT_FALSE(file) << key << " = " << value;
      EXPECT_EQ(file.fault().line, number) << key << " = " << value << ": " << file.fault().text;
    }
  }
}

TEST(ReadJob, OutOfRangeIsAnErrorWithItsLineAndValue) {
  const std::vector<std::pair<std::string, std::vector<const char*>>> odd{
      {"format", {"'wellgyro.job/2'", "'wellgyro.noise/1'"}},
      {"latitude_deg", {"90", "-91", "1e9"}},
      {"longitude_deg", {"-180.5", "361"}},
      {"datum_elevation_m", {"-2e4", "1e5"}},
      {"projection", {"'mercator'"}},
      {"semi_major_m", {"0", "-6e6", "1e99"}},
      {"inverse_flattening", {"0", "-1"}},
      {"latitude_origin_deg", {"91"}},
      {"parallel_1_deg", {"91"}},
      {"scale_origin", {"0", "-1", "3"}},
      {"scale", {"0", "-1", "3"}},
      {"convergence_deg", {"181"}},
      {"inclination_deg", {"-0.1", "180.5"}},
      {"azimuth_true_deg", {"361", "-361"}},
      {"covariance_m2",
       {"[[1,0,0],[0,1,0]]", "[[1,0],[0,1]]", "[[1,2,0],[2,1,0],[0,0,1]]",
        "[[1,0.5,0],[0,1,0],[0,0,1]]", "[1,2,3]"}},
      {"quantization_arcsec", {"-1"}},
      {"bias_instability_correlation_time_h", {"0", "-1"}},
      {"gyro_bias_sigma_deg_per_h", {"-1"}},
      {"latitude_sigma_deg", {"-1"}},
      {"raw", {"''"}},
      {"status", {"'A'"}},
      {"method", {"'magnetic'", "'External'"}},
      {"of", {"'hole'"}},
      {"sigma_azimuth_deg", {"0", "-1"}},
      {"min_still_s", {"0", "-60"}},
      {"order", {"'first'", "'Third'"}},
      {"every_m", {"-1"}},
      {"at_m", {"[2.0, 1.0]", "[1.0, 1.0]", "[1.0, 1e300]"}},
      {"kind", {"'rope'", "''"}},
      {"latency_s", {"-1", "1e6"}},
      {"corrections", {"[[1, 0], [1, 0]]", "[[1, 0, 0]]", "[1, 0]", "[[1, 20000]]"}},
      {"sag_deg", {"91"}},
      {"sag_sigma_deg", {"-1"}},
      {"gravity_mps2", {"0", "-1"}},
      {"number", {"0", "-1", "1.5", "3000000000"}},
      {"end_utime_us", {"1767225600000000", "-1", "9223372036854775807"}},
      {"verdict", {"'bad'", "'OK'"}},
      {"event", {"'zero'", "'Remark'"}},
      {"run", {"-1"}},
      {"sigma_m", {"-1"}}};
  for (const auto& [key, values] : odd) {
    const auto lines = KeyLines();
    const auto line = std::find_if(lines.begin(), lines.end(), [&, k = key](const auto& l) {
      // A channel bears the name of the event's key.
      return l.second.starts_with(k + " ") && l.second != "event = \"G\"";
    });
    ASSERT_NE(line, lines.end()) << key;
    for (const char* value : values) {
      const auto file = Parse(WithLine(line->first, key + " = " + value));
      ASSERT_FALSE(file) << key << " = " << value;
      EXPECT_EQ(file.fault().line, line->first) << key << " = " << value << file.fault().text;
    }
  }
}

TEST(ReadJob, SaysWhichKeyWasMeant) {
  const auto file = Parse("format = \"wellgyro.job/1\"\n[well]\nlattitude_deg = 60\nname = 'x'\n");
  ASSERT_FALSE(file);
  EXPECT_EQ(file.fault().text,
            "'lattitude_deg' is not a key that belongs here; is 'latitude_deg' meant?");
  EXPECT_EQ(file.fault().line, 3);
  EXPECT_EQ(file.fault().column, 1);
}

std::string FaultOf(const std::string& text) {
  const auto file = Parse("format = \"wellgyro.job/1\"\n" + text);
  return file ? "accepted" : file.fault().text;
}

TEST(ReadJob, KeysThatContradictEachOtherAreRefused) {
  const std::string well = "well = {latitude_deg = 60, longitude_deg = 3}\n";
  EXPECT_EQ(FaultOf(well), "accepted");
  EXPECT_THAT(FaultOf(""), HasSubstr("well: is missing"));
  EXPECT_THAT(FaultOf(well + "tie_in.inclination_deg = 1"), HasSubstr("is missing beside"));
  EXPECT_THAT(FaultOf(well + "tie_in.azimuth_true_deg = 1"), HasSubstr("is missing beside"));
  EXPECT_THAT(FaultOf(well + "grid = {utm_zone = '31N', projection = 'transverse_mercator'}"),
              HasSubstr("only one of them"));
  EXPECT_THAT(FaultOf(well + "grid.utm_zone = '61N'"), HasSubstr("61N"));
  EXPECT_THAT(FaultOf(well + "grid.utm_zone = '1N'"), HasSubstr("well head"));
  EXPECT_THAT(FaultOf("well.latitude_deg = 60\ngrid.utm_zone = '31N'"), HasSubstr("longitude_deg"));
  EXPECT_THAT(FaultOf(well + "alignment = {method = 'gyrocompass', azimuth_true_deg = 1}"),
              HasSubstr("azimuth_true_deg"));
  EXPECT_THAT(FaultOf(well + "alignment = {method = 'external', azimuth_true_deg = 1}"),
              HasSubstr("sigma_azimuth_deg: is missing"));
  EXPECT_THAT(FaultOf(well + "alignment = {method = 'external', azimuth_true_deg = 1, "
                             "sigma_azimuth_deg = 1, at_md_m = 1, at_utime_us = 1}"),
              HasSubstr("at_utime_us"));
  EXPECT_THAT(FaultOf(well + "run = [{number = 1}, {number = 1}]"), HasSubstr("twice"));
  EXPECT_THAT(FaultOf(well + "event = [{utime_us = 1}]"), HasSubstr("event: is missing"));
  EXPECT_THAT(FaultOf(well + "event = [{event = 'remark'}]"), HasSubstr("utime_us: is missing"));
  EXPECT_THAT(FaultOf(well + "noise.rate_ramp_deg_per_h2_sigma = 1"),
              HasSubstr("while its sigma is there"));
  EXPECT_THAT(
      FaultOf(well + "noise = {rate_ramp_deg_per_h2 = 1, rate_ramp_deg_per_h2_upper95 = 1}"),
      HasSubstr("stands alone"));
}

TEST(ReadJob, WhatIsNotTomlIsRefusedWithItsPlace) {
  const auto file = Parse("format = \"wellgyro.job/1\"\n[well\n");
  ASSERT_FALSE(file);
  EXPECT_EQ(file.fault().code, FaultCode::kSyntax);
  EXPECT_EQ(file.fault().line, 2);
  EXPECT_EQ(Parse("").fault().code, FaultCode::kForeign);
  EXPECT_FALSE(Parse("MD,INC,AZI\n1,2,3\n"));
  EXPECT_FALSE(Parse(std::string("format = \"wellgyro.job/1\"\n\x00\xff\xfe", 30)));
  EXPECT_FALSE(Parse("format = " + std::string(100'000, '[')));
  EXPECT_EQ(ReadJob("no/such/job.toml").fault().code, FaultCode::kIo);
}

TEST(ReadJob, EveryPrefixIsRightOrRefused) {
  int accepted = 0;
  for (std::size_t n = 0; n < kWhole.size(); n += 3) {
    if (Parse(kWhole.substr(0, n))) ++accepted;
  }
  EXPECT_GT(accepted, 0);
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

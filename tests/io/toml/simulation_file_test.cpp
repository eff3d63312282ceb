#include "wellgyro/io/toml/simulation_file.h"

#include <sstream>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <gmock/gmock.h>

#include "wellgyro/base/units.h"
#include "wellgyro/simulate/simulator.h"
#include "wellgyro/simulate/tool_errors.h"

#include "support/scratch.h"

namespace wellgyro {
namespace {

using testing::HasSubstr;
using units::kDeg;
using units::kDegPerHour;

constexpr std::string_view kWholeSimulation = R"(format = "wellgyro.simulation/1"
seed = 42
[well]
table = [[0, 0, 10], [500, 5, 20], [1000, 30, 40]]
begin_north_m = 1.0
begin_east_m = 2.0
begin_tvd_m = 3.0
[run]
start_md_m = 100
start_toolface_deg = 30
roll_reference = "high_side"
[[run.step]]
stop_s = 120
index_angles_deg = [0, 90, 180, 270]
turn_s = 8
toolface_deg = 15
mode = "stationary"
[[run.step]]
to_md_m = 900
speed_mps = 1.5
ramp_s = 5
roll_rpm = 3
roll_amplitude_deg = 4
roll_period_s = 60
roll_phase_deg = 90
[earth]
latitude_deg = 60
longitude_deg = 5
height_m = 30
rate_rad_per_s = 7.3e-5
gravity_anomaly_mps2 = -3e-4
gravity_gradient_anomaly_per_s2 = 1e-7
field_nt = [14000, 500, 49000]
[tool]
has_gz = true
has_mag = true
sensor_below_reference_m = 4.5
temperature_degc = 80
angle_random_walk_deg_per_sqrt_h = 0.02
bias_instability_deg_per_h = 0.1
gyro_bias_deg_per_h = [0.1, -0.2, 0.3]
gyro_scale = [1e-4, 2e-4, 3e-4]
gyro_misalignment_rad = [1e-4, -1e-4]
mass_unbalance_deg_per_h_per_g = 0.5
quadrature_deg_per_h_per_g = -0.25
flicker = true
gyro_full_scale_deg_per_s = 100
roll_offset_deg = 0.1
time_skew_s = 1e-3
accel_bias_mps2 = [1e-3, 2e-3, 3e-3]
accel_scale = [1e-5, 2e-5, 3e-5]
accel_misalignment_rad = [1e-6, 2e-6, 3e-6, 4e-6, 5e-6, 6e-6]
accel_noise_mps2_per_sqrt_hz = 2e-4
accel_quantization_mps = 1e-4
accel_full_scale_mps2 = 20
accel_lever_arm_m = [0.0, 0.01, 0.2]
mag_noise_nt = 50
clock_offset_s = 10
clock_drift = 1e-5
utc_jitter_s = 0.01
depth_offset_m = 0.5
depth_scale = 1e-4
depth_noise_m = 0.02
depth_resolution_m = 0.01
[streams]
imu_hz = 200
depth_hz = 5
batch = 50
overlap = 10
loss_probability = 0.01
outages_s = [[10, 20], [30, 31]]
begin_utime_us = 1700000000000000
session = 3
run = 2
tool = 1
[channels]
imu = "SIM_IMU"
)";

Result<SimulationFile> ParseWhole(std::string_view text) {
  return ParseSimulation(text, "s.toml", ".");
}

TEST(ReadSimulation, TakesWellRunAndEarth) {
  const auto file = ParseWhole(kWholeSimulation);
  ASSERT_TRUE(file) << file.fault().line << " " << file.fault().text;
  const Simulation& s = file->simulation;
  EXPECT_EQ(s.seed, 42u);
  ASSERT_EQ(s.well.stations.size(), 3u);
  EXPECT_EQ(s.well.stations[1].md, 500);
  EXPECT_DOUBLE_EQ(s.well.stations[1].inclination, 5 * kDeg);
  EXPECT_DOUBLE_EQ(s.well.stations[2].azimuth, 40 * kDeg);
  EXPECT_EQ(s.well.begin_p_WT_W, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(s.run.start_md, 100);
  EXPECT_DOUBLE_EQ(s.run.start_toolface, 30 * kDeg);
  EXPECT_EQ(s.run.roll_reference, RollReference::kHighSide);
  ASSERT_EQ(s.run.steps.size(), 2u);
  const auto& stop = std::get<RunStop>(s.run.steps[0]);
  EXPECT_EQ(stop.seconds, 120);
  EXPECT_THAT(stop.index_angles, testing::SizeIs(4));
  EXPECT_DOUBLE_EQ(stop.index_angles[3], 270 * kDeg);
  EXPECT_EQ(stop.turn_seconds, 8);
  EXPECT_DOUBLE_EQ(stop.toolface.value(), 15 * kDeg);
  EXPECT_EQ(stop.mode, ToolMode::Mode::kStationary);
  const auto& move = std::get<RunMove>(s.run.steps[1]);
  EXPECT_EQ(move.to_md, 900);
  EXPECT_EQ(move.speed, 1.5);
  EXPECT_EQ(move.ramp, 5);
  EXPECT_DOUBLE_EQ(move.roll.rate, 18 * kDeg);
  EXPECT_DOUBLE_EQ(move.roll.amplitude, 4 * kDeg);
  EXPECT_EQ(move.roll.period, 60);
  EXPECT_DOUBLE_EQ(move.roll.phase, 90 * kDeg);
  EXPECT_DOUBLE_EQ(s.earth.latitude, 60 * kDeg);
  EXPECT_DOUBLE_EQ(s.earth.longitude, 5 * kDeg);
  EXPECT_EQ(s.earth.height, 30);
  EXPECT_EQ(s.earth.rate, 7.3e-5);
  EXPECT_EQ(s.earth.gravity_anomaly, -3e-4);
  EXPECT_EQ(s.earth.gravity_gradient_anomaly, 1e-7);
  EXPECT_DOUBLE_EQ(s.earth.field_L.z(), 49e-6);
}

TEST(ReadSimulation, TakesToolAndStreams) {
  const auto file = ParseWhole(kWholeSimulation);
  ASSERT_TRUE(file);
  const SimulatedTool& tool = file->simulation.tool;
  EXPECT_TRUE(tool.has_gz && tool.has_mag && tool.errors.flicker);
  EXPECT_EQ(tool.sensor_below_reference, 4.5);
  EXPECT_EQ(tool.temperature, 80);
  const ToolErrors& e = tool.errors;
  EXPECT_DOUBLE_EQ(e.gyro_noise.angle_random_walk, 0.02 * kDeg / 60);
  EXPECT_DOUBLE_EQ(e.gyro_bias.y(), -0.2 * kDegPerHour);
  EXPECT_EQ(e.gyro_scale, Eigen::Vector3d(1e-4, 2e-4, 3e-4));
  EXPECT_EQ(e.gyro_misalignment, Eigen::Vector2d(1e-4, -1e-4));
  EXPECT_DOUBLE_EQ(e.mass_unbalance, 0.5 * kDegPerHour / 9.80665);
  EXPECT_DOUBLE_EQ(e.quadrature, -0.25 * kDegPerHour / 9.80665);
  EXPECT_DOUBLE_EQ(e.gyro_full_scale, 100 * kDeg);
  EXPECT_DOUBLE_EQ(e.roll_offset, 0.1 * kDeg);
  EXPECT_EQ(e.time_skew, 1e-3);
  EXPECT_EQ(e.accel_bias, Eigen::Vector3d(1e-3, 2e-3, 3e-3));
  EXPECT_EQ(e.accel_scale, Eigen::Vector3d(1e-5, 2e-5, 3e-5));
  const Eigen::Matrix3d leaning{{0, 1e-6, 2e-6}, {3e-6, 0, 4e-6}, {5e-6, 6e-6, 0}};
  EXPECT_EQ(e.accel_misalignment, leaning);
  EXPECT_EQ(e.accel_noise, 2e-4);
  EXPECT_EQ(e.accel_quantization, 1e-4);
  EXPECT_EQ(e.accel_full_scale, 20);
  EXPECT_EQ(e.accel_lever_arm_T, Eigen::Vector3d(0, 0.01, 0.2));
  EXPECT_DOUBLE_EQ(e.mag_noise, 50e-9);
  EXPECT_EQ(e.clock_offset, 10);
  EXPECT_EQ(e.clock_drift, 1e-5);
  EXPECT_EQ(e.utc_jitter, 0.01);
  EXPECT_EQ(e.depth_offset, 0.5);
  EXPECT_EQ(e.depth_scale, 1e-4);
  EXPECT_EQ(e.depth_noise, 0.02);
  EXPECT_EQ(e.depth_resolution, 0.01);
  const SimulatedStreams& streams = file->simulation.streams;
  EXPECT_EQ(streams.imu_hz, 200);
  EXPECT_EQ(streams.depth_hz, 5);
  EXPECT_EQ(streams.batch, 50);
  EXPECT_EQ(streams.overlap, 10);
  EXPECT_EQ(streams.loss_probability, 0.01);
  ASSERT_EQ(streams.outages.size(), 2u);
  EXPECT_EQ(streams.outages[1].end, 31);
  EXPECT_EQ(streams.begin_utc.ns, 1'700'000'000'000'000'000);
  EXPECT_EQ(streams.session, 3);
  EXPECT_EQ(streams.run, 2);
  EXPECT_EQ(streams.tool, 1);
  EXPECT_EQ(file->channels.imu, "SIM_IMU");
}

TEST(ReadSimulation, SigmasDrawOneToolBySeed) {
  const std::string text = R"(format = "wellgyro.simulation/1"
seed = 7
well = {name = "vertical", end_md_m = 100}
run.step = [{stop_s = 1}]
earth.latitude_deg = 60
tool = {gyro_bias_sigma_deg_per_h = 2.0, accel_bias_mps2 = [1, 2, 3]}
)";
  const auto file = ParseWhole(text);
  ASSERT_TRUE(file) << file.fault().text;
  ErrorPriors priors;
  priors.gyro_bias_sigma = 2 * kDegPerHour;
  const ToolErrors drawn = DrawToolErrors(priors, {}, 7);
  EXPECT_EQ(file->simulation.tool.errors.gyro_bias, drawn.gyro_bias);
  EXPECT_NE(drawn.gyro_bias.x(), 0);
  EXPECT_EQ(file->simulation.tool.errors.accel_bias, Eigen::Vector3d(1, 2, 3));
}

// The inclination that the named well is meant to hold, by the simulator's own truth.
TEST(ReadSimulation, ABuiltWellHoldsItsInclination) {
  const auto file = ParseWhole(R"(format = "wellgyro.simulation/1"
run.step = [{stop_s = 1}]
earth.latitude_deg = 60
[well]
name = "build_hold"
end_md_m = 2000
kick_off_md_m = 400
build_rate_deg_per_30m = 2.0
inclination_deg = 45
azimuth_true_deg = 120
)");
  ASSERT_TRUE(file) << file.fault().text;
  const TruthWell well(file->simulation.well, file->simulation.earth);
  EXPECT_NEAR(well.PointAt(399).inclination, 0, 1e-12);
  EXPECT_NEAR(well.PointAt(1200).inclination, 45 * kDeg, 1e-12);
  EXPECT_NEAR(well.PointAt(1900).azimuth, 120 * kDeg, 1e-12);
  // 2 deg in 30 m between the ramps.
  EXPECT_NEAR(well.PointAt(630).inclination - well.PointAt(600).inclination, 2 * kDeg, 1e-12);
}

TEST(ReadSimulation, LawsAndStationsOfAFile) {
  const support::Scratch scratch;
  scratch.Write("well.csv", "MD[m],INC[deg],AZI_TRUE[deg]\r\n0,0,0\r\n100,1.5,370\r\n");
  scratch.Write("s.toml",
                "format = \"wellgyro.simulation/1\"\nwell.stations = \"well.csv\"\n"
                "run.step = [{stop_s = 1}]\nearth.latitude_deg = 60\n");
  const auto file = ReadSimulation(scratch.path() / "s.toml");
  ASSERT_TRUE(file) << file.fault().text;
  EXPECT_EQ(file->simulation.well.stations[1].md, 100);
  EXPECT_NEAR(file->simulation.well.stations[1].azimuth, 10 * kDeg, 1e-14);
  ASSERT_EQ(file->files.size(), 2u);
  EXPECT_EQ(file->files[1].role, "well");
  for (const char* odd : {"", "MD,INC,AZI\n0,0,0\n", "MD[m],INC[deg],AZI_TRUE[deg]\n0,0\n1,1,1\n",
                          "MD[m],INC[deg],AZI_TRUE[deg]\n0,0,0\n0,1,1\n",
                          "MD[m],INC[deg],AZI_TRUE[deg]\n0,0,0\n1,181,1\n",
                          "MD[m],INC[deg],AZI_TRUE[deg]\n0,0,0\n1,nan,1\n",
                          "MD[m],INC[deg],AZI_TRUE[deg]\n0,0,0\n"}) {
    scratch.Write("well.csv", odd);
    const auto refused = ReadSimulation(scratch.path() / "s.toml");
    ASSERT_FALSE(refused) << odd;
    EXPECT_THAT(refused.fault().source, HasSubstr("well.csv"));
    EXPECT_GT(refused.fault().line, 0);
  }
  const auto laws = ParseWhole(R"(format = "wellgyro.simulation/1"
run.step = [{stop_s = 1}]
earth.latitude_deg = 60
[well]
name = "laws"
end_md_m = 1000
[well.inclination]
start_deg = 3
[[well.inclination.term]]
begin_md_m = 100
end_md_m = 300
ramp_m = 20
rate_deg_per_30m = 1
amplitude_deg = 0.5
period_m = 70
phase_deg = 90
[well.azimuth]
start_deg = 200
)");
  ASSERT_TRUE(laws) << laws.fault().text;
  const AngleLaw& law = laws->simulation.well.inclination;
  EXPECT_DOUBLE_EQ(law.start, 3 * kDeg);
  ASSERT_EQ(law.terms.size(), 1u);
  EXPECT_EQ(law.terms[0].end_md, 300);
  EXPECT_DOUBLE_EQ(law.terms[0].rate, kDeg / 30);
  EXPECT_DOUBLE_EQ(laws->simulation.well.azimuth.start, 200 * kDeg);
}

TEST(ReadSimulation, FaultsHaveTheirSizeInTheUnitOfItsKey) {
  const auto file = ParseWhole(std::string(kWholeSimulation) + R"(
[[fault]]
cause = "gyro_step"
axis = "y"
begin_s = 1800
size_deg_per_h = 0.5
[[fault]]
cause = "accel_spike"
axis = "z"
every_s = 60
end_s = 600
size_mps2 = -2
[[fault]]
cause = "accels_swapped"
)");
  ASSERT_TRUE(file) << file.fault().text;
  const std::vector<SimulatedFault>& faults = file->simulation.faults;
  ASSERT_EQ(faults.size(), 3u);
  EXPECT_EQ(faults[0].cause, SimulatedFault::Cause::kGyroStep);
  EXPECT_EQ(faults[0].axis, 1);
  EXPECT_EQ(faults[0].begin, 1800);
  EXPECT_DOUBLE_EQ(faults[0].size, 0.5 * kDegPerHour);
  EXPECT_GT(faults[0].end, 1e300);
  EXPECT_EQ(faults[1].axis, 2);
  EXPECT_EQ(faults[1].period, 60);
  EXPECT_EQ(faults[1].end, 600);
  EXPECT_EQ(faults[1].size, -2);
  EXPECT_EQ(faults[2].cause, SimulatedFault::Cause::kAccelsSwapped);
}

TEST(ReadSimulation, AFaultThatCannotBeIsNamed) {
  const auto complaint = [](const std::string& fault) {
    const auto file = ParseWhole(std::string(kWholeSimulation) + "\n[[fault]]\n" + fault);
    return file ? std::string() : file.fault().text;
  };
  EXPECT_THAT(complaint("cause = \"rust\""), HasSubstr("is none of gyro_step, gyro_ramp"));
  EXPECT_THAT(complaint("cause = \"gyro_step\"\naxis = \"x\""), HasSubstr("size_deg_per_h"));
  EXPECT_THAT(complaint("cause = \"gyro_stuck\""), HasSubstr("axis"));
  EXPECT_THAT(complaint("cause = \"gyro_stuck\"\naxis = \"w\""), HasSubstr("w"));
  EXPECT_THAT(complaint("cause = \"depth_frozen\"\nbegin_s = 5\nend_s = 4"), HasSubstr("later"));
  EXPECT_THAT(complaint("cause = \"depth_frozen\"\nsize_m = 5"), HasSubstr("size_m"));
}

TEST(ReadSimulation, MistakesHaveTheirLine) {
  std::istringstream text{std::string(kWholeSimulation)};
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string key = lines[i].substr(0, lines[i].find(' '));
    if (lines[i].find(" = ") == std::string::npos) continue;
    for (const std::string& odd :
         {key + "_x" + lines[i].substr(key.size()), key + " = {}", key + " = nan"}) {
      std::string changed;
      for (std::size_t j = 0; j < lines.size(); ++j) changed += (j == i ? odd : lines[j]) + "\n";
      const auto file = ParseWhole(changed);
      ASSERT_FALSE(file) << odd;
      const bool whole_table =
          odd.starts_with("table_x") || odd.starts_with("stop_s_x") || odd.starts_with("to_md_m_x");
      if (!whole_table) {
        EXPECT_EQ(file.fault().line, static_cast<int>(i) + 1) << odd << file.fault().text;
      }
    }
  }
  EXPECT_FALSE(ParseWhole(""));
  EXPECT_THAT(ParseWhole("format = \"wellgyro.simulation/1\"").fault().text, HasSubstr("well"));
}

}  // namespace
}  // namespace wellgyro

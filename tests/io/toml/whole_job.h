#pragma once

#include <string_view>

#include "wellgyro/io/toml/job_file.h"

namespace wellgyro::test {

/// Every key of a job, but for those that exclude one another.
inline constexpr std::string_view kWholeJob = R"(format = "wellgyro.job/1"
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

/// A job file's text, as of a/job.toml.
inline Result<JobFile> ParsedJob(std::string_view text) {
  return ParseJob(text, "a/job.toml", "a");
}

}  // namespace wellgyro::test

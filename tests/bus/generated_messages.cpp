#include "bus/generated_messages.h"

namespace wellgyro::test {
namespace {

std::vector<double> Ramp(int n, double first, double step) {
  std::vector<double> values(static_cast<std::size_t>(n), first);
  for (std::size_t k = 0; k < values.size(); ++k) values[k] += step * static_cast<double>(k);
  return values;
}

void Triangle(double (&cov)[6], double scale) {
  const double values[6] = {4, 0.5, -0.25, 9, 0.125, 16};
  for (int i = 0; i < 6; ++i) cov[i] = scale * values[i];
}

}  // namespace

imu_batch_t GeneratedImu(int n, bool gz, bool mag) {
  imu_batch_t m{};
  m.utime_us = kUtimeUs;
  m.tool_ns = -987'654'321'012;
  m.seq = 5'000'000'123;
  m.session = -77;
  m.run = 3;
  m.tool = 2;
  m.period_ns = 2'500'000;
  m.status = imu_batch_t::ACCEL_SATURATED | 0;
  m.temperature_degc = 88.25F;
  m.n = n;
  m.n_gz = gz ? n : 0;
  m.n_mag = mag ? n : 0;
  m.gx_rps = Ramp(n, 1e-5, 1e-7);
  m.gy_rps = Ramp(n, -2e-5, 3e-7);
  m.gz_rps = Ramp(m.n_gz, 3e-5, -1e-7);
  m.ax_mps2 = Ramp(n, 9.1, 1e-4);
  m.ay_mps2 = Ramp(n, -1.2, 2e-4);
  m.az_mps2 = Ramp(n, -0.3, -3e-4);
  m.mx_t = Ramp(m.n_mag, 20e-6, 1e-9);
  m.my_t = Ramp(m.n_mag, -30e-6, 2e-9);
  m.mz_t = Ramp(m.n_mag, 40e-6, 3e-9);
  return m;
}

raw_batch_t GeneratedRaw(int n, int channels, int temperatures) {
  raw_batch_t m{};
  m.utime_us = kUtimeUs + 1;
  m.tool_ns = 123'456'789'000;
  m.seq = 42;
  m.session = 9;
  m.run = 1;
  m.period_ns = 1'000'000;
  m.status = imu_batch_t::GYRO_SATURATED | 0;
  m.tool = 1;
  m.n = n;
  m.n_channels = channels;
  m.n_values = n * channels;
  m.n_temperatures = temperatures;
  for (int i = 0; i < m.n_values; ++i) m.counts.push_back(i % 2 == 0 ? 1000 + i : -70'000 * i);
  for (int i = 0; i < temperatures; ++i) m.temperature_raw.push_back(0.5F + static_cast<float>(i));
  return m;
}

still_window_t GeneratedStill() {
  still_window_t m{};
  m.utime_us = kUtimeUs + 2;
  m.duration_ns = 90'000'000'500;
  m.seq = 17;
  m.session = 4;
  m.run = 2;
  m.tool = 1;
  m.status = still_window_t::HAS_GZ | still_window_t::HAS_MAG | still_window_t::HAS_MD |
             still_window_t::HAS_INDEX;
  m.index_position = -2;
  for (int i = 0; i < 3; ++i) {
    m.w_rps[i] = 1e-5 * (i + 1);
    m.sigma_w_rps[i] = 1e-8 * (i + 1);
    m.f_mps2[i] = -3.0 * (i + 1);
    m.sigma_f_mps2[i] = 1e-4 * (i + 1);
    m.m_t[i] = 1e-6 * (i - 7);
  }
  m.temperature_degc = 101.5;
  m.md_m = 2345.5;
  return m;
}

depth_t GeneratedDepth() {
  depth_t m{};
  m.utime_us = kUtimeUs + 3;
  m.seq = 1234;
  m.session = 6;
  m.run = 1;
  m.status = depth_t::CORRECTED | depth_t::HAS_SPEED | depth_t::HAS_TENSION | depth_t::HAS_SIGMA;
  m.source = depth_t::DRILLPIPE;
  m.md_m = 1500.25;
  m.speed_mps = -0.75;
  m.tension_n = 12'000.5;
  m.sigma_m = 0.125;
  return m;
}

tool_mode_t GeneratedMode() {
  tool_mode_t m{};
  m.utime_us = kUtimeUs + 4;
  m.seq = 8;
  m.session = 6;
  m.run = 5;
  m.mode = tool_mode_t::GYROCOMPASS;
  m.has_imu_seq = 1;
  m.imu_seq = 5'000'000'999;
  m.command_id = 31;
  m.has_index = 1;
  m.index_position = 3;
  m.index_angle_rad = 1.5;
  return m;
}

tool_info_t GeneratedTool() {
  tool_info_t m{};
  m.utime_us = kUtimeUs + 5;
  m.seq = 2;
  m.session = 6;
  m.run = 1;
  m.tool = 2;
  m.string_position = 1;
  m.sensor_below_reference_m = 4.5;
  m.asset_serial = "GWD-0042";
  m.sensor_serials = "g1;g2;a1";
  m.firmware = "";
  m.calibration_sha256 = std::string(64, 'b');
  return m;
}

event_t GeneratedEvent() {
  event_t m{};
  m.utime_us = kUtimeUs + 6;
  m.seq = 3;
  m.session = 6;
  m.run = 1;
  m.event = event_t::DEPTH_TIE;
  m.event_id = 12;
  m.has_value = 1;
  m.value_m = 812.75;
  m.sigma_m = 0.25;
  m.value_rad = 0.5;
  m.sigma_rad = 0.03125;
  m.what = "shoe";
  m.who = "";
  m.text =
      "13 3/8\" Schuh bei 812,75 m \xC3\xBC"
      "ber RKB";
  return m;
}

survey_cmd_t GeneratedCommand() {
  survey_cmd_t m{};
  m.utime_us = kUtimeUs + 7;
  m.seq = 4;
  m.session = 6;
  m.command_id = 99;
  m.command = survey_cmd_t::TAKE_STATION;
  m.has_duration = 1;
  m.duration_s = 120.5;
  m.has_md = 1;
  m.md_m = -3.5;
  return m;
}

survey_station_t GeneratedStation() {
  survey_station_t m{};
  m.utime_us = kUtimeUs + 8;
  m.seq = 5;
  m.session = 6;
  m.run = 1;
  m.run_pass = 2;
  m.station = 33;
  m.revision = 7;
  m.status = survey_station_t::DEFINITIVE;
  m.kind = survey_station_t::STILL;
  m.quality = 0x41;
  m.md_m = 1000.5;
  m.inclination_rad = 0.75;
  m.azimuth_true_rad = 6.25;
  m.toolface_rad = -1.25;
  Triangle(m.cov_md_inc_azi, 1e-6);
  m.north_m = 10;
  m.east_m = -20;
  m.tvd_m = 990;
  Triangle(m.cov_ned_m2, 2);
  m.gravity_mps2 = 9.8125;
  m.gravity_ref_mps2 = 9.8135;
  m.has_earth_rate = 1;
  m.earth_rate_rps = 3.5e-5;
  m.earth_rate_ref_rps = 3.25e-5;
  m.imu_seq_begin = 1'000'000;
  m.imu_seq_end = 1'024'000;
  m.samples_lost = 11;
  return m;
}

status_t GeneratedStatus() {
  status_t m{};
  m.utime_us = kUtimeUs + 9;
  m.seq = 6;
  m.session = 6;
  m.state = status_t::DEGRADED;
  m.last_command_id = 99;
  m.samples_received = 123'456'789'012;
  m.samples_lost = 5;
  m.gaps = 2;
  m.duplicates = 3;
  m.malformed = 4;
  m.has_kernel_drops = 1;
  m.kernel_drops = 8;
  m.latency_p99_s = 0.125;
  m.data_age_s = 0.5;
  m.text = "gap of 5";
  return m;
}

operation_t GeneratedOperation() {
  operation_t m{};
  m.utime_us = kUtimeUs + 10;
  m.session = 6;
  m.operation_id = 77;
  m.n_key = 32;
  m.n_content = 5;
  m.n_signature = 64;
  for (int i = 0; i < m.n_key; ++i) m.key.push_back(static_cast<std::uint8_t>(i));
  for (int i = 0; i < m.n_content; ++i) m.content.push_back(static_cast<std::uint8_t>(200 + i));
  for (int i = 0; i < m.n_signature; ++i) m.signature.push_back(static_cast<std::uint8_t>(99 - i));
  return m;
}

glance_t GeneratedGlance() {
  glance_t m{};
  m.utime_us = kUtimeUs + 11;
  m.seq = 7;
  m.session = 6;
  m.run = 2;
  m.has_depth = 1;
  m.md_m = 1234.5;
  m.speed_mps = -0.5;
  m.has_direction = 1;
  m.inclination_rad = 0.75;
  m.azimuth_true_rad = 6.125;
  m.sigma_azimuth_rad = 0.0078125;
  m.stations = 41;
  m.at_rest = 1;
  m.still_s = 12.5;
  m.still_needed_s = 60;
  m.samples_lost = 3;
  m.checks_warned = 1;
  m.checks_failed = 2;
  m.turned = "gravity";
  return m;
}

advice_t GeneratedAdvice() {
  advice_t m{};
  m.utime_us = kUtimeUs + 13;
  m.seq = 9;
  m.session = 6;
  m.run = 2;
  m.action = advice_t::STAY;
  m.more_s = 70;
  m.has_toolface = 1;
  m.toolface_rad = 0.5;
  m.has_next = 1;
  m.next_out = 1;
  m.next_md_m = 2810.5;
  m.next_stop_s = 330;
  m.next_has_toolface = 1;
  m.next_toolface_rad = 3.5;
  m.stops_left = 2;
  m.rest_left_s = 460;
  m.reachable = 1;
  m.ellipse_m = 4.875;
  m.ellipse_now_m = 6.25;
  m.ellipse_limit_m = 5;
  m.has_hidden = 1;
  m.hidden_m = 5.5;
  m.hidden_limit_m = 6;
  m.text = "stay 70 s more";
  return m;
}

request_t GeneratedRequest() {
  request_t m{};
  m.utime_us = kUtimeUs + 12;
  m.seq = 8;
  m.session = 6;
  m.from_revision = 4;
  return m;
}

std::vector<Sample> OneOfEach() {
  return {
      {MessageType::kRawBatch, BytesOf(GeneratedRaw(3, 5, 2))},
      {MessageType::kImuBatch, BytesOf(GeneratedImu(3, true, true))},
      {MessageType::kStillWindow, BytesOf(GeneratedStill())},
      {MessageType::kDepth, BytesOf(GeneratedDepth())},
      {MessageType::kToolMode, BytesOf(GeneratedMode())},
      {MessageType::kToolInfo, BytesOf(GeneratedTool())},
      {MessageType::kEvent, BytesOf(GeneratedEvent())},
      {MessageType::kCommand, BytesOf(GeneratedCommand())},
      {MessageType::kStation, BytesOf(GeneratedStation())},
      {MessageType::kStatus, BytesOf(GeneratedStatus())},
      {MessageType::kOperation, BytesOf(GeneratedOperation())},
      {MessageType::kGlance, BytesOf(GeneratedGlance())},
      {MessageType::kRequest, BytesOf(GeneratedRequest())},
      {MessageType::kAdvice, BytesOf(GeneratedAdvice())},
  };
}

}  // namespace wellgyro::test

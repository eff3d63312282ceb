#include <cmath>

#include <gtest/gtest.h>

#include "wellgyro/bus/encode.h"

#include "bus/decoded.h"
#include "bus/generated_messages.h"

// Both directions against the classes that lcm-gen writes: our reader must give every field of
// what they wrote, and our writer the same bytes again.
namespace wellgyro::test {
namespace {

void ExpectTriangle(const Eigen::Matrix3d& cov, const double (&triangle)[6]) {
  EXPECT_EQ(cov, cov.transpose());
  int i = 0;
  for (int row = 0; row < 3; ++row) {
    for (int column = row; column < 3; ++column) EXPECT_EQ(cov(row, column), triangle[i++]);
  }
}

TEST(Wire, Depth) {
  const depth_t m = GeneratedDepth();
  const auto d = Decoded<DepthMark>(MessageType::kDepth, BytesOf(m));
  EXPECT_EQ(d.utc.ns, m.utime_us * 1000);
  EXPECT_EQ(d.seq, m.seq);
  EXPECT_EQ(d.session, m.session);
  EXPECT_EQ(d.run, m.run);
  EXPECT_EQ(d.kind, DepthKind::kDrillPipe);
  EXPECT_EQ(d.md, m.md_m);
  EXPECT_EQ(d.speed, m.speed_mps);
  EXPECT_EQ(d.tension, m.tension_n);
  EXPECT_EQ(d.sigma, m.sigma_m);
  EXPECT_TRUE(d.corrected);
  EXPECT_FALSE(d.stopped || d.manual || d.magnetic_mark);
}

TEST(Wire, DepthWithoutItsOptionalFields) {
  depth_t m = GeneratedDepth();
  m.status = depth_t::STOPPED | depth_t::MANUAL | depth_t::MARK;
  m.speed_mps = m.tension_n = m.sigma_m = 0;
  const auto d = Decoded<DepthMark>(MessageType::kDepth, BytesOf(m));
  EXPECT_FALSE(d.speed || d.tension || d.sigma || d.corrected);
  EXPECT_TRUE(d.stopped && d.manual && d.magnetic_mark);
}

TEST(Wire, ToolMode) {
  const tool_mode_t m = GeneratedMode();
  const auto r = Decoded<ToolMode>(MessageType::kToolMode, BytesOf(m));
  EXPECT_EQ(r.utc.ns, m.utime_us * 1000);
  EXPECT_EQ(r.seq, m.seq);
  EXPECT_EQ(r.session, m.session);
  EXPECT_EQ(r.run, m.run);
  EXPECT_EQ(r.mode, ToolMode::Mode::kGyrocompass);
  EXPECT_EQ(r.imu_seq, m.imu_seq);
  EXPECT_EQ(r.command_id, m.command_id);
  EXPECT_EQ(r.index_position, m.index_position);
  EXPECT_EQ(r.index_angle, m.index_angle_rad);
}

TEST(Wire, ToolInfo) {
  const tool_info_t m = GeneratedTool();
  const auto r = Decoded<ToolInfo>(MessageType::kToolInfo, BytesOf(m));
  EXPECT_EQ(r.utc.ns, m.utime_us * 1000);
  EXPECT_EQ(r.seq, m.seq);
  EXPECT_EQ(r.session, m.session);
  EXPECT_EQ(r.run, m.run);
  EXPECT_EQ(r.tool, m.tool);
  EXPECT_EQ(r.string_position, m.string_position);
  EXPECT_EQ(r.sensor_below_reference, m.sensor_below_reference_m);
  EXPECT_EQ(r.asset_serial, m.asset_serial);
  EXPECT_EQ(r.sensor_serials, m.sensor_serials);
  EXPECT_EQ(r.firmware, "");
  EXPECT_EQ(r.calibration_sha256, m.calibration_sha256);
}

TEST(Wire, Event) {
  const event_t m = GeneratedEvent();
  const auto r = Decoded<wellgyro::Event>(MessageType::kEvent, BytesOf(m));
  EXPECT_EQ(r.utc.ns, m.utime_us * 1000);
  EXPECT_EQ(r.seq, m.seq);
  EXPECT_EQ(r.session, m.session);
  EXPECT_EQ(r.run, m.run);
  EXPECT_EQ(r.kind, wellgyro::Event::Kind::kDepthTie);
  EXPECT_EQ(r.event_id, m.event_id);
  EXPECT_TRUE(r.has_value);
  EXPECT_EQ(r.value_m, m.value_m);
  EXPECT_EQ(r.sigma_m, m.sigma_m);
  EXPECT_EQ(r.value_rad, m.value_rad);
  EXPECT_EQ(r.sigma_rad, m.sigma_rad);
  EXPECT_EQ(r.what, m.what);
  EXPECT_EQ(r.who, "");
  EXPECT_EQ(r.text, m.text);
}

TEST(Wire, Command) {
  const survey_cmd_t m = GeneratedCommand();
  const auto r = Decoded<Command>(MessageType::kCommand, BytesOf(m));
  EXPECT_EQ(r.utc.ns, m.utime_us * 1000);
  EXPECT_EQ(r.seq, m.seq);
  EXPECT_EQ(r.session, m.session);
  EXPECT_EQ(r.command_id, m.command_id);
  EXPECT_EQ(r.kind, Command::Kind::kTakeStation);
  EXPECT_EQ(r.duration, m.duration_s);
  EXPECT_EQ(r.md, m.md_m);
}

TEST(Wire, Station) {
  const survey_station_t m = GeneratedStation();
  const auto sent = Decoded<SentStation>(MessageType::kStation, BytesOf(m));
  const Station& r = sent.station;
  EXPECT_EQ(r.utc.ns, m.utime_us * 1000);
  EXPECT_EQ(sent.seq, m.seq);
  EXPECT_EQ(sent.session, m.session);
  EXPECT_EQ(r.run, m.run);
  EXPECT_EQ(r.pass, Pass::kOut);
  EXPECT_EQ(r.number, m.station);
  EXPECT_EQ(r.revision, m.revision);
  EXPECT_EQ(r.status, StationStatus::kDefinitive);
  EXPECT_EQ(r.kind, StationKind::kStill);
  EXPECT_EQ(r.quality, Quality::kMoved | Quality::kTemperature);
  EXPECT_EQ(r.md, m.md_m);
  EXPECT_EQ(r.inclination, m.inclination_rad);
  EXPECT_EQ(r.azimuth, m.azimuth_true_rad);
  const Eigen::Vector3d tangent_L(std::sin(r.inclination) * std::cos(r.azimuth),
                                  std::sin(r.inclination) * std::sin(r.azimuth),
                                  std::cos(r.inclination));
  EXPECT_LT((r.tangent_L - tangent_L).norm(), 4e-16);
  EXPECT_EQ(r.toolface, m.toolface_rad);
  ExpectTriangle(r.cov_md_inc_azi, m.cov_md_inc_azi);
  EXPECT_EQ(r.p_WT_W, Eigen::Vector3d(m.north_m, m.east_m, m.tvd_m));
  ExpectTriangle(r.cov_p_WT_W, m.cov_ned_m2);
  EXPECT_EQ(r.gravity, m.gravity_mps2);
  EXPECT_EQ(r.gravity_ref, m.gravity_ref_mps2);
  EXPECT_EQ(r.earth_rate, m.earth_rate_rps);
  EXPECT_EQ(r.earth_rate_ref, m.earth_rate_ref_rps);
  EXPECT_EQ(r.imu_seq_begin, m.imu_seq_begin);
  EXPECT_EQ(r.imu_seq_end, m.imu_seq_end);
  EXPECT_EQ(r.samples_lost, m.samples_lost);
}

TEST(Wire, Status) {
  const status_t m = GeneratedStatus();
  const auto r = Decoded<Status>(MessageType::kStatus, BytesOf(m));
  EXPECT_EQ(r.utc.ns, m.utime_us * 1000);
  EXPECT_EQ(r.seq, m.seq);
  EXPECT_EQ(r.session, m.session);
  EXPECT_EQ(r.state, Status::State::kDegraded);
  EXPECT_EQ(r.last_command_id, m.last_command_id);
  EXPECT_EQ(r.samples_received, m.samples_received);
  EXPECT_EQ(r.samples_lost, m.samples_lost);
  EXPECT_EQ(r.gaps, m.gaps);
  EXPECT_EQ(r.duplicates, m.duplicates);
  EXPECT_EQ(r.malformed, m.malformed);
  EXPECT_EQ(r.kernel_drops, m.kernel_drops);
  EXPECT_EQ(r.latency_p99, m.latency_p99_s);
  EXPECT_EQ(r.data_age, m.data_age_s);
  EXPECT_EQ(r.text, m.text);
}

TEST(Wire, EveryEnumeratorStandsForItsConstant) {
  EXPECT_EQ(static_cast<int>(DepthKind::kOther), int{depth_t::OTHER});
  EXPECT_EQ(static_cast<int>(DepthKind::kWireline), int{depth_t::WIRELINE});
  EXPECT_EQ(static_cast<int>(ToolMode::Mode::kIdle), int{tool_mode_t::IDLE});
  EXPECT_EQ(static_cast<int>(ToolMode::Mode::kContinuous), int{tool_mode_t::CONTINUOUS});
  EXPECT_EQ(static_cast<int>(wellgyro::Event::Kind::kDepthZero), int{event_t::DEPTH_ZERO});
  EXPECT_EQ(static_cast<int>(wellgyro::Event::Kind::kForesight), int{event_t::FORESIGHT});
  EXPECT_EQ(static_cast<int>(wellgyro::Event::Kind::kRemark), int{event_t::REMARK});
  EXPECT_EQ(static_cast<int>(Command::Kind::kAbort), int{survey_cmd_t::ABORT});
  EXPECT_EQ(static_cast<int>(Command::Kind::kFinish), int{survey_cmd_t::FINISH});
  EXPECT_EQ(static_cast<int>(StationKind::kStill), int{survey_station_t::STILL});
  EXPECT_EQ(static_cast<int>(StationStatus::kSuperseded), int{survey_station_t::SUPERSEDED});
  EXPECT_EQ(static_cast<int>(Status::State::kFault), int{status_t::FAULT});
}

TEST(Wire, TimesTravelInWholeMicroseconds) {
  DepthMark mark;
  mark.utc.ns = 1'999;
  Bytes bytes;
  Encode(mark, bytes);
  EXPECT_EQ(std::get<DepthMark>(*Decode(MessageType::kDepth, bytes)).utc.ns, 1'000);
}

TEST(Wire, Operation) {
  const operation_t m = GeneratedOperation();
  const auto r = Decoded<SignedOperation>(MessageType::kOperation, BytesOf(m));
  EXPECT_EQ(r.utc.ns, m.utime_us * 1000);
  EXPECT_EQ(r.session, m.session);
  EXPECT_EQ(r.id, m.operation_id);
  ASSERT_EQ(r.key.size(), m.key.size());
  ASSERT_EQ(r.content.size(), m.content.size());
  ASSERT_EQ(r.signature.size(), m.signature.size());
  EXPECT_EQ(r.key[31], std::byte{31});
  EXPECT_EQ(r.content[4], std::byte{204});
  EXPECT_EQ(r.signature[63], std::byte{36});
}

TEST(Wire, Glance) {
  const glance_t m = GeneratedGlance();
  const auto r = Decoded<Glance>(MessageType::kGlance, BytesOf(m));
  EXPECT_EQ(r.utc.ns, m.utime_us * 1000);
  EXPECT_EQ(r.run, m.run);
  EXPECT_EQ(r.md, m.md_m);
  EXPECT_EQ(r.speed, m.speed_mps);
  EXPECT_EQ(r.inclination, m.inclination_rad);
  EXPECT_EQ(r.azimuth, m.azimuth_true_rad);
  EXPECT_EQ(r.sigma_azimuth, m.sigma_azimuth_rad);
  EXPECT_EQ(r.stations, m.stations);
  EXPECT_EQ(r.still, m.still_s);
  EXPECT_EQ(r.still_needed, m.still_needed_s);
  EXPECT_EQ(r.samples_lost, m.samples_lost);
  EXPECT_EQ(r.checks_warned, m.checks_warned);
  EXPECT_EQ(r.checks_failed, m.checks_failed);
  EXPECT_EQ(r.turned, m.turned);
}

TEST(Wire, Advice) {
  const advice_t m = GeneratedAdvice();
  const auto r = Decoded<Advice>(MessageType::kAdvice, BytesOf(m));
  EXPECT_EQ(r.utc.ns, m.utime_us * 1000);
  EXPECT_EQ(r.run, m.run);
  EXPECT_EQ(r.action, Advice::Action::kStay);
  EXPECT_EQ(r.seconds, m.more_s);
  EXPECT_EQ(r.toolface, m.toolface_rad);
  ASSERT_TRUE(r.next);
  EXPECT_EQ(r.next->out, m.next_out == 1);
  EXPECT_EQ(r.next->md, m.next_md_m);
  EXPECT_EQ(r.next->seconds, m.next_stop_s);
  EXPECT_EQ(r.next->toolface, m.next_toolface_rad);
  EXPECT_EQ(r.stops_left, m.stops_left);
  EXPECT_EQ(r.rest_left, m.rest_left_s);
  EXPECT_TRUE(r.reachable);
  EXPECT_EQ(r.ellipse, m.ellipse_m);
  EXPECT_EQ(r.ellipse_now, m.ellipse_now_m);
  EXPECT_EQ(r.ellipse_limit, m.ellipse_limit_m);
  EXPECT_EQ(r.hidden, m.hidden_m);
  EXPECT_EQ(r.hidden_limit, m.hidden_limit_m);
  EXPECT_EQ(r.text, m.text);
  advice_t none = m;
  none.has_next = none.next_out = none.next_has_toolface = none.has_hidden = none.has_toolface = 0;
  none.next_md_m = none.next_stop_s = none.next_toolface_rad = none.toolface_rad = 0;
  none.hidden_m = none.hidden_limit_m = 0;
  const auto bare = Decoded<Advice>(MessageType::kAdvice, BytesOf(none));
  EXPECT_FALSE(bare.next || bare.hidden || bare.hidden_limit || bare.toolface);
}

TEST(Wire, Request) {
  const request_t m = GeneratedRequest();
  const auto r = Decoded<StationRequest>(MessageType::kRequest, BytesOf(m));
  EXPECT_EQ(r.utc.ns, m.utime_us * 1000);
  EXPECT_EQ(r.seq, m.seq);
  EXPECT_EQ(r.from_revision, m.from_revision);
}

}  // namespace
}  // namespace wellgyro::test

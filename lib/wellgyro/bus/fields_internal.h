#pragma once

#include "wellgyro/bus/field_reader_internal.h"
#include "wellgyro/bus/message.h"
#include "wellgyro/depth_t.hpp"
#include "wellgyro/still_window_t.hpp"

/// The fields of each message in the order of its .lcm, once for both directions: `Io` is a
/// FieldReader with a record, or a FieldWriter with a const record.
namespace wellgyro {

template <class Io, class Vector>
void NumbersOf(Io& io, const char* name, Vector& vector) {
  for (int i = 0; i < 3; ++i) io.Number(name, vector[i]);
}

template <class Io, class Vector>
void SigmasOf(Io& io, const char* name, Vector& vector) {
  for (int i = 0; i < 3; ++i) io.NotNegative(name, vector[i]);
}

/// Upper triangle of a covariance, row by row.
template <class Io, class Matrix>
void CovarianceOf(Io& io, const char* name, Matrix& cov) {
  for (int row = 0; row < 3; ++row) {
    io.NotNegative(name, cov(row, row));
    for (int column = row + 1; column < 3; ++column) io.Number(name, cov(row, column));
  }
}

/// `duration_ns` stands for the record's two ends; index position and depth by their bits.
template <class Io, class Record>
void Fields(Io& io, Record& r,
            auto& duration_ns) requires std::is_same_v<std::remove_const_t<Record>, StillWindow> {
  bool has_md = r.md.has_value();
  bool has_index = r.index_position.has_value();
  io.Utc("utime_us", r.utc_begin);
  io.Count("duration_ns", duration_ns);
  io.Count("seq", r.seq_begin);
  io.Int("session", r.session);
  io.Count("run", r.run);
  io.Count("tool", r.tool);
  io.Bits("status", Bit{still_window_t::HAS_GZ, r.has_gz}, Bit{still_window_t::HAS_MAG, r.has_mag},
          Bit{still_window_t::HAS_MD, has_md}, Bit{still_window_t::HAS_INDEX, has_index});
  io.OptionalInt("index_position", has_index, r.index_position);
  io.Number("w_rps", r.w_IT_T[0]);
  io.Number("w_rps", r.w_IT_T[1]);
  io.NumberIf("w_rps", r.has_gz, r.w_IT_T[2]);
  io.NotNegative("sigma_w_rps", r.sigma_w_IT_T[0]);
  io.NotNegative("sigma_w_rps", r.sigma_w_IT_T[1]);
  io.NotNegativeIf("sigma_w_rps", r.has_gz, r.sigma_w_IT_T[2]);
  NumbersOf(io, "f_mps2", r.f_T);
  SigmasOf(io, "sigma_f_mps2", r.sigma_f_T);
  for (int i = 0; i < 3; ++i) io.NumberIf("m_t", r.has_mag, r.b_T[i]);
  io.Number("temperature_degc", r.temperature);
  io.Optional("md_m", has_md, r.md);
}

template <class Io, class Record>
void Fields(Io& io, Record& r) requires std::is_same_v<std::remove_const_t<Record>, DepthMark> {
  bool has_speed = r.speed.has_value();
  bool has_tension = r.tension.has_value();
  bool has_sigma = r.sigma.has_value();
  io.Utc("utime_us", r.utc);
  io.Count("seq", r.seq);
  io.Int("session", r.session);
  io.Count("run", r.run);
  io.Bits("status", Bit{depth_t::STOPPED, r.stopped}, Bit{depth_t::CORRECTED, r.corrected},
          Bit{depth_t::MANUAL, r.manual}, Bit{depth_t::HAS_SPEED, has_speed},
          Bit{depth_t::HAS_TENSION, has_tension}, Bit{depth_t::HAS_SIGMA, has_sigma},
          Bit{depth_t::MARK, r.magnetic_mark});
  io.Choice("source", r.kind, DepthKind::kIndicated, DepthKind::kOther);
  io.Number("md_m", r.md);
  io.Optional("speed_mps", has_speed, r.speed);
  io.Optional("tension_n", has_tension, r.tension);
  io.OptionalNotNegative("sigma_m", has_sigma, r.sigma);
}

template <class Io, class Record>
void Fields(Io& io, Record& r) requires std::is_same_v<std::remove_const_t<Record>, ToolMode> {
  bool has_imu_seq = r.imu_seq.has_value();
  bool has_index = r.index_position.has_value();
  io.Utc("utime_us", r.utc);
  io.Count("seq", r.seq);
  io.Int("session", r.session);
  io.Count("run", r.run);
  io.Choice("mode", r.mode, ToolMode::Mode::kUnknown, ToolMode::Mode::kContinuous);
  io.Flag("has_imu_seq", has_imu_seq);
  io.OptionalCount("imu_seq", has_imu_seq, r.imu_seq);
  io.Int("command_id", r.command_id);
  io.Flag("has_index", has_index);
  io.OptionalInt("index_position", has_index, r.index_position);
  io.NumberIf("index_angle_rad", has_index, r.index_angle);
}

template <class Io, class Record>
void Fields(Io& io, Record& r) requires std::is_same_v<std::remove_const_t<Record>, ToolInfo> {
  io.Utc("utime_us", r.utc);
  io.Count("seq", r.seq);
  io.Int("session", r.session);
  io.Count("run", r.run);
  io.Count("tool", r.tool);
  io.Count("string_position", r.string_position);
  io.Number("sensor_below_reference_m", r.sensor_below_reference);
  io.String("asset_serial", r.asset_serial);
  io.String("sensor_serials", r.sensor_serials);
  io.String("firmware", r.firmware);
  io.String("calibration_sha256", r.calibration_sha256);
}

template <class Io, class Record>
void Fields(Io& io, Record& r) requires std::is_same_v<std::remove_const_t<Record>, Event> {
  io.Utc("utime_us", r.utc);
  io.Count("seq", r.seq);
  io.Int("session", r.session);
  io.Count("run", r.run);
  io.Choice("event", r.kind, Event::Kind::kDepthZero, Event::Kind::kRemark);
  io.Int("event_id", r.event_id);
  io.Flag("has_value", r.has_value);
  io.NumberIf("value_m", r.has_value, r.value_m);
  io.NotNegativeIf("sigma_m", r.has_value, r.sigma_m);
  io.NumberIf("value_rad", r.has_value, r.value_rad);
  io.NotNegativeIf("sigma_rad", r.has_value, r.sigma_rad);
  io.String("what", r.what);
  io.String("who", r.who);
  io.String("text", r.text);
}

template <class Io, class Record>
void Fields(Io& io, Record& r) requires std::is_same_v<std::remove_const_t<Record>, Command> {
  bool has_duration = r.duration.has_value();
  bool has_md = r.md.has_value();
  io.Utc("utime_us", r.utc);
  io.Count("seq", r.seq);
  io.Int("session", r.session);
  io.Int("command_id", r.command_id);
  io.Choice("command", r.kind, Command::Kind::kNone, Command::Kind::kFinish);
  io.Flag("has_duration", has_duration);
  io.OptionalNotNegative("duration_s", has_duration, r.duration);
  io.Flag("has_md", has_md);
  io.Optional("md_m", has_md, r.md);
}

/// `quality` stands for the record's set of bits.
template <class Io, class Record>
void Fields(Io& io, Record& sent,
            auto& quality) requires std::is_same_v<std::remove_const_t<Record>, SentStation> {
  auto& r = sent.station;
  bool has_earth_rate = r.earth_rate.has_value();
  io.Utc("utime_us", r.utc);
  io.Count("seq", sent.seq);
  io.Int("session", sent.session);
  io.Count("run", r.run);
  io.Choice("run_pass", r.pass, Pass::kStationary, Pass::kRepeat);
  io.Count("station", r.number);
  io.Count("revision", r.revision);
  io.Choice("status", r.status, StationStatus::kProvisional, StationStatus::kSuperseded);
  io.Choice("kind", r.kind, StationKind::kTieIn, StationKind::kStill);
  io.Int("quality", quality);
  io.Number("md_m", r.md);
  io.Number("inclination_rad", r.inclination);
  io.Number("azimuth_true_rad", r.azimuth);
  io.Number("toolface_rad", r.toolface);
  CovarianceOf(io, "cov_md_inc_azi", r.cov_md_inc_azi);
  NumbersOf(io, "north_m, east_m, tvd_m", r.p_WT_W);
  CovarianceOf(io, "cov_ned_m2", r.cov_p_WT_W);
  io.Number("gravity_mps2", r.gravity);
  io.Number("gravity_ref_mps2", r.gravity_ref);
  io.Flag("has_earth_rate", has_earth_rate);
  io.Optional("earth_rate_rps", has_earth_rate, r.earth_rate);
  io.NumberIf("earth_rate_ref_rps", has_earth_rate, r.earth_rate_ref);
  io.Count("imu_seq_begin", r.imu_seq_begin);
  io.Count("imu_seq_end", r.imu_seq_end);
  io.Count("samples_lost", r.samples_lost);
}

/// The counts stand for the sizes of the record's byte strings.
template <class Io, class Record>
void Fields(Io& io, Record& r, auto& n_key, auto& n_content, auto& n_signature) requires
    std::is_same_v<std::remove_const_t<Record>, SignedOperation> {
  io.Utc("utime_us", r.utc);
  io.Int("session", r.session);
  io.Int("operation_id", r.id);
  io.Within("n_key", n_key, std::int32_t{0}, kKeyMax);
  io.Within("n_content", n_content, std::int32_t{0}, kContentMax);
  io.Within("n_signature", n_signature, std::int32_t{0}, kKeyMax);
  io.Bytes("key", r.key, n_key);
  io.Bytes("content", r.content, n_content);
  io.Bytes("signature", r.signature, n_signature);
}

template <class Io, class Record>
void Fields(Io& io, Record& r) requires std::is_same_v<std::remove_const_t<Record>, Glance> {
  bool has_depth = r.md.has_value();
  bool has_direction = r.inclination.has_value() && r.azimuth.has_value();
  bool at_rest = r.still.has_value();
  io.Utc("utime_us", r.utc);
  io.Count("seq", r.seq);
  io.Int("session", r.session);
  io.Count("run", r.run);
  io.Flag("has_depth", has_depth);
  io.Optional("md_m", has_depth, r.md);
  io.Optional("speed_mps", has_depth, r.speed);
  io.Flag("has_direction", has_direction);
  io.Optional("inclination_rad", has_direction, r.inclination);
  io.Optional("azimuth_true_rad", has_direction, r.azimuth);
  io.NotNegative("sigma_azimuth_rad", r.sigma_azimuth);
  io.Count("stations", r.stations);
  io.Flag("at_rest", at_rest);
  io.OptionalNotNegative("still_s", at_rest, r.still);
  io.NotNegative("still_needed_s", r.still_needed);
  io.Count("samples_lost", r.samples_lost);
  io.Count("checks_warned", r.checks_warned);
  io.Count("checks_failed", r.checks_failed);
  io.String("turned", r.turned);
}

template <class Io, class Record>
void Fields(Io& io, Record& r) requires std::is_same_v<std::remove_const_t<Record>, Advice> {
  bool has_toolface = r.toolface.has_value();
  bool has_next = r.next.has_value();
  Advice::Next next = r.next.value_or(Advice::Next());
  bool next_has_toolface = next.toolface.has_value();
  bool has_hidden = r.hidden.has_value() && r.hidden_limit.has_value();
  io.Utc("utime_us", r.utc);
  io.Count("seq", r.seq);
  io.Int("session", r.session);
  io.Count("run", r.run);
  io.Choice("action", r.action, Advice::Action::kNone, Advice::Action::kMoveOn);
  io.NotNegative("more_s", r.seconds);
  io.Flag("has_toolface", has_toolface);
  io.Optional("toolface_rad", has_toolface, r.toolface);
  io.Flag("has_next", has_next);
  io.Flag("next_out", next.out);
  io.Number("next_md_m", next.md);
  io.NotNegative("next_stop_s", next.seconds);
  io.Flag("next_has_toolface", next_has_toolface);
  io.Optional("next_toolface_rad", next_has_toolface, next.toolface);
  io.Count("stops_left", r.stops_left);
  io.NotNegative("rest_left_s", r.rest_left);
  io.Flag("reachable", r.reachable);
  io.NotNegative("ellipse_m", r.ellipse);
  io.NotNegative("ellipse_now_m", r.ellipse_now);
  io.NotNegative("ellipse_limit_m", r.ellipse_limit);
  io.Flag("has_hidden", has_hidden);
  io.OptionalNotNegative("hidden_m", has_hidden, r.hidden);
  io.OptionalNotNegative("hidden_limit_m", has_hidden, r.hidden_limit);
  io.String("text", r.text);
  if constexpr (!std::is_const_v<Record>) {
    r.next = has_next ? std::optional(next) : std::nullopt;
  }
}

template <class Io, class Record>
void Fields(Io& io,
            Record& r) requires std::is_same_v<std::remove_const_t<Record>, StationRequest> {
  io.Utc("utime_us", r.utc);
  io.Count("seq", r.seq);
  io.Int("session", r.session);
  io.Count("from_revision", r.from_revision);
}

template <class Io, class Record>
void Fields(Io& io, Record& r) requires std::is_same_v<std::remove_const_t<Record>, Status> {
  bool has_kernel_drops = r.kernel_drops.has_value();
  io.Utc("utime_us", r.utc);
  io.Count("seq", r.seq);
  io.Int("session", r.session);
  io.Choice("state", r.state, Status::State::kOk, Status::State::kFault);
  io.Int("last_command_id", r.last_command_id);
  io.Count("samples_received", r.samples_received);
  io.Count("samples_lost", r.samples_lost);
  io.Count("gaps", r.gaps);
  io.Count("duplicates", r.duplicates);
  io.Count("malformed", r.malformed);
  io.Flag("has_kernel_drops", has_kernel_drops);
  io.OptionalCount("kernel_drops", has_kernel_drops, r.kernel_drops);
  io.Number("latency_p99_s", r.latency_p99);
  io.Number("data_age_s", r.data_age);
  io.String("text", r.text);
}

}  // namespace wellgyro

#pragma once

#include "wellgyro/bus/field_reader_internal.h"
#include "wellgyro/bus/message.h"
#include "wellgyro/depth_t.hpp"
#include "wellgyro/still_window_t.hpp"

/// The fields of each message in the order of its .lcm, once for both directions: `Io` is a
/// FieldReader with a record, or a FieldWriter with a const record, so that what the one refuses
/// the other does. Local `has_` flags stand for a record's optional members: written as these are,
/// read before them. Here what goes into a survey; said_fields_internal.h has what a survey says.
namespace wellgyro {

/// Three components of a vector, each finite.
template <class Io, class Vector>
void NumbersOf(Io& io, const char* name, Vector& vector) {
  for (int i = 0; i < 3; ++i) io.Number(name, vector[i]);
}

/// Three 1-sigmas, each finite and not negative.
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

/// depth_t: speed, tension and sigma by their status bits, the kind of depth by `source`.
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

/// tool_mode_t: the sample number from which it holds, and the index position, where they are
/// known.
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

/// tool_info_t: a tool of the string, and where its sensor point is.
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

/// event_t: one flag says that value and sigma are there, in metres and in radians alike; which of
/// them counts follows from the kind of event.
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

/// survey_cmd_t: duration and depth where the command has them.
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

}  // namespace wellgyro

#pragma once

#include "wellgyro/bus/fields_internal.h"
#include "wellgyro/bus/message.h"
#include "wellgyro/bus/range_internal.h"

/// The fields of what a survey says, and of orders that go with a signature; see fields_internal.h.
namespace wellgyro {

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

/// glance_t: depth with speed, inclination with azimuth, each pair by one flag.
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

/// advice_t: the next stop's fields are there whether or not there is one, so that the size of the
/// message does not depend on it.
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

/// request_t: stations of this revision and later ones are asked for again.
template <class Io, class Record>
void Fields(Io& io,
            Record& r) requires std::is_same_v<std::remove_const_t<Record>, StationRequest> {
  io.Utc("utime_us", r.utc);
  io.Count("seq", r.seq);
  io.Int("session", r.session);
  io.Count("from_revision", r.from_revision);
}

/// status_t: health of one program; drops of the system's where it says so.
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

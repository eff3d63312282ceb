#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "wellgyro/base/result.h"
#include "wellgyro/bus/bytes_internal.h"
#include "wellgyro/bus/field_reader_internal.h"
#include "wellgyro/bus/message.h"
#include "wellgyro/bus/range_internal.h"
#include "wellgyro/imu_batch_t.hpp"
#include "wellgyro/raw_batch_t.hpp"

/// What stands before the arrays of the two batch types: all that decides the size.
namespace wellgyro {

static_assert(kBatchMax == imu_batch_t::N_MAX && kBatchMax == raw_batch_t::N_MAX);
static_assert(RawSample::kChannelsMax == raw_batch_t::CHANNELS_MAX);

inline constexpr std::size_t kFingerprintSize = 8;  ///< [bytes], before all fields
inline constexpr std::size_t kArraysAt = 68;        ///< byte in both types

/// The fields of imu_batch_t before its arrays: all that says how long it is.
struct ImuHead {
  SampleStamp stamp;  ///< of sample 0
  std::int32_t n = 0;
  std::int32_t n_gz = 0;
  std::int32_t n_mag = 0;

  /// Doubles in the arrays: two gyros and three accelerometers a sample, a third gyro and a field
  /// where the counts say so.
  std::size_t values() const {
    return 5 * static_cast<std::size_t>(n) + static_cast<std::size_t>(n_gz) +
           3 * static_cast<std::size_t>(n_mag);
  }
  std::size_t size() const { return kArraysAt + values() * sizeof(double); }
};

/// The fields of raw_batch_t before its arrays.
struct RawHead {
  SampleStamp stamp;  ///< of sample 0
  std::int32_t n = 0;
  std::int32_t n_channels = 0;
  std::int32_t n_values = 0;
  std::int32_t n_temperatures = 0;

  /// 32-bit counts in the arrays.
  std::size_t values() const {
    return static_cast<std::size_t>(n_values) + static_cast<std::size_t>(n_temperatures);
  }
  std::size_t size() const { return kArraysAt + values() * sizeof(std::int32_t); }
};

/// n_values of a raw batch; 0 when the counts are out of range.
constexpr std::int32_t CountsIn(std::int32_t n, std::int32_t n_channels) {
  const bool good =
      n >= 1 && n <= kBatchMax && n_channels >= 1 && n_channels <= RawSample::kChannelsMax;
  return good ? n * n_channels : 0;
}

/// Status bits that both types of batch have.
template <class Io, class Stamp>
void StatusBits(Io& io, Stamp& stamp) {
  io.Bits("status", Bit{imu_batch_t::GYRO_SATURATED, stamp.gyro_saturated},
          Bit{imu_batch_t::ACCEL_SATURATED, stamp.accel_saturated},
          Bit{imu_batch_t::TIME_UNSYNCED, stamp.utc_unsynced},
          Bit{imu_batch_t::SIMULATED, stamp.simulated});
}

/// Length of a sample, at least 1 ns.
template <class Io, class Stamp>
void PeriodOf(Io& io, Stamp& stamp) {
  io.Within("period_ns", stamp.period_ns, std::int32_t{1}, INT32_MAX);
}

/// Both clocks, number, session and run of sample 0.
template <class Io, class Stamp>
void TimesOf(Io& io, Stamp& stamp) {
  io.Utc("utime_us", stamp.utc);
  io.Within("tool_ns", stamp.tool_time.ns, -kToolTimeMax, kToolTimeMax);
  io.Count("seq", stamp.seq);
  io.Int("session", stamp.session);
  io.Count("run", stamp.run);
}

/// A third gyro and a field are there for every sample or for none.
template <class Io, class Head>
void Fields(Io& io, Head& h) requires std::is_same_v<std::remove_const_t<Head>, ImuHead> {
  TimesOf(io, h.stamp);
  io.Count("tool", h.stamp.tool);
  PeriodOf(io, h.stamp);
  StatusBits(io, h.stamp);
  io.Number("temperature_degc", h.stamp.temperature);
  io.Within("n", h.n, std::int32_t{1}, kBatchMax);
  io.ZeroOr("n_gz", h.n_gz, h.n);
  io.ZeroOr("n_mag", h.n_mag, h.n);
}

/// The number of values must be that of samples times channels.
template <class Io, class Head>
void Fields(Io& io, Head& h) requires std::is_same_v<std::remove_const_t<Head>, RawHead> {
  TimesOf(io, h.stamp);
  PeriodOf(io, h.stamp);
  StatusBits(io, h.stamp);
  io.Count("tool", h.stamp.tool);
  io.Within("n", h.n, std::int32_t{1}, kBatchMax);
  io.Within("n_channels", h.n_channels, std::int32_t{1}, RawSample::kChannelsMax);
  const std::int32_t n_values = CountsIn(h.n, h.n_channels);
  io.Within("n_values", h.n_values, n_values, n_values);
  io.Within("n_temperatures", h.n_temperatures, std::int32_t{0}, RawSample::kTemperaturesMax);
}

/// The fingerprint is that of `expected`; otherwise what it is instead.
std::optional<Fault> CheckFingerprint(MessageType expected, std::span<const std::byte> bytes);

/// `fault` with the message's type in front of its text, and the channel as its source.
Fault Placed(Fault fault, MessageType type, std::string_view channel);

}  // namespace wellgyro

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "wellgyro/bus/batch_internal.h"
#include "wellgyro/bus/decode.h"
#include "wellgyro/bus/encode.h"
#include "wellgyro/bus/field_writer_internal.h"
#include "wellgyro/record/sample_block.h"

namespace wellgyro {
namespace {

/// The head of a batch whose counts are good and whose size is theirs.
template <class Head>
Result<Head> ReadHead(MessageType type, std::span<const std::byte> bytes,
                      std::string_view channel) {
  std::optional<Fault> fault = CheckFingerprint(type, bytes);
  Head head;
  if (!fault) {
    FieldReader reader(bytes.first(std::min(kArraysAt, bytes.size())), kFingerprintSize);
    Fields(reader, head);
    fault = reader.Finish();
  }
  if (!fault && bytes.size() != head.size()) {
    fault = Fault{FaultCode::kSize,
                  fmt::format("has {} bytes, its counts give {}", bytes.size(), head.size()),
                  {},
                  static_cast<std::int64_t>(std::min(bytes.size(), head.size()))};
  }
  if (fault) return Placed(*std::move(fault), type, channel);
  return head;
}

/// Moves on by so many samples.
void Advance(SampleStamp& stamp, std::int64_t samples) {
  const Duration passed{samples * stamp.period_ns};
  stamp.tool_time = stamp.tool_time + passed;
  stamp.utc = stamp.utc + passed;
  stamp.seq += samples;
}

/// Columns of an imu_batch_t, in the order of its arrays; null where there is none.
struct ImuColumns {
  static constexpr std::array<const char*, 9> kNames = {
      "gx_rps", "gy_rps", "gz_rps", "ax_mps2", "ay_mps2", "az_mps2", "mx_t", "my_t", "mz_t"};
  std::array<std::size_t, 9> at{};  ///< byte in the message; 0: none
};

ImuColumns ColumnsOf(const ImuHead& head) {
  const bool gz = head.n_gz > 0;
  const bool mag = head.n_mag > 0;
  const std::array<bool, 9> present = {true, true, gz, true, true, true, mag, mag, mag};
  ImuColumns columns;
  std::size_t at = kArraysAt;
  for (std::size_t i = 0; i < present.size(); ++i) {
    if (!present[i]) continue;
    columns.at[i] = at;
    at += static_cast<std::size_t>(head.n) * sizeof(double);
  }
  return columns;
}

Fault FirstNotFinite(const ImuHead& head, std::span<const std::byte> bytes) {
  const ImuColumns columns = ColumnsOf(head);
  for (std::size_t i = 0; i < columns.at.size(); ++i) {
    if (columns.at[i] == 0) continue;
    for (std::size_t k = 0; k < static_cast<std::size_t>(head.n); ++k) {
      const std::size_t at = columns.at[i] + k * sizeof(double);
      const auto value = Load<double>(bytes.data() + at);
      if (std::isfinite(value)) continue;
      return {FaultCode::kRange,
              fmt::format("{}[{}] = {} is out of range", ImuColumns::kNames[i], k, value),
              {},
              static_cast<std::int64_t>(at)};
    }
  }
  return {};
}

/// Reads the arrays; false when a value is not finite. One array after the other, as they stand.
bool ReadArrays(const ImuHead& head, std::span<const std::byte> bytes, ImuSample* out) {
  const ImuColumns columns = ColumnsOf(head);
  const auto n = static_cast<std::size_t>(head.n);
  const bool has_gz = head.n_gz > 0;
  const bool has_mag = head.n_mag > 0;
  for (std::size_t k = 0; k < n; ++k) {
    // Of a log in memory the arrays are on their way while stamps are written, and then the head of
    // the next message.
    __builtin_prefetch(bytes.data() + std::min(k * kCacheLine, bytes.size()));
    ImuSample& sample = out[k];
    sample.stamp = head.stamp;
    Advance(sample.stamp, static_cast<std::int64_t>(k));
    if (!has_gz) sample.w_IT_T.z() = 0;
    if (!has_mag) sample.b_T.setZero();
    sample.has_gz = has_gz;
    sample.has_mag = has_mag;
  }
  // The exponent of what is not finite is all ones: one more carries into the sign.
  constexpr std::uint64_t kExponent = 0x7ff0'0000'0000'0000, kOne = 0x0010'0000'0000'0000;
  std::uint64_t carried = 0;
  const auto read = [&](std::size_t first, Eigen::Vector3d ImuSample::*vector) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (columns.at[first + axis] == 0) continue;
      const std::byte* array = bytes.data() + columns.at[first + axis];
      for (std::size_t k = 0; k < n; ++k) {
        const auto bits = Load<std::uint64_t>(array + k * sizeof(double));
        (out[k].*vector)[static_cast<Eigen::Index>(axis)] = std::bit_cast<double>(bits);
        carried |= (bits & kExponent) + kOne;
      }
    }
  };
  read(0, &ImuSample::w_IT_T);
  read(3, &ImuSample::f_T);
  read(6, &ImuSample::b_T);
  return carried >> 63 == 0;
}

/// Leaves out of `samples` what is no number. Returns how many samples are left, and
/// says what was left out.
std::size_t LeaveOut(std::span<ImuSample> samples, std::string& text) {
  std::size_t left = 0, gz = 0, mag = 0;
  for (const ImuSample& from : samples) {
    if (!from.w_IT_T.head<2>().allFinite() || !from.f_T.allFinite()) continue;
    ImuSample& sample = samples[left++];
    sample = from;
    if (!std::isfinite(sample.w_IT_T.z())) {
      sample.w_IT_T.z() = 0;
      sample.has_gz = false;
      ++gz;
    }
    if (!sample.b_T.allFinite()) {
      sample.b_T.setZero();
      sample.has_mag = false;
      ++mag;
    }
  }
  text += fmt::format("; left out of {} samples: {} samples, {} third rates, {} fields",
                      samples.size(), samples.size() - left, gz, mag);
  return left;
}

void ReadCounts(const RawHead& head, std::span<const std::byte> bytes, RawSample* out) {
  const auto n = static_cast<std::size_t>(head.n);
  const auto channels = static_cast<std::size_t>(head.n_channels);
  const std::byte* counts = bytes.data() + kArraysAt;
  for (std::size_t k = 0; k < n; ++k) {
    RawSample& sample = out[k];
    sample = RawSample{};
    sample.stamp = head.stamp;
    Advance(sample.stamp, static_cast<std::int64_t>(k));
    sample.n_channels = head.n_channels;
    sample.n_temperatures = head.n_temperatures;
    for (std::size_t c = 0; c < channels; ++c) {
      sample.counts[c] = Load<std::int32_t>(counts + (c * n + k) * sizeof(std::int32_t));
    }
  }
}

/// The batch's temperatures, the same for every sample.
std::optional<Fault> ReadTemperatures(const RawHead& head, std::span<const std::byte> bytes,
                                      std::span<RawSample> samples) {
  std::size_t at = kArraysAt + static_cast<std::size_t>(head.n_values) * sizeof(std::int32_t);
  for (std::size_t i = 0; i < static_cast<std::size_t>(head.n_temperatures); ++i) {
    const auto value = Load<float>(bytes.data() + at);
    if (!std::isfinite(value)) {
      return Fault{FaultCode::kRange,
                   fmt::format("temperature_raw[{}] = {} is out of range", i, value),
                   {},
                   static_cast<std::int64_t>(at)};
    }
    for (RawSample& sample : samples) sample.temperature_raw[i] = value;
    at += sizeof(float);
  }
  return std::nullopt;
}

/// Throws unless the samples stand where the head's stamp puts them.
void RequireEven(const SampleStamp& expected, const SampleStamp& found, std::size_t k) {
  const auto require = [k](bool good, const char* field, std::int64_t value) {
    if (good) return;
    throw std::invalid_argument(fmt::format(
        "sample {} of a batch has {} = {}, which does not continue the batch", k, field, value));
  };
  require(found.seq == expected.seq, "seq", found.seq);
  require(found.tool_time == expected.tool_time, "tool_time", found.tool_time.ns);
  require(found.session == expected.session, "session", found.session);
  require(found.run == expected.run, "run", found.run);
  require(found.tool == expected.tool, "tool", found.tool);
  require(found.period_ns == expected.period_ns, "period_ns", found.period_ns);
}

/// The stamp of the first sample with the status bits of all.
template <class Sample>
SampleStamp CommonStamp(std::span<const Sample> batch) {
  if (batch.empty() || batch.size() > kBatchMax) {
    throw std::invalid_argument(
        fmt::format("a batch has 1 to {} samples, not {}", kBatchMax, batch.size()));
  }
  SampleStamp common = batch[0].stamp;
  SampleStamp expected = common;
  for (std::size_t k = 0; k < batch.size(); ++k, Advance(expected, 1)) {
    const SampleStamp& stamp = batch[k].stamp;
    RequireEven(expected, stamp, k);
    common.gyro_saturated |= stamp.gyro_saturated;
    common.accel_saturated |= stamp.accel_saturated;
    common.utc_unsynced |= stamp.utc_unsynced;
    common.simulated |= stamp.simulated;
  }
  return common;
}

void WriteHead(MessageType type, const auto& head, std::vector<std::byte>& bytes) {
  bytes.clear();
  bytes.resize(kFingerprintSize);
  Store(bytes.data(), Fingerprint(type));
  FieldWriter writer(bytes);
  Fields(writer, head);
  bytes.resize(head.size());
}

void RequireFinite(double value, const char* name, std::size_t k) {
  if (std::isfinite(value)) return;
  throw std::invalid_argument(fmt::format("{}[{}] = {} is out of range", name, k, value));
}

}  // namespace

Result<std::span<const ImuSample>> DecodeImuBatch(std::span<const std::byte> bytes,
                                                  std::vector<ImuSample>& buffer,
                                                  std::string_view channel,
                                                  std::optional<Fault>* damage) {
  const auto head = ReadHead<ImuHead>(MessageType::kImuBatch, bytes, channel);
  if (!head) return head.fault();
  auto n = static_cast<std::size_t>(head->n);
  if (buffer.size() < n) buffer.resize(n);
  if (damage != nullptr) damage->reset();
  if (!ReadArrays(*head, bytes, buffer.data())) {
    Fault fault = FirstNotFinite(*head, bytes);
    if (damage != nullptr) n = LeaveOut(std::span(buffer).first(n), fault.text);
    fault = Placed(std::move(fault), MessageType::kImuBatch, channel);
    if (damage == nullptr || n == 0) return fault;
    *damage = std::move(fault);
  }
  return std::span<const ImuSample>(buffer.data(), n);
}

Result<std::span<const RawSample>> DecodeRawBatch(std::span<const std::byte> bytes,
                                                  std::vector<RawSample>& buffer,
                                                  std::string_view channel) {
  const auto head = ReadHead<RawHead>(MessageType::kRawBatch, bytes, channel);
  if (!head) return head.fault();
  const auto n = static_cast<std::size_t>(head->n);
  if (buffer.size() < n) buffer.resize(n);
  ReadCounts(*head, bytes, buffer.data());
  if (auto fault = ReadTemperatures(*head, bytes, std::span(buffer).first(n))) {
    return Placed(*std::move(fault), MessageType::kRawBatch, channel);
  }
  return std::span<const RawSample>(buffer.data(), n);
}

void Encode(std::span<const ImuSample> batch, std::vector<std::byte>& bytes) {
  ImuHead head;
  head.stamp = CommonStamp(batch);
  head.n = static_cast<std::int32_t>(batch.size());
  head.n_gz = batch[0].has_gz ? head.n : 0;
  head.n_mag = batch[0].has_mag ? head.n : 0;
  WriteHead(MessageType::kImuBatch, head, bytes);
  const ImuColumns columns = ColumnsOf(head);
  for (std::size_t k = 0; k < batch.size(); ++k) {
    const ImuSample& s = batch[k];
    if (s.has_gz != batch[0].has_gz || s.has_mag != batch[0].has_mag) {
      throw std::invalid_argument(
          fmt::format("sample {} of a batch has other sensors than the first", k));
    }
    const std::array<double, 9> values = {s.w_IT_T[0], s.w_IT_T[1], s.w_IT_T[2], s.f_T[0], s.f_T[1],
                                          s.f_T[2],    s.b_T[0],    s.b_T[1],    s.b_T[2]};
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (columns.at[i] == 0) continue;
      RequireFinite(values[i], ImuColumns::kNames[i], k);
      Store(bytes.data() + columns.at[i] + k * sizeof(double), values[i]);
    }
  }
}

void Encode(std::span<const RawSample> batch, std::vector<std::byte>& bytes) {
  RawHead head;
  head.stamp = CommonStamp(batch);
  head.n = static_cast<std::int32_t>(batch.size());
  head.n_channels = batch[0].n_channels;
  head.n_temperatures = batch[0].n_temperatures;
  head.n_values = CountsIn(head.n, head.n_channels);
  WriteHead(MessageType::kRawBatch, head, bytes);
  const auto channels = static_cast<std::size_t>(head.n_channels);
  std::byte* counts = bytes.data() + kArraysAt;
  for (std::size_t k = 0; k < batch.size(); ++k) {
    if (batch[k].n_channels != head.n_channels) {
      throw std::invalid_argument(
          fmt::format("sample {} of a batch has {} channels, the first has {}", k,
                      batch[k].n_channels, head.n_channels));
    }
    for (std::size_t c = 0; c < channels; ++c) {
      Store(counts + (c * batch.size() + k) * sizeof(std::int32_t), batch[k].counts[c]);
    }
  }
  std::byte* temperatures = counts + channels * batch.size() * sizeof(std::int32_t);
  for (std::size_t i = 0; i < static_cast<std::size_t>(head.n_temperatures); ++i) {
    RequireFinite(batch[0].temperature_raw[i], "temperature_raw", i);
    Store(temperatures + i * sizeof(float), batch[0].temperature_raw[i]);
  }
}

}  // namespace wellgyro

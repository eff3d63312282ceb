#include <cstring>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "wellgyro/bus/decode.h"
#include "wellgyro/bus/encode.h"

#include "bus/generated_messages.h"

// Bytes from a network or a damaged log. Each message lies in an allocation of exactly its size, so
// that the sanitizers see the first byte read past it.
namespace wellgyro::test {
namespace {

using testing::HasSubstr;

class Hostile : public testing::TestWithParam<Sample> {};

std::string Named(const testing::TestParamInfo<Sample>& info) {
  return std::string(TypeName(info.param.type));
}

INSTANTIATE_TEST_SUITE_P(Type, Hostile, testing::ValuesIn(OneOfEach()), Named);

TEST_P(Hostile, EveryPrefixIsRefused) {
  const auto& [type, bytes] = GetParam();
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const Bytes prefix(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    const Result<Message> message = Decode(type, prefix, "X");
    ASSERT_FALSE(message) << size;
    EXPECT_EQ(message.fault().code, FaultCode::kSize) << size << ": " << message.fault().text;
    EXPECT_EQ(message.fault().source, "X");
    EXPECT_THAT(message.fault().text, HasSubstr(std::to_string(size)));
  }
}

TEST_P(Hostile, TrailingBytesAreRefused) {
  auto [type, bytes] = GetParam();
  const std::string right = std::to_string(bytes.size());
  for (int extra = 1; extra <= 16; ++extra) {
    bytes.push_back(std::byte{0});
    const Result<Message> message = Decode(type, bytes);
    ASSERT_FALSE(message);
    EXPECT_EQ(message.fault().code, FaultCode::kSize);
    EXPECT_THAT(message.fault().text, HasSubstr(std::to_string(bytes.size())));
  }
}

// What is accepted after a flip must be a message in its own right: it encodes to bytes that
// decode again.
TEST_P(Hostile, EveryFlippedBitIsRefusedOrAnotherGoodMessage) {
  const auto& [type, bytes] = GetParam();
  Bytes again;
  for (std::size_t i = 0; i < 8 * bytes.size(); ++i) {
    Bytes flipped = bytes;
    flipped[i / 8] ^= std::byte{1} << (i % 8);
    const Result<Message> message = Decode(type, flipped);
    if (i / 8 < 8) {
      ASSERT_FALSE(message);
      EXPECT_EQ(message.fault().code, FaultCode::kFingerprint);
    } else if (message) {
      ASSERT_NO_THROW(Encode(*message, again)) << "bit " << i;
      EXPECT_TRUE(Decode(type, again)) << "bit " << i;
    }
  }
}

TEST_P(Hostile, EveryWordOfAwkwardValues) {
  const auto& [type, bytes] = GetParam();
  const std::int32_t words[] = {-1, 0, 1, 1001, 1 << 29, (1 << 29) + 1, INT32_MAX, INT32_MIN};
  for (std::size_t at = 8; at + 4 <= bytes.size(); ++at) {
    for (const std::int32_t word : words) {
      Bytes changed = bytes;
      const auto big_endian = __builtin_bswap32(static_cast<std::uint32_t>(word));
      std::memcpy(changed.data() + at, &big_endian, sizeof big_endian);
      const Result<Message> message = Decode(type, changed);
      if (!message) {
        EXPECT_GE(message.fault().offset, 0);
        EXPECT_LE(message.fault().offset, static_cast<std::int64_t>(changed.size()));
      }
    }
  }
}

TEST_P(Hostile, EveryOtherTypeIsRefusedByNameAndFingerprint) {
  const auto& [type, bytes] = GetParam();
  for (const Sample& other : OneOfEach()) {
    if (other.type == type) continue;
    const Result<Message> message = Decode(type, other.bytes, "SOME_CHANNEL");
    ASSERT_FALSE(message);
    EXPECT_EQ(message.fault().code, FaultCode::kFingerprint);
    char expected[32];
    char found[32];
    std::snprintf(expected, sizeof expected, "0x%016llx",
                  static_cast<unsigned long long>(Fingerprint(type)));
    std::snprintf(found, sizeof found, "0x%016llx",
                  static_cast<unsigned long long>(Fingerprint(other.type)));
    EXPECT_THAT(message.fault().text, HasSubstr("SOME_CHANNEL"));
    EXPECT_THAT(message.fault().text, HasSubstr(expected));
    EXPECT_THAT(message.fault().text, HasSubstr(found));
    EXPECT_THAT(message.fault().text, HasSubstr(std::string(TypeName(other.type))));
  }
}

void ExpectRange(MessageType type, const Bytes& bytes, const std::string& field) {
  const Result<Message> message = Decode(type, bytes, "X");
  ASSERT_FALSE(message) << field;
  EXPECT_EQ(message.fault().code, FaultCode::kRange) << message.fault().text;
  EXPECT_THAT(message.fault().text, HasSubstr(field));
}

TEST(HostileBatch, Counts) {
  for (const std::int32_t n : {-1, 0, 1001, 0x20000001, INT32_MAX, INT32_MIN}) {
    imu_batch_t imu = GeneratedImu(3, false, false);
    Bytes bytes = BytesOf(imu);
    const auto word = __builtin_bswap32(static_cast<std::uint32_t>(n));
    std::memcpy(bytes.data() + 56, &word, 4);
    ExpectRange(MessageType::kImuBatch, bytes, "n = " + std::to_string(n));
    bytes = BytesOf(GeneratedRaw(3, 5, 2));
    std::memcpy(bytes.data() + 52, &word, 4);
    ExpectRange(MessageType::kRawBatch, bytes, "n = " + std::to_string(n));
  }
  for (const std::int32_t n : {-1, 1, 2, 4, INT32_MAX}) {
    const auto word = __builtin_bswap32(static_cast<std::uint32_t>(n));
    Bytes bytes = BytesOf(GeneratedImu(3, true, true));
    std::memcpy(bytes.data() + 60, &word, 4);
    ExpectRange(MessageType::kImuBatch, bytes, "n_gz = " + std::to_string(n));
    bytes = BytesOf(GeneratedImu(3, true, true));
    std::memcpy(bytes.data() + 64, &word, 4);
    ExpectRange(MessageType::kImuBatch, bytes, "n_mag = " + std::to_string(n));
    bytes = BytesOf(GeneratedRaw(3, 5, 2));
    std::memcpy(bytes.data() + 60, &word, 4);
    ExpectRange(MessageType::kRawBatch, bytes, "n_values = " + std::to_string(n));
  }
  ExpectRange(MessageType::kRawBatch, BytesOf(GeneratedRaw(3, 17, 0)), "n_channels = 17");
  ExpectRange(MessageType::kRawBatch, BytesOf(GeneratedRaw(3, 0, 0)), "n_channels = 0");
  ExpectRange(MessageType::kRawBatch, BytesOf(GeneratedRaw(3, 3, 9)), "n_temperatures = 9");
}

TEST(HostileBatch, PeriodTimesAndNumbers) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  const imu_batch_t good = GeneratedImu(3, true, true);
  const auto expect = [&good](const char* field, auto change) {
    imu_batch_t m = good;
    change(m);
    ExpectRange(MessageType::kImuBatch, BytesOf(m), field);
  };
  expect("period_ns = 0", [](imu_batch_t& m) { m.period_ns = 0; });
  expect("period_ns = -5", [](imu_batch_t& m) { m.period_ns = -5; });
  expect("tool_ns", [](imu_batch_t& m) { m.tool_ns = INT64_MAX; });
  expect("tool_ns", [](imu_batch_t& m) { m.tool_ns = INT64_MIN; });
  expect("utime_us", [](imu_batch_t& m) { m.utime_us = INT64_MAX / 1000; });
  expect("utime_us = -1", [](imu_batch_t& m) { m.utime_us = -1; });
  expect("seq = -1", [](imu_batch_t& m) { m.seq = -1; });
  expect("seq", [](imu_batch_t& m) { m.seq = INT64_MAX; });
  expect("run = -1", [](imu_batch_t& m) { m.run = -1; });
  expect("temperature_degc", [&](imu_batch_t& m) { m.temperature_degc = static_cast<float>(nan); });
  expect("gx_rps[0] = nan", [&](imu_batch_t& m) { m.gx_rps[0] = nan; });
  expect("gz_rps[2] = inf", [&](imu_batch_t& m) { m.gz_rps[2] = inf; });
  expect("az_mps2[1] = -inf", [&](imu_batch_t& m) { m.az_mps2[1] = -inf; });
  expect("mz_t[2] = nan", [&](imu_batch_t& m) { m.mz_t[2] = nan; });
  raw_batch_t raw = GeneratedRaw(3, 5, 2);
  raw.temperature_raw[1] = static_cast<float>(inf);
  ExpectRange(MessageType::kRawBatch, BytesOf(raw), "temperature_raw[1] = inf");
}

TEST(HostileBatch, ThePlaceOfABadNumberIsItsByte) {
  imu_batch_t m = GeneratedImu(3, false, false);
  m.gy_rps[1] = std::numeric_limits<double>::infinity();
  const Result<Message> message = Decode(MessageType::kImuBatch, BytesOf(m));
  ASSERT_FALSE(message);
  EXPECT_EQ(message.fault().offset, 68 + 3 * 8 + 8);
}

// 2026-11-21: one such number cost the batch of two seconds, a dead magnetometer the whole survey.
TEST(HostileBatch, WhatIsNoNumberCostsItsOwnSampleOnly) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const imu_batch_t good = GeneratedImu(5, true, true);
  std::vector<ImuSample> all, buffer;
  ASSERT_TRUE(DecodeImuBatch(BytesOf(good), all));
  const auto same = [](const ImuSample& a, const ImuSample& b) {
    return a.stamp.seq == b.stamp.seq && a.stamp.tool_time == b.stamp.tool_time && a.f_T == b.f_T &&
           a.w_IT_T.head<2>() == b.w_IT_T.head<2>();
  };
  imu_batch_t m = good;
  m.gy_rps[1] = nan;
  m.az_mps2[3] = -std::numeric_limits<double>::infinity();
  m.gz_rps[0] = nan;
  m.mz_t[4] = nan;
  std::optional<Fault> damage;
  const auto left = DecodeImuBatch(BytesOf(m), buffer, "HERE", &damage);
  ASSERT_TRUE(left);
  ASSERT_EQ(left->size(), 3U);
  for (const std::size_t i : {0, 1, 2}) EXPECT_TRUE(same((*left)[i], all[2 * i])) << i;
  EXPECT_FALSE((*left)[0].has_gz);
  EXPECT_EQ((*left)[0].w_IT_T.z(), 0);
  EXPECT_TRUE((*left)[0].has_mag && (*left)[1].has_gz && (*left)[1].has_mag && (*left)[2].has_gz);
  EXPECT_EQ((*left)[1].b_T, all[2].b_T);
  EXPECT_FALSE((*left)[2].has_mag);
  ASSERT_TRUE(damage);
  EXPECT_EQ(damage->code, FaultCode::kRange);
  EXPECT_THAT(damage->text, HasSubstr("gy_rps[1] = nan"));
  EXPECT_THAT(damage->text, HasSubstr("left out of 5 samples: 2 samples, 1 third rates, 1 fields"));
  EXPECT_TRUE(DecodeImuBatch(BytesOf(good), buffer, "HERE", &damage));
  EXPECT_FALSE(damage);
  for (double& f : m.ax_mps2) f = nan;
  EXPECT_FALSE(DecodeImuBatch(BytesOf(m), buffer, "HERE", &damage));
}

TEST(HostileMessage, ChoicesFlagsAndSigmas) {
  depth_t depth = GeneratedDepth();
  depth.source = 5;
  ExpectRange(MessageType::kDepth, BytesOf(depth), "source = 5");
  depth = GeneratedDepth();
  depth.sigma_m = -0.1;
  ExpectRange(MessageType::kDepth, BytesOf(depth), "sigma_m = -0.1");
  tool_mode_t mode = GeneratedMode();
  mode.has_imu_seq = 2;
  ExpectRange(MessageType::kToolMode, BytesOf(mode), "has_imu_seq = 2");
  event_t event = GeneratedEvent();
  event.event = 0;
  ExpectRange(MessageType::kEvent, BytesOf(event), "event = 0");
  survey_station_t station = GeneratedStation();
  station.cov_ned_m2[3] = -1e-9;
  ExpectRange(MessageType::kStation, BytesOf(station), "cov_ned_m2 = -1e-09");
  station = GeneratedStation();
  station.run_pass = -1;
  ExpectRange(MessageType::kStation, BytesOf(station), "run_pass = -1");
}

TEST(HostileMessage, AbsentFieldsAreNotLookedAt) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  depth_t depth = GeneratedDepth();
  depth.status = 0;
  depth.speed_mps = depth.tension_n = depth.sigma_m = nan;
  EXPECT_TRUE(Decode(MessageType::kDepth, BytesOf(depth)));
  still_window_t still = GeneratedStill();
  still.status = 0;
  still.w_rps[2] = still.sigma_w_rps[2] = still.m_t[0] = still.md_m = nan;
  const auto window = Decode(MessageType::kStillWindow, BytesOf(still));
  ASSERT_TRUE(window);
  EXPECT_EQ(std::get<StillWindow>(*window).w_IT_T[2], 0);
  EXPECT_FALSE(std::get<StillWindow>(*window).md);
  depth.status = 1 << 20;
  EXPECT_TRUE(Decode(MessageType::kDepth, BytesOf(depth))) << "a bit of a later version";
}

TEST(HostileMessage, StringsWithoutEndOrWithTwo) {
  const Bytes good = BytesOf(GeneratedStatus());
  Bytes bytes = good;
  bytes.back() = std::byte{'x'};
  ExpectRange(MessageType::kStatus, bytes, "NUL");
  bytes = good;
  bytes[bytes.size() - 3] = std::byte{0};
  ExpectRange(MessageType::kStatus, bytes, "NUL");
}

TEST(HostileCaller, EncodeThrowsForWhatDecodeWouldRefuse) {
  Bytes bytes;
  std::vector<ImuSample> samples(2);
  samples[0].stamp.period_ns = samples[1].stamp.period_ns = 10;
  samples[1].stamp.seq = 1;
  samples[1].stamp.tool_time.ns = 10;
  const auto thrown = [&bytes](std::span<const ImuSample> batch) -> std::string {
    try {
      Encode(batch, bytes);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return {};
  };
  EXPECT_EQ(thrown(samples), "");
  EXPECT_THAT(thrown({}), HasSubstr("1 to 1000 samples, not 0"));
  EXPECT_THAT(thrown(std::vector<ImuSample>(1001)), HasSubstr("1001"));
  EXPECT_THAT(thrown(std::vector<ImuSample>(1)), HasSubstr("period_ns = 0"));
  const auto with = [&](auto change) {
    auto changed = samples;
    change(changed[1]);
    return thrown(changed);
  };
  EXPECT_THAT(with([](ImuSample& s) { s.stamp.seq = 2; }), HasSubstr("seq = 2"));
  EXPECT_THAT(with([](ImuSample& s) { s.stamp.tool_time.ns = 11; }), HasSubstr("tool_time = 11"));
  EXPECT_THAT(with([](ImuSample& s) { s.stamp.run = 1; }), HasSubstr("run = 1"));
  EXPECT_THAT(with([](ImuSample& s) { s.has_mag = true; }), HasSubstr("other sensors"));
  EXPECT_THAT(with([](ImuSample& s) { s.f_T[1] = std::nan(""); }), HasSubstr("ay_mps2[1] = nan"));
  Event event;
  event.text = std::string("a\0b", 3);
  EXPECT_THROW(Encode(event, bytes), std::invalid_argument);
  DepthMark mark;
  mark.md = std::nan("");
  EXPECT_THROW(Encode(mark, bytes), std::invalid_argument);
}

}  // namespace
}  // namespace wellgyro::test

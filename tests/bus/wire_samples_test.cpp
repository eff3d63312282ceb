#include <gtest/gtest.h>

#include "wellgyro/bus/encode.h"

#include "bus/decoded.h"
#include "bus/generated_messages.h"

// Both directions against the classes that lcm-gen writes: our reader must give every field of
// what they wrote, and our writer the same bytes again.
namespace wellgyro::test {
namespace {

void ExpectStamp(const SampleStamp& stamp, const auto& m, int k) {
  EXPECT_EQ(stamp.tool_time.ns, m.tool_ns + std::int64_t{k} * m.period_ns);
  EXPECT_EQ(stamp.utc.ns, m.utime_us * 1000 + std::int64_t{k} * m.period_ns);
  EXPECT_EQ(stamp.seq, m.seq + k);
  EXPECT_EQ(stamp.session, m.session);
  EXPECT_EQ(stamp.run, m.run);
  EXPECT_EQ(stamp.tool, m.tool);
  EXPECT_EQ(stamp.period_ns, m.period_ns);
}

class ImuWire : public testing::TestWithParam<std::tuple<int, bool, bool>> {};

TEST_P(ImuWire, EveryFieldBothWays) {
  const auto [n, gz, mag] = GetParam();
  const imu_batch_t m = GeneratedImu(n, gz, mag);
  const auto samples = Decoded<ImuBatch>(MessageType::kImuBatch, BytesOf(m)).samples;
  ASSERT_EQ(samples.size(), static_cast<std::size_t>(n));
  for (int k = 0; k < n; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const ImuSample& s = samples[i];
    ExpectStamp(s.stamp, m, k);
    EXPECT_FALSE(s.stamp.gyro_saturated);
    EXPECT_TRUE(s.stamp.accel_saturated);
    EXPECT_EQ(s.stamp.temperature, m.temperature_degc);
    EXPECT_EQ(s.has_gz, gz);
    EXPECT_EQ(s.has_mag, mag);
    EXPECT_EQ(s.w_IT_T, Eigen::Vector3d(m.gx_rps[i], m.gy_rps[i], gz ? m.gz_rps[i] : 0));
    EXPECT_EQ(s.f_T, Eigen::Vector3d(m.ax_mps2[i], m.ay_mps2[i], m.az_mps2[i]));
    EXPECT_EQ(s.b_T, mag ? Eigen::Vector3d(m.mx_t[i], m.my_t[i], m.mz_t[i])
                         : Eigen::Vector3d(Eigen::Vector3d::Zero()));
  }
}

INSTANTIATE_TEST_SUITE_P(Layouts, ImuWire,
                         testing::Combine(testing::Values(1, 2, 32, 1000), testing::Bool(),
                                          testing::Bool()));

class RawWire : public testing::TestWithParam<std::tuple<int, int, int>> {};

TEST_P(RawWire, EveryFieldBothWays) {
  const auto [n, channels, temperatures] = GetParam();
  const raw_batch_t m = GeneratedRaw(n, channels, temperatures);
  const auto samples = Decoded<RawBatch>(MessageType::kRawBatch, BytesOf(m)).samples;
  ASSERT_EQ(samples.size(), static_cast<std::size_t>(n));
  for (int k = 0; k < n; ++k) {
    const RawSample& s = samples[static_cast<std::size_t>(k)];
    ExpectStamp(s.stamp, m, k);
    EXPECT_TRUE(s.stamp.gyro_saturated);
    EXPECT_FALSE(s.stamp.accel_saturated);
    EXPECT_EQ(s.n_channels, channels);
    EXPECT_EQ(s.n_temperatures, temperatures);
    for (int c = 0; c < channels; ++c) {
      EXPECT_EQ(s.counts.at(static_cast<std::size_t>(c)),
                m.counts[static_cast<std::size_t>(c * n + k)]);
    }
    for (std::size_t t = 0; t < m.temperature_raw.size(); ++t) {
      EXPECT_EQ(s.temperature_raw.at(t), m.temperature_raw[t]);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Layouts, RawWire,
                         testing::Combine(testing::Values(1, 7, 1000), testing::Values(1, 9, 16),
                                          testing::Values(0, 1, 8)));

TEST(Wire, EachStatusBitOfABatch) {
  const auto decoded = [](std::int32_t status) {
    imu_batch_t m = GeneratedImu(1, false, false);
    m.status = status;
    return Decoded<ImuBatch>(MessageType::kImuBatch, BytesOf(m)).samples.at(0).stamp;
  };
  EXPECT_TRUE(decoded(1).gyro_saturated);
  EXPECT_TRUE(decoded(2).accel_saturated);
  EXPECT_TRUE(decoded(4).utc_unsynced);
  EXPECT_TRUE(decoded(8).simulated);
  const SampleStamp none = decoded(0);
  EXPECT_FALSE(none.gyro_saturated || none.accel_saturated || none.utc_unsynced || none.simulated);
}

TEST(Wire, StillWindow) {
  const still_window_t m = GeneratedStill();
  const auto w = Decoded<StillWindow>(MessageType::kStillWindow, BytesOf(m));
  EXPECT_EQ(w.utc_begin.ns, m.utime_us * 1000);
  EXPECT_EQ(w.utc_end - w.utc_begin, Duration{m.duration_ns});
  EXPECT_EQ(w.seconds(), 90.0000005);
  EXPECT_EQ(w.seq_begin, m.seq);
  EXPECT_EQ(w.seq_end, m.seq);
  EXPECT_EQ(w.samples, 0);
  EXPECT_EQ(w.session, m.session);
  EXPECT_EQ(w.run, m.run);
  EXPECT_EQ(w.tool, m.tool);
  EXPECT_TRUE(w.has_gz && w.has_mag);
  EXPECT_EQ(w.index_position, m.index_position);
  EXPECT_EQ(w.w_IT_T, Eigen::Vector3d(m.w_rps));
  EXPECT_EQ(w.sigma_w_IT_T, Eigen::Vector3d(m.sigma_w_rps));
  EXPECT_EQ(w.f_T, Eigen::Vector3d(m.f_mps2));
  EXPECT_EQ(w.sigma_f_T, Eigen::Vector3d(m.sigma_f_mps2));
  EXPECT_EQ(w.b_T, Eigen::Vector3d(m.m_t));
  EXPECT_EQ(w.temperature, m.temperature_degc);
  EXPECT_EQ(w.md, m.md_m);
}

TEST(Wire, StillWindowThatRestsOnSamplesSendsTheToolsDuration) {
  StillWindow window;
  window.utc_begin.ns = 5'000'000'000;
  window.utc_end.ns = 6'000'000'000;
  window.begin.ns = -1;
  window.end.ns = 2'000'000'002;
  window.samples = 100;
  Bytes bytes;
  Encode(window, bytes);
  still_window_t m{};
  ASSERT_EQ(m.decode(bytes.data(), 0, static_cast<int>(bytes.size())),
            static_cast<int>(bytes.size()));
  EXPECT_EQ(m.duration_ns, 2'000'000'003);
  EXPECT_EQ(m.status, 0);
}

TEST(Wire, ABatchBufferIsAllocatedOnce) {
  std::vector<ImuSample> buffer;
  const Bytes large = BytesOf(GeneratedImu(100, true, false));
  const Bytes small = BytesOf(GeneratedImu(10, false, true));
  ASSERT_TRUE(DecodeImuBatch(large, buffer));
  const ImuSample* place = buffer.data();
  const auto few = DecodeImuBatch(small, buffer);
  ASSERT_TRUE(few);
  EXPECT_EQ(few->size(), 10U);
  EXPECT_EQ(few->data(), place);
  EXPECT_EQ((*few)[9].w_IT_T[2], 0) << "nothing remains of the batch before";
  EXPECT_FALSE((*few)[9].has_gz);
  const auto many = DecodeImuBatch(large, buffer);
  ASSERT_TRUE(many);
  EXPECT_EQ(many->data(), place);
  EXPECT_EQ((*many)[99].b_T, Eigen::Vector3d(0, 0, 0));
}

}  // namespace
}  // namespace wellgyro::test

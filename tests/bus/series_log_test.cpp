#include "wellgyro/bus/series_log.h"

#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "wellgyro/bus/encode.h"
#include "wellgyro/bus/log_writer.h"

#include "support/scratch.h"

namespace wellgyro {
namespace {

std::string PathOfLog() {
  static const support::Scratch folder;
  return (folder.path() / "log.lcm").string();
}

class Logger {
 public:
  Logger() : writer_(*LogWriter::Open(PathOfLog(), IfExists::kReplace)) {}

  template <class Sample>
  void Write(const std::string& channel, const std::vector<Sample>& batch) {
    std::vector<std::byte> bytes;
    Encode(std::span<const Sample>(batch), bytes);
    ASSERT_FALSE(writer_.Write(channel, bytes, 0));
  }
  void Junk(const std::string& channel, std::size_t size) {
    ASSERT_FALSE(writer_.Write(channel, std::vector<std::byte>(size), 0));
  }
  void Close() { ASSERT_FALSE(writer_.Close()); }

 private:
  LogWriter writer_;
};

SampleStamp Stamp(std::int64_t seq, std::int32_t session) {
  SampleStamp stamp;
  stamp.seq = seq;
  stamp.session = session;
  stamp.period_ns = 10'000'000;
  stamp.tool_time = ToolTime{seq * 10'000'000};
  stamp.utc = UtcTime{1'700'000'000'000'000'000 + seq * 10'000'000};
  stamp.temperature = 25;
  return stamp;
}

// gx = seq, gy = -seq, az = seq/2.
std::vector<ImuSample> Imu(std::int64_t begin, std::int64_t end, std::int32_t session = 1) {
  std::vector<ImuSample> batch;
  for (std::int64_t seq = begin; seq < end; ++seq) {
    ImuSample sample;
    sample.stamp = Stamp(seq, session);
    const auto value = static_cast<double>(seq);
    sample.w_IT_T << value, -value, 0;
    sample.f_T << 0, 0, value / 2;
    batch.push_back(sample);
  }
  return batch;
}

TEST(SeriesLog, LaysSamplesInTheirPlaces) {
  Logger logger;
  logger.Write("WELLGYRO_IMU", Imu(100, 110));
  logger.Write("WELLGYRO_IMU", Imu(105, 115));  // overlaps
  logger.Write("WELLGYRO_IMU", Imu(120, 130));  // 115 to 119 are lost
  logger.Junk("WELLGYRO_OTHER", 20);
  logger.Close();
  const auto gy = ReadLcmSeries(PathOfLog(), {.name = "gy"});
  ASSERT_TRUE(gy) << gy.fault().text;
  ASSERT_EQ(gy->values.size(), 30u);
  for (std::size_t i = 0; i < 30; ++i) {
    if (i >= 15 && i < 20) continue;
    EXPECT_EQ(gy->values[i], -100 - static_cast<double>(i));
  }
  ASSERT_EQ(gy->gaps.size(), 1u);
  EXPECT_EQ(gy->gaps[0].begin, 15);
  EXPECT_EQ(gy->gaps[0].end, 20);
  EXPECT_DOUBLE_EQ(gy->period, 0.01);
  EXPECT_EQ(gy->unit, "rad_per_s");
  EXPECT_EQ(gy->temperature.size(), 30u);
  EXPECT_FALSE(gy->damaged);
  const auto az = ReadLcmSeries(PathOfLog(), {.name = "az"});
  ASSERT_TRUE(az);
  EXPECT_EQ(az->unit, "mps2");
  EXPECT_EQ(az->values[3], 51.5);
}

TEST(SeriesLog, TakesTheLongestStretchOfASourceThatRestarted) {
  Logger logger;
  logger.Write("WELLGYRO_IMU", Imu(0, 10, 1));
  logger.Write("WELLGYRO_IMU", Imu(50, 90, 2));
  logger.Write("WELLGYRO_IMU", Imu(0, 20, 3));
  logger.Close();
  const auto gx = ReadLcmSeries(PathOfLog(), {.name = "gx"});
  ASSERT_TRUE(gx);
  ASSERT_EQ(gx->values.size(), 40u);
  EXPECT_EQ(gx->values[0], 50);
  EXPECT_THAT(
      testing::PrintToString(gx->notes),
      testing::HasSubstr("longest of 3 stretches is taken, session 2 from sample number 50"));
}

TEST(SeriesLog, ReadsRawChannelsAndSaturation) {
  std::vector<RawSample> batch(5);
  for (std::size_t i = 0; i < batch.size(); ++i) {
    batch[i].stamp = Stamp(static_cast<std::int64_t>(i), 1);
    batch[i].stamp.gyro_saturated = true;  // a bit of the whole batch
    batch[i].n_channels = 3;
    batch[i].counts = {1, 2, 30 + static_cast<std::int32_t>(i)};
  }
  Logger logger;
  logger.Write("WELLGYRO_RAW", batch);
  logger.Close();
  const auto raw = ReadLcmSeries(PathOfLog(), {.name = "2"});
  ASSERT_TRUE(raw);
  EXPECT_EQ(raw->values, (std::vector<double>{30, 31, 32, 33, 34}));
  EXPECT_EQ(raw->unit, "counts");
  ASSERT_EQ(raw->saturated.size(), 1u);
  EXPECT_EQ(raw->saturated[0].end, 5);
  EXPECT_EQ(ReadLcmSeries(PathOfLog(), {.name = "3"}).fault().code, FaultCode::kForeign);
  EXPECT_EQ(ReadLcmSeries(PathOfLog(), {.name = "gx"}).fault().code, FaultCode::kForeign);
  EXPECT_EQ(ReadLcmSeries(PathOfLog(), {.name = "99"}).fault().code, FaultCode::kRange);
  EXPECT_EQ(ReadLcmSeries(PathOfLog(), {.name = "mx"}).fault().code, FaultCode::kRange);
  EXPECT_FALSE(ReadLcmSeries("/no/such/log", {.name = "gx"}));
}

TEST(SeriesLog, KeepsToOneBusChannelAndOneTool) {
  auto other = Imu(0, 5);
  for (auto& sample : other) sample.stamp.tool = 7;
  Logger logger;
  logger.Write("A", Imu(0, 10));
  logger.Write("B", Imu(0, 20));
  logger.Write("A", other);
  logger.Close();
  const auto first = ReadLcmSeries(PathOfLog(), {.name = "gx"});
  ASSERT_TRUE(first);
  EXPECT_EQ(first->values.size(), 10u);
  EXPECT_EQ(first->notes.size(), 1u);
  const auto b = ReadLcmSeries(PathOfLog(), {.name = "gx", .bus_channel = "B"});
  ASSERT_TRUE(b);
  EXPECT_EQ(b->values.size(), 20u);
  const auto seventh = ReadLcmSeries(PathOfLog(), {.name = "gx", .bus_channel = "A", .tool = 7});
  ASSERT_TRUE(seventh);
  EXPECT_EQ(seventh->values.size(), 5u);
}

TEST(SeriesLog, ALogWithAHoleIsReadAndSaysSo) {
  Logger logger;
  for (int i = 0; i < 50; ++i) logger.Write("WELLGYRO_IMU", Imu(i * 10, i * 10 + 10));
  logger.Close();
  std::filesystem::resize_file(PathOfLog(), std::filesystem::file_size(PathOfLog()) - 100);
  const auto gx = ReadLcmSeries(PathOfLog(), {.name = "gx"});
  ASSERT_TRUE(gx);
  EXPECT_EQ(gx->values.size(), 490u);
  EXPECT_TRUE(gx->damaged);
  EXPECT_EQ(gx->notes.size(), 1u);
}

}  // namespace
}  // namespace wellgyro

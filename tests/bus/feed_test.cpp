#include "wellgyro/bus/feed.h"

#include <limits>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "wellgyro/bus/glance_channel.h"

#include "bus/generated_messages.h"

namespace wellgyro::test {
namespace {

struct Heard : Listener {
  void OnRaw(std::span<const RawSample> b) override { Note("raw", b.size()); }
  void OnImu(std::span<const ImuSample> b) override { Note("imu", b.size()); }
  void OnStill(const StillWindow&) override { Note("still"); }
  void OnDepth(const DepthMark&) override { Note("depth"); }
  void OnMode(const ToolMode&) override { Note("mode"); }
  void OnTool(const ToolInfo&) override { Note("tool"); }
  void OnEvent(const wellgyro::Event&) override { Note("event"); }
  void OnCommand(const Command&) override { Note("command"); }
  void OnStation(const SentStation&) override { Note("station"); }
  void OnStatus(const Status&) override { Note("status"); }
  void OnFault(const Fault& fault) override { faults.push_back(fault); }

  void Note(const char* what, std::size_t n = 1) { calls.push_back({what, n}); }
  std::vector<std::pair<std::string, std::size_t>> calls;
  std::vector<Fault> faults;
};

TEST(Feed, EveryTypeReachesItsListener) {
  const Channels channels;
  Heard heard;
  std::vector<MessageType> accepted;
  const auto place = [&channels](MessageType type) {
    if (type == MessageType::kAdvice) return AdviceChannel(channels);
    return type == MessageType::kGlance ? GlanceChannel(channels) : NameOf(channels, type);
  };
  Feed feed(channels, heard,
            [&](MessageType type, std::string_view channel, std::span<const std::byte> bytes) {
              EXPECT_EQ(channel, place(type));
              EXPECT_EQ(TypeOf(bytes), type);
              accepted.push_back(type);
            });
  for (const Sample& sample : OneOfEach()) feed.Take(place(sample.type), sample.bytes);
  const std::vector<std::pair<std::string, std::size_t>> expected = {
      {"raw", 3},  {"imu", 3},   {"still", 1},   {"depth", 1},   {"mode", 1},
      {"tool", 1}, {"event", 1}, {"command", 1}, {"station", 1}, {"status", 1}};
  EXPECT_EQ(heard.calls, expected);
  EXPECT_EQ(accepted.size(), 14U);
  EXPECT_TRUE(heard.faults.empty());
  for (const Sample& sample : OneOfEach()) {
    EXPECT_EQ(feed.count(sample.type).messages, 1);
    EXPECT_EQ(feed.count(sample.type).bytes, static_cast<std::int64_t>(sample.bytes.size()));
  }
}

TEST(Feed, ABatchIsHeardLessWhatIsNoNumber) {
  Heard heard;
  int accepted = 0;
  Feed feed({}, heard, [&](auto&&...) { ++accepted; });
  imu_batch_t m = GeneratedImu(3, true, true);
  m.ay_mps2[0] = m.mx_t[2] = std::numeric_limits<double>::quiet_NaN();
  feed.Take(NameOf({}, MessageType::kImuBatch), BytesOf(m), 1000);
  EXPECT_EQ(heard.calls, (std::vector<std::pair<std::string, std::size_t>>{{"imu", 2}}));
  EXPECT_EQ(accepted, 1);
  EXPECT_EQ(feed.count(MessageType::kImuBatch).messages, 1);
  EXPECT_EQ(feed.malformed(), 1);
  ASSERT_EQ(heard.faults.size(), 1U);
  EXPECT_GT(heard.faults[0].offset, 1000);
}

TEST(Feed, RepeatedFaultsAreHeardTenTimesPerChannelAndCode) {
  Heard heard;
  int accepted = 0;
  Feed feed({}, heard, [&](auto&&...) { ++accepted; });
  const Bytes depth = BytesOf(GeneratedDepth());
  const Bytes shorter(depth.begin(), depth.end() - 1);
  for (int i = 0; i < 100; ++i) {
    feed.Take("WELLGYRO_IMU", depth);
    feed.Take("WELLGYRO_DEPTH", shorter);
    feed.Take("WELLGYRO_DEPTH", BytesOf(GeneratedMode()));
  }
  feed.Take("WELLGYRO_DEPTH", depth);
  EXPECT_EQ(heard.faults.size(), 3U * Feed::kFaultsHeard);
  EXPECT_THAT(heard.faults.back().text, testing::HasSubstr("further ones are counted only"));
  EXPECT_EQ(feed.count(MessageType::kImuBatch).malformed, 100);
  EXPECT_EQ(feed.count(MessageType::kDepth).malformed, 200);
  EXPECT_EQ(feed.malformed(), 300);
  EXPECT_EQ(feed.count(MessageType::kDepth).messages, 1);
  EXPECT_EQ(accepted, 1);
}

TEST(Feed, AFaultNamesItsPlaceInTheLog) {
  Heard heard;
  Feed feed({}, heard);
  depth_t depth = GeneratedDepth();
  depth.source = 99;
  feed.Take("WELLGYRO_DEPTH", BytesOf(depth), 10'000);
  ASSERT_EQ(heard.faults.size(), 1U);
  EXPECT_EQ(heard.faults[0].source, "WELLGYRO_DEPTH");
  EXPECT_EQ(heard.faults[0].offset, 10'000 + 8 + 8 + 8 + 4 + 4 + 4);
}

TEST(Feed, RenamedChannelsAndForeignOnes) {
  Channels channels;
  channels.depth = "RIG7_DEPTH";
  Heard heard;
  Feed feed(channels, heard);
  feed.Take("RIG7_DEPTH", BytesOf(GeneratedDepth()));
  feed.Take("WELLGYRO_DEPTH", BytesOf(GeneratedDepth()));
  feed.Take("CAMERA", Bytes(100));
  feed.Take("CAMERA", Bytes(3));
  EXPECT_EQ(heard.calls.size(), 1U);
  EXPECT_TRUE(heard.faults.empty());
  ASSERT_EQ(feed.foreign().size(), 2U);
  EXPECT_EQ(feed.foreign().at("WELLGYRO_DEPTH").type, MessageType::kDepth) << "worth a hint";
  EXPECT_EQ(feed.foreign().at("CAMERA").messages, 2);
  EXPECT_FALSE(feed.foreign().at("CAMERA").type);
}

TEST(Feed, ForeignChannelsWithoutEndTakeNoMemoryWithoutEnd) {
  Heard heard;
  Feed feed({}, heard);
  for (int i = 0; i < 1000; ++i) feed.Take("CHANNEL_" + std::to_string(i), {});
  EXPECT_EQ(feed.foreign().size(), Feed::kForeignChannelsMax + 1);
  EXPECT_EQ(feed.foreign().at("").messages,
            1000 - static_cast<std::int64_t>(Feed::kForeignChannelsMax));
}

TEST(Feed, ChannelsThatMakeNoSenseAreTheCallersMistake) {
  Heard heard;
  Channels channels;
  channels.imu = channels.raw;
  EXPECT_THROW(Feed(channels, heard), std::invalid_argument);
}

}  // namespace
}  // namespace wellgyro::test

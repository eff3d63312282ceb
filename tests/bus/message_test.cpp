#include "wellgyro/bus/message.h"

#include <set>
#include <stdexcept>

#include <gtest/gtest.h>

#include "wellgyro/bus/glance_channel.h"

#include "bus/generated_messages.h"

namespace wellgyro::test {
namespace {

TEST(Message, FingerprintsAreThoseOfTheContract) {
  // As written by lcm-gen 1.3.1 and 1.5.3 alike. A released type is frozen: a figure that changes
  // here makes every log of before unreadable.
  EXPECT_EQ(Fingerprint(MessageType::kRawBatch), 0x7cd690041baefb2aU);
  EXPECT_EQ(Fingerprint(MessageType::kImuBatch), 0xe7bb29ce14d15958U);
  EXPECT_EQ(Fingerprint(MessageType::kStillWindow), 0x4d61b7cfd54b9e03U);
  EXPECT_EQ(Fingerprint(MessageType::kDepth), 0xc95c7cdb7960a3d7U);
  EXPECT_EQ(Fingerprint(MessageType::kToolMode), 0x84aaa557fe5c33f1U);
  EXPECT_EQ(Fingerprint(MessageType::kToolInfo), 0x2a5b7b475c0fe89cU);
  EXPECT_EQ(Fingerprint(MessageType::kEvent), 0x4944db30af6186ebU);
  EXPECT_EQ(Fingerprint(MessageType::kCommand), 0xf6f180edef9120b9U);
  EXPECT_EQ(Fingerprint(MessageType::kStation), 0x1efcdc84420fbed3U);
  EXPECT_EQ(Fingerprint(MessageType::kStatus), 0x31cb6cddd9398a5aU);
  EXPECT_EQ(Fingerprint(MessageType::kOperation), 0x9922a77d1561fc57U);
  EXPECT_EQ(Fingerprint(MessageType::kGlance), 0xfb949bef0282ff62U);
  EXPECT_EQ(Fingerprint(MessageType::kRequest), 0x5c9579a393f3035dU);
  EXPECT_EQ(Fingerprint(MessageType::kAdvice), 0xa1e2e346d3bab0a3U);
}

TEST(Message, EveryTypeHasItsOwnFingerprintAndName) {
  std::set<std::uint64_t> fingerprints;
  for (const Sample& sample : OneOfEach()) {
    EXPECT_EQ(TypeOf(sample.bytes), sample.type);
    fingerprints.insert(Fingerprint(sample.type));
  }
  EXPECT_EQ(fingerprints.size(), std::size_t{kMessageTypes});
  EXPECT_EQ(TypeName(MessageType::kImuBatch), "imu_batch_t");
  EXPECT_EQ(TypeOf(Bytes(7)), std::nullopt);
  EXPECT_EQ(TypeOf(Bytes(8)), std::nullopt);
}

TEST(Message, ChannelsHaveTheirTypes) {
  const Channels channels;
  for (const Sample& sample : OneOfEach()) {
    const std::string name = sample.type == MessageType::kGlance   ? GlanceChannel(channels)
                             : sample.type == MessageType::kAdvice ? AdviceChannel(channels)
                                                                   : NameOf(channels, sample.type);
    EXPECT_EQ(TypeOn(channels, name, sample.bytes), sample.type);
  }
  EXPECT_EQ(TypeOn(channels, NameOf(channels, MessageType::kOperation)), MessageType::kCommand);
  EXPECT_EQ(TypeOn(channels, "WELLGYRO_IMU", BytesOf(GeneratedGlance())), MessageType::kImuBatch);
  EXPECT_EQ(NameOf(channels, MessageType::kCommand), "WELLGYRO_CMD");
  EXPECT_EQ(TypeOn(channels, "WELLGYRO"), std::nullopt);
  EXPECT_EQ(TypeOn(channels, ""), std::nullopt);
}

TEST(Message, ChannelNamesAreChecked) {
  Channels channels;
  EXPECT_NO_THROW(Validate(channels));
  channels.depth = std::string(63, 'D');
  EXPECT_NO_THROW(Validate(channels));
  for (const std::string& bad :
       {std::string(64, 'D'), std::string(), std::string("A\nB"), std::string("WELLGYRO_IMU")}) {
    channels.depth = bad;
    EXPECT_THROW(Validate(channels), std::invalid_argument) << bad;
  }
}

}  // namespace
}  // namespace wellgyro::test

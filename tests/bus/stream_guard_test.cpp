#include "wellgyro/bus/stream_guard.h"

#include <cstdint>
#include <map>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/bus/decode.h"
#include "wellgyro/bus/encode.h"

namespace wellgyro {
namespace {

constexpr std::uint64_t kTool = 0x0a000001'9c40;   // 10.0.0.1:40000
constexpr std::uint64_t kAgain = 0x0a000001'9c41;  // the same machine, another program
constexpr std::uint64_t kOther = 0x0a000002'0400;  // another machine
constexpr int kBatch = 10;
constexpr std::int64_t kBatchUs = 100'000;

/// What a guard hands on: of samples the first number of each batch, of depths the metres.
class Streams : public ::testing::Test {
 protected:
  std::vector<std::byte> Samples(std::int64_t n, std::int32_t session = 1, std::int32_t tool = 0) {
    std::vector<ImuSample> batch(kBatch);
    for (int k = 0; k < kBatch; ++k) {
      SampleStamp& stamp = batch[static_cast<std::size_t>(k)].stamp;
      stamp.seq = n * kBatch + k;
      stamp.session = session;
      stamp.tool = tool;
      stamp.period_ns = 10'000'000;
      stamp.tool_time.ns = stamp.seq * stamp.period_ns;
      stamp.utc.ns = 1'700'000'000'000'000'000 + stamp.tool_time.ns;
    }
    std::vector<std::byte> bytes;
    Encode(std::span<const ImuSample>(batch), bytes);
    return bytes;
  }
  std::vector<std::byte> Depth(std::int64_t n) {
    DepthMark mark;
    mark.utc.ns = 1'700'000'000'000'000'000 + n * 1'000'000'000;
    mark.md = static_cast<double>(n);
    mark.seq = n;
    std::vector<std::byte> bytes;
    Encode(mark, bytes);
    return bytes;
  }
  /// Sent with the next number, or with `number`.
  void Send(std::uint64_t sender, const std::string& channel, const std::vector<std::byte>& bytes,
            std::int64_t number = -1) {
    const auto next = number < 0 ? numbers_[sender]++ : static_cast<std::uint32_t>(number);
    guard_.Take({channel, bytes, now_us_, {sender, next}});
  }
  void SendSamples(std::uint64_t sender, std::int64_t n, std::int32_t session = 1) {
    Send(sender, "WELLGYRO_IMU", Samples(n, session));
  }
  /// Batches [from, to), in their own time.
  void Speak(std::uint64_t sender, std::int64_t from, std::int64_t to, std::int32_t session = 1) {
    for (std::int64_t n = from; n < to; ++n) {
      now_us_ += kBatchUs;
      SendSamples(sender, n, session);
    }
  }
  static std::vector<std::int64_t> Range(std::int64_t from, std::int64_t to) {
    std::vector<std::int64_t> range;
    for (std::int64_t n = from; n < to; ++n) range.push_back(n);
    return range;
  }

  std::vector<std::int64_t> used_;
  std::vector<std::uint64_t> by_;
  int unreadable_ = 0;
  std::vector<double> depths_;
  std::vector<std::string> told_;
  std::int64_t now_us_ = 1'700'000'000'000'000;
  std::map<std::uint64_t, std::uint32_t> numbers_ = {{kTool, 100}, {kAgain, 7}, {kOther, 0}};
  StreamGuard guard_{Channels{},
                     [this](const StreamGuard::Message& m) {
                       if (m.channel == "WELLGYRO_DEPTH") {
                         const auto mark = Decode(MessageType::kDepth, m.bytes);
                         depths_.push_back(std::get<DepthMark>(*mark).md);
                         return;
                       }
                       std::vector<ImuSample> samples;
                       const auto batch = DecodeImuBatch(m.bytes, samples);
                       if (!batch) {
                         ++unreadable_;
                         return;
                       }
                       used_.push_back(batch->front().stamp.seq / kBatch);
                       by_.push_back(m.by.sender);
                     },
                     [this](const std::string& sentence) { told_.push_back(sentence); }};
};

TEST_F(Streams, OfOneSenderLoseNothingAndWaitForTheFourthBatchAlone) {
  Speak(kTool, 0, 3);
  EXPECT_TRUE(used_.empty());
  Speak(kTool, 3, 20);
  EXPECT_EQ(used_, Range(0, 20));
  EXPECT_TRUE(told_.empty());
  EXPECT_EQ(guard_.left_out(), 0);
  EXPECT_EQ(guard_.held_bytes(), 0u);
}

TEST_F(Streams, WithoutASenderPassAsTheyAre) {
  for (const std::int64_t n : {5, 3, 4}) SendSamples(0, n);
  EXPECT_EQ(used_, (std::vector<std::int64_t>{5, 3, 4}));
}

TEST_F(Streams, ShorterThanFourBatchesAreUsedAtTheEnd) {
  Speak(kTool, 0, 3);
  guard_.Flush();
  EXPECT_EQ(used_, Range(0, 3));
}

TEST_F(Streams, AreTheToolsThoughCopiesWereThereBeforeAndGoOn) {
  std::mt19937_64 chance(4);
  std::vector<std::vector<std::byte>> sent;
  for (std::int64_t n = 0; n < 300; ++n) {
    for (int copies = 0; copies < 20 && !sent.empty(); ++copies) {
      auto copy = sent[chance() % sent.size()];
      copy[8 + chance() % (copy.size() - 8)] ^= static_cast<std::byte>(1U << chance() % 8);
      Send(kOther + chance() % 5, "WELLGYRO_IMU", copy);
      // And as if by the tool, with a number that it gave.
      Send(kTool, "WELLGYRO_IMU", copy, 100 + static_cast<std::int64_t>(chance() % sent.size()));
    }
    Speak(kTool, n, n + 1);
    sent.push_back(Samples(n));
  }
  EXPECT_EQ(used_, Range(0, 300));
  EXPECT_EQ(by_, std::vector<std::uint64_t>(300, kTool));
  ASSERT_FALSE(told_.empty());
  EXPECT_LE(told_.size(), 3u);
}

TEST_F(Streams, OfAnotherToolAreNotTouched) {
  Speak(kTool, 0, 10);
  for (std::int64_t n = 0; n < 10; ++n) Send(kOther, "WELLGYRO_IMU", Samples(n, 2, 1));
  EXPECT_EQ(used_.size(), 20u);
  EXPECT_TRUE(told_.empty());
}

TEST_F(Streams, AreTakenOverWithNothingLostWhereTheToolsProgramIsStartedAgain) {
  Speak(kTool, 0, 50);
  now_us_ += 300'000;
  // Another port, its numbers from 0, the tool's numbers going on or a new session.
  Speak(kAgain, 53, 90);
  std::vector<std::int64_t> all = Range(0, 50);
  const std::vector<std::int64_t> rest = Range(53, 90);
  all.insert(all.end(), rest.begin(), rest.end());
  EXPECT_EQ(used_, all);
  now_us_ += 300'000;
  Speak(kTool, 0, 40, 2);
  EXPECT_EQ(used_.size(), all.size() + 40);
  ASSERT_EQ(told_.size(), 4u);
  EXPECT_NE(told_[1].find("10.0.0.1:40001 from now on"), std::string::npos) << told_[1];
}

TEST_F(Streams, AnotherMachineTakesOverAfterFiveTimesThatSilence) {
  Speak(kTool, 0, 50);
  Speak(kOther, 50, 50 + 90);
  EXPECT_EQ(used_.size(), 50u);
  Speak(kOther, 140, 160);
  EXPECT_EQ(used_, Range(0, 160));
}

TEST_F(Streams, ComeBackToTheToolFromOneWhoBrokeInWhileItWasSilent) {
  Speak(kTool, 0, 50);
  now_us_ += 60'000'000;
  Speak(kOther, 1000, 1006, 9);
  EXPECT_EQ(used_.size(), 56u) << "nobody says otherwise";
  std::mt19937_64 chance(4);
  for (int i = 0; i < 40; ++i) SendSamples(kOther, static_cast<std::int64_t>(chance() % 50), 9);
  used_.clear();
  Speak(kTool, 650, 700);
  EXPECT_EQ(used_, Range(650, 700));
}

TEST_F(Streams, OfASenderThatStartsAgainOnItsOwnPortGoOn) {
  Speak(kTool, 0, 50);
  numbers_[kTool] = 0x80000000;
  Speak(kTool, 0, 60, 2);
  EXPECT_EQ(used_.size(), 110u);
}

TEST_F(Streams, OfASenderThatCountsNothingAreUsed) {
  for (std::int64_t n = 0; n < 50; ++n) Send(kTool, "WELLGYRO_IMU", Samples(n), 0);
  EXPECT_EQ(used_, Range(0, 50));
}

TEST_F(Streams, ThatTheNetworkDoublesAreUsedOnce) {
  for (std::int64_t n = 0; n < 50; ++n) {
    Send(kTool, "WELLGYRO_IMU", Samples(n), 100 + n);
    Send(kTool, "WELLGYRO_IMU", Samples(n), 100 + n);
  }
  EXPECT_EQ(used_, Range(0, 50));
}

TEST_F(Streams, WithHolesInEveryPlaceAreUsedAllTheSame) {
  for (std::int64_t n = 0; n < 100; ++n) SendSamples(kTool, 2 * n);
  EXPECT_EQ(used_.size(), 100u);
}

TEST_F(Streams, OfDepthsAreTheFirstsThatIsInOrder) {
  Send(kOther, "WELLGYRO_DEPTH", Depth(1'000'000));
  for (std::int64_t n = 0; n < 20; ++n) {
    Send(kTool, "WELLGYRO_DEPTH", Depth(n));
    Send(kOther, "WELLGYRO_DEPTH", Depth(n / 2));
  }
  ASSERT_EQ(depths_.size(), 20u);
  for (int n = 0; n < 20; ++n) EXPECT_EQ(depths_[static_cast<std::size_t>(n)], n);
}

TEST_F(Streams, OfRareDepthsWaitTwoSeconds) {
  for (std::int64_t n = 0; n < 3; ++n) {
    Send(kTool, "WELLGYRO_DEPTH", Depth(10 * n));
    EXPECT_EQ(depths_.size(), n == 0 ? 0u : static_cast<std::size_t>(n + 1));
    now_us_ += 10'000'000;
  }
}

TEST_F(Streams, ThatAreInventedTakeNoMemoryAndChangeNothing) {
  std::mt19937_64 chance(4);
  Speak(kTool, 0, 10);
  for (int i = 0; i < 20'000; ++i) {
    const auto tool = static_cast<std::int32_t>(chance() % 1'000'000);
    // Of one stream the senders are no fewer.
    Send(kOther + static_cast<std::uint64_t>(i), "WELLGYRO_IMU", Samples(0));
    Send(kOther + chance() % 1000, "WELLGYRO_IMU",
         Samples(static_cast<std::int64_t>(chance() % 1'000'000), 3, tool));
    if (i % 100 == 0) Speak(kTool, 10 + i / 100, 11 + i / 100);
  }
  EXPECT_EQ(used_, Range(0, 210));
  EXPECT_LE(guard_.held_bytes(), StreamGuard::kHeldMax);
}

TEST_F(Streams, OfOthersAreNotReadEvenWhereTheyCannotBe) {
  Speak(kTool, 0, 10);
  Send(kOther, "WELLGYRO_IMU", std::vector<std::byte>(100));
  EXPECT_EQ(unreadable_, 0);
  Send(kTool, "WELLGYRO_IMU", std::vector<std::byte>(100));
  EXPECT_EQ(unreadable_, 1) << "what the tool itself sends wrong is told by who reads it";
}

}  // namespace
}  // namespace wellgyro

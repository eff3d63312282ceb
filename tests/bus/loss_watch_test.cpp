#include "wellgyro/bus/loss_watch.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace wellgyro {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class LossWatchTest : public testing::Test {
 protected:
  void Hear(std::int64_t seq, std::size_t n = 10, std::int32_t session = 1, std::int32_t tool = 0) {
    std::vector<ImuSample> batch(n);
    for (std::size_t i = 0; i < n; ++i) {
      batch[i].stamp.seq = seq + static_cast<std::int64_t>(i);
      batch[i].stamp.session = session;
      batch[i].stamp.tool = tool;
    }
    watch_.OnImu(batch);
  }

  std::vector<std::string> said_;
  LossWatch watch_{[this](const Fault& fault) { said_.push_back(fault.text); }};
};

TEST_F(LossWatchTest, AStreamMayBeginAnywhereAndOverlap) {
  for (int seq = 500; seq < 1000; seq += 5) Hear(seq);
  watch_.Settle();
  EXPECT_THAT(said_, IsEmpty());
  EXPECT_EQ(watch_.samples(), 505);
  EXPECT_EQ(watch_.duplicates(), 99 * 5);
  EXPECT_EQ(watch_.lost(), 0);
}

TEST_F(LossWatchTest, AGapIsToldByItsRangeOnceNothingCanFillItAnyMore) {
  Hear(0);
  Hear(30);
  EXPECT_THAT(said_, IsEmpty());
  for (int seq = 40; seq < 400; seq += 10) Hear(seq);
  EXPECT_THAT(said_, ElementsAre(HasSubstr("samples 10 to 29 of tool 0, session 1")));
  EXPECT_EQ(watch_.lost(), 20);
}

TEST_F(LossWatchTest, WhatComesLateFillsTheGapAndTheRestIsToldAtTheEnd) {
  Hear(0);
  Hear(60);
  Hear(20);  // of [10, 60)
  Hear(15, 10);
  EXPECT_EQ(watch_.samples(), 35);
  watch_.Settle();
  EXPECT_THAT(said_, ElementsAre(HasSubstr("samples 10 to 14"), HasSubstr("samples 30 to 59")));
  EXPECT_EQ(watch_.lost(), 35);
}

TEST_F(LossWatchTest, ToolsAreCountedApartAndANewSessionIsNoLoss) {
  Hear(0, 10, 1, 0);
  Hear(700, 10, 1, 1);
  Hear(10, 10, 1, 0);
  Hear(0, 10, 2, 0);
  Hear(710, 10, 1, 1);
  watch_.Settle();
  EXPECT_THAT(said_, IsEmpty());
}

TEST_F(LossWatchTest, TwoSendersOnOneChannelAreNamed) {
  Hear(0, 10, 1);
  Hear(0, 10, 2);   // a restart
  Hear(10, 10, 1);  // delayed by the network over it
  Hear(10, 10, 2);
  EXPECT_THAT(said_, IsEmpty());
  for (int i = 2; i < 6; ++i) {
    Hear(10 * i, 10, 1);
    Hear(10 * i, 10, 2);
  }
  EXPECT_THAT(said_, ElementsAre(HasSubstr("two senders speak for tool 0 at once")));
}

TEST_F(LossWatchTest, MemoryIsBoundedWhateverComes) {
  for (int i = 0; i < 3000; ++i) Hear(100 * i, 1);  // gaps without end
  EXPECT_GE(said_.size(), 3000 - LossWatch::kGapsMax - 20) << "the oldest are told of at once";
  for (int i = 1; i < 10'000; ++i) Hear(0, 1, i, i);
  constexpr auto kStreams = static_cast<std::int64_t>(LossWatch::kStreamsMax);
  EXPECT_EQ(watch_.samples(), 3000 + kStreams - 1) << "what comes in further streams is not seen";
  watch_.Settle();
  EXPECT_EQ(watch_.lost(), 2999 * 99);
}

}  // namespace
}  // namespace wellgyro

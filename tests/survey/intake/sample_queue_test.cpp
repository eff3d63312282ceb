#include "wellgyro/survey/intake/sample_queue.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <gtest/gtest.h>

namespace wellgyro {
namespace {

using QueueVerdict = SampleQueue::Verdict;

ImuSample SampleAt(std::int64_t seq, std::int32_t session = 1) {
  ImuSample sample;
  sample.stamp.seq = seq;
  sample.stamp.session = session;
  sample.stamp.period_ns = 10'000'000;
  sample.stamp.tool_time.ns = 1'000 + seq * 10'000'000;
  return sample;
}

/// How many at the begin follow each other by number, and so may be popped at once.
std::size_t Together(std::span<const ImuSample> samples) {
  std::size_t n = 1;
  while (n < samples.size() && samples[n].stamp.seq == samples[n - 1].stamp.seq + 1) ++n;
  return n;
}

std::vector<std::int64_t> Drain(SampleQueue& queue) {
  std::vector<std::int64_t> seqs;
  for (auto ready = queue.Ready(); !ready.empty(); ready = queue.Ready()) {
    ready = ready.first(Together(ready));
    for (const ImuSample& sample : ready) seqs.push_back(sample.stamp.seq);
    queue.Pop(ready.size());
  }
  return seqs;
}

TEST(SampleQueue, HoldsASampleUntilOneSoMuchYoungerHasCome) {
  SampleQueue queue(Duration::Seconds(0.05));
  for (int k = 0; k < 5; ++k) queue.Push(SampleAt(k));
  EXPECT_TRUE(queue.Ready().empty());
  queue.Push(SampleAt(5));
  EXPECT_EQ(Drain(queue), (std::vector<std::int64_t>{0}));
  queue.Flush();
  EXPECT_EQ(Drain(queue), (std::vector<std::int64_t>{1, 2, 3, 4, 5}));
}

TEST(SampleQueue, OrderAndRepetitionOfWhatComesWithinTheHoldDoNotMatter) {
  SampleQueue queue(Duration::Seconds(1));
  for (std::int64_t k : {0, 3, 1, 1, 2, 5, 4, 0, 5}) queue.Push(SampleAt(k));
  queue.Flush();
  EXPECT_EQ(Drain(queue), (std::vector<std::int64_t>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(queue.counts().accepted, 6);
  EXPECT_EQ(queue.counts().duplicates, 3);
}

TEST(SampleQueue, TellsALateSampleFromARepeatedOne) {
  SampleQueue queue(Duration::Seconds(0.05));
  for (std::int64_t k : {0, 1, 4, 5, 6, 7, 8, 20}) queue.Push(SampleAt(k));
  EXPECT_EQ(Drain(queue), (std::vector<std::int64_t>{0, 1, 4, 5, 6, 7, 8}));
  EXPECT_EQ(queue.Push(SampleAt(2)), QueueVerdict::kLate);
  EXPECT_EQ(queue.Push(SampleAt(-7)), QueueVerdict::kLate) << "older than all, and never here";
  EXPECT_EQ(queue.Push(SampleAt(4)), QueueVerdict::kDuplicate);
  EXPECT_EQ(queue.Push(SampleAt(10)), QueueVerdict::kTaken);
  EXPECT_EQ(queue.counts().late, 2);
}

/// Two milli-g off the first.
ImuSample Other(std::int64_t seq, std::int32_t session = 1) {
  ImuSample sample = SampleAt(seq, session);
  sample.f_T.x() = 0.02;
  return sample;
}

TEST(SampleQueue, TellsAnotherContentFromARepeatedSampleWhileItWaits) {
  SampleQueue queue(Duration::Seconds(10));
  for (int k = 0; k < 100; ++k) queue.Push(SampleAt(k));
  EXPECT_EQ(queue.Push(SampleAt(7)), QueueVerdict::kDuplicate);
  EXPECT_EQ(queue.Push(Other(8)), QueueVerdict::kOther);
  EXPECT_EQ(queue.Push(SampleAt(9)), QueueVerdict::kDuplicate);
  ImuSample turned = SampleAt(10);
  turned.w_IT_T.y() = 3e-5;
  EXPECT_EQ(queue.Push(turned), QueueVerdict::kOther);
  ImuSample warmer = SampleAt(11);  // the same counts by another batch's temperature
  warmer.w_IT_T.setConstant(1e-6);
  warmer.f_T.setConstant(1e-3);
  warmer.stamp.temperature = 1;
  EXPECT_EQ(queue.Push(warmer), QueueVerdict::kDuplicate);
  EXPECT_EQ(queue.counts().others, 2);
  EXPECT_EQ(queue.counts().duplicates, 3);
}

TEST(SampleQueue, TellsAnotherContentLongAfterTheFirst) {
  constexpr int kAll = 50'000, kAgain = 5'000;
  SampleQueue queue(Duration::Seconds(1));
  for (int k = 0; k < kAll; ++k) {
    queue.Push(SampleAt(k));
    Drain(queue);
  }
  for (int k = 0; k < kAgain; ++k) queue.Push(SampleAt(k));
  EXPECT_EQ(queue.counts().duplicates, kAgain);
  EXPECT_EQ(queue.counts().others, 0);
  for (int k = 100; k < kAgain; ++k) queue.Push(Other(k));
  // From the first that is kept on.
  EXPECT_EQ(queue.counts().others, kAgain - 128);
  queue.Push(SampleAt(kAll));
  EXPECT_EQ(queue.Push(SampleAt(kAll - 1)), QueueVerdict::kDuplicate);
  // Of what is forgotten nothing is said.
  for (int k = kAll; k < 700'000; ++k) {
    queue.Push(SampleAt(k));
    Drain(queue);
  }
  EXPECT_EQ(queue.Push(Other(64)), QueueVerdict::kDuplicate);
  EXPECT_EQ(queue.Push(Other(640'000)), QueueVerdict::kOther);
}

TEST(SampleQueue, ANewSessionFlushesTheOldOneOnceItIsBelieved) {
  SampleQueue queue(Duration::Seconds(10));
  queue.Push(SampleAt(7, 1));
  queue.Push(SampleAt(8, 1));
  for (std::int64_t k = 0; k < 999; ++k)
    EXPECT_EQ(queue.Push(SampleAt(k, 2)), QueueVerdict::kAside);
  EXPECT_TRUE(queue.Ready().empty());
  EXPECT_EQ(queue.Push(SampleAt(999, 2)), QueueVerdict::kTaken);
  EXPECT_EQ(Drain(queue), (std::vector<std::int64_t>{7, 8}));
  EXPECT_EQ(queue.waiting(), 1'000u);
}

// Bits of a session's number that fall over on the way, or are forged.
TEST(SampleQueue, SamplesOfAnotherSessionHereAndThereAreStrays) {
  SampleQueue queue(Duration::Seconds(1));
  std::vector<std::int64_t> all;
  for (std::int64_t k = 0; k < 20'000; ++k) {
    EXPECT_EQ(queue.Push(SampleAt(k, 1)), QueueVerdict::kTaken);
    all.push_back(k);
    if (k % 100 != 7) continue;
    EXPECT_EQ(queue.Push(SampleAt(k, 2 + static_cast<int>(k) % 3)), QueueVerdict::kAside);
  }
  queue.Flush();
  EXPECT_EQ(Drain(queue), all);
  EXPECT_EQ(queue.counts().strays, 200);
}

TEST(SampleQueue, RefusesWhatMakesNoSense) {
  SampleQueue queue(Duration::Seconds(1));
  EXPECT_EQ(queue.Push(SampleAt(0)), QueueVerdict::kTaken);
  ImuSample nan = SampleAt(1);
  nan.f_T.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(queue.Push(nan), QueueVerdict::kRefused);
  ImuSample jumped = SampleAt(1);
  jumped.stamp.tool_time.ns += 3'600'000'000'000;  // an hour by time, one sample by number
  EXPECT_EQ(queue.Push(jumped), QueueVerdict::kAside);
  ImuSample timeless = SampleAt(1);
  timeless.stamp.period_ns = 0;
  EXPECT_EQ(queue.Push(timeless), QueueVerdict::kRefused);
  EXPECT_EQ(queue.Push(SampleAt(1)), QueueVerdict::kTaken);
  queue.Flush();
  EXPECT_EQ(queue.counts().refused, 2);
  EXPECT_EQ(queue.counts().strays, 1);
}

/// Sample number `k` of a stream whose UTC runs on, whatever its number and tool clock say.
ImuSample Wild(int k, std::int64_t seq_ahead, std::int64_t tool_ahead_ns) {
  ImuSample sample = SampleAt(k);
  sample.stamp.utc.ns = 1'700'000'000'000'000'000 + 10'000'000LL * k;
  sample.stamp.seq += seq_ahead;
  sample.stamp.tool_time.ns += tool_ahead_ns;
  return sample;
}

struct JumpCase {
  std::int64_t seq_ahead, tool_ahead_ns;
};

// Each once ended a survey at the jump, without a word: 2026-11-21.
TEST(SampleQueue, BehindAClockThatJumpsNothingIsLost) {
  constexpr int kBefore = 3000, kAll = 6000;
  for (const JumpCase& jump :
       {JumpCase{0, 1'000'000'000}, JumpCase{0, -10'000'000'000}, JumpCase{-2500, 0},
        JumpCase{7000, 0}, JumpCase{-kBefore, -30'000'000'000}}) {
    const std::int64_t seq = jump.seq_ahead, tool = jump.tool_ahead_ns;
    SampleQueue queue(Duration::Seconds(6));
    std::vector<std::int64_t> utcs;
    int jumps = 0;
    const auto drain = [&] {
      for (auto ready = queue.Ready(); !ready.empty(); ready = queue.Ready()) {
        if (queue.Jumps()) {
          ++jumps;
          EXPECT_EQ(utcs.size(), static_cast<std::size_t>(kBefore)) << seq << " " << tool;
        }
        utcs.push_back(ready.front().stamp.utc.ns);
        queue.Pop();
      }
    };
    // Pairs swapped, so that two cross the jump itself.
    for (int k = 0; k < kAll; ++k) {
      const int from = k == 0 || k == kAll - 1 ? k : ((k - 1) ^ 1) + 1;
      const bool after = from >= kBefore;
      queue.Push(Wild(from, after ? seq : 0, after ? tool : 0));
      drain();
    }
    queue.Flush();
    drain();
    EXPECT_EQ(jumps, 1) << seq << " " << tool;
    ASSERT_EQ(utcs.size(), static_cast<std::size_t>(kAll)) << seq << " " << tool;
    EXPECT_TRUE(std::is_sorted(utcs.begin(), utcs.end())) << seq << " " << tool;
    EXPECT_EQ(queue.counts().strays + queue.counts().late + queue.counts().duplicates, 0);
  }
}

TEST(SampleQueue, AMessageOfWildTimesIsAStrayAndMakesNoOtherLate) {
  for (const JumpCase& jump :
       {JumpCase{0, 1'000'000'000'000}, JumpCase{1'000'000, 0},
        JumpCase{1'000'000, 10'000'000'000'000}, JumpCase{0, -3'000'000'000}}) {
    const std::int64_t seq = jump.seq_ahead, tool = jump.tool_ahead_ns;
    SampleQueue queue(Duration::Seconds(6));
    std::int64_t out = 0;
    for (int k = 0; k < 6000; ++k) {
      const bool wild = k >= 3000 && k < 3100;
      queue.Push(wild ? Wild(k, seq, tool) : Wild(k, 0, 0));
      for (; !queue.Ready().empty(); queue.Pop()) out += queue.Jumps() ? 1000 : 1;
    }
    EXPECT_EQ(queue.counts().strays, 100) << seq << " " << tool;
    EXPECT_EQ(queue.counts().accepted, 5900) << seq << " " << tool;
    EXPECT_GE(out, 5200) << seq << " " << tool;
    EXPECT_LE(out, 5900) << seq << " " << tool;
  }
}

TEST(SampleQueue, WhatIsTakenAwayStaysUntilItIsLetGo) {
  SampleQueue queue(Duration::Seconds(0.02));
  std::int64_t next = 0, oldest = 0, held = 0;
  // Three to seven stay, as in a filter, while the ring goes round, and once 3000, while it grows.
  for (int turn = 0; turn < 2000; ++turn) {
    for (int k = 0; k < 5; ++k) queue.Push(SampleAt(static_cast<int>(next++)));
    for (; !queue.Ready().empty(); ++held) queue.Pop();
    for (std::int64_t seq = oldest; seq < oldest + held;) {
      const std::span<ImuSample> piece = queue.Held();
      ASSERT_FALSE(piece.empty());
      for (const ImuSample& sample : piece) ASSERT_EQ(sample.stamp.seq, seq++);
      const bool keeps = seq == oldest + held;
      const std::int64_t least = turn < 600 ? 3000 : 3;
      const auto away =
          keeps ? std::max<std::int64_t>(held - least, 0) : static_cast<std::int64_t>(piece.size());
      queue.Release(static_cast<std::size_t>(away));
      oldest += away;
      held -= away;
      if (keeps) break;
    }
  }
  EXPECT_EQ(oldest + held, 9998);
}

TEST(SampleQueue, ASampleOfTheSessionBeforeDoesNotBringItBack) {
  SampleQueue queue(Duration::Seconds(1));
  queue.Push(SampleAt(7, 1));
  for (std::int64_t k = 0; k < 1'001; ++k) queue.Push(SampleAt(k, 2));
  EXPECT_EQ(queue.Push(SampleAt(8, 1)), QueueVerdict::kAside);
  queue.Push(SampleAt(1'001, 2));
  queue.Flush();
  EXPECT_EQ(Drain(queue).size(), 1'003u);
  EXPECT_EQ(queue.counts().strays, 1);
}

TEST(SampleQueue, AppendTakesOfABatchWhatPushOfEachWouldUpToTheFirstThatIsSortedIn) {
  std::vector<ImuSample> batch;
  for (std::int64_t k : {0, 1, 2, 3, 5, 4, 6, 7, 7, 8, 8, 20, 21, 22, 9})
    batch.push_back(SampleAt(k));
  batch[7].f_T.x() = 1e6;
  for (std::int64_t k = 0; k < 2'000; ++k) batch.push_back(SampleAt(k, 2));
  SampleQueue one(Duration::Seconds(1)), many(Duration::Seconds(1));
  for (const ImuSample& sample : batch) one.Push(sample);
  std::vector<std::size_t> taken;
  for (std::span<const ImuSample> rest(batch); !rest.empty(); rest = rest.subspan(1)) {
    taken.push_back(many.Append(rest));
    rest = rest.subspan(taken.back());
    if (rest.empty()) break;
    many.Push(rest.front());
  }
  // Up to 0, which is the first; 5; 4; the impossible 7; 8 again; 20; 9; 10 s of the new session,
  // which is not believed yet; the end.
  std::vector<std::size_t> expected = {0, 3, 0, 1, 2, 0, 2};
  expected.insert(expected.end(), 1'000, 0);
  expected.push_back(1'000);
  EXPECT_EQ(taken, expected);
  EXPECT_EQ(one.counts().refused, 1);
  EXPECT_EQ(many.counts().refused, 1);
  EXPECT_EQ(many.counts().accepted, one.counts().accepted);
  EXPECT_EQ(one.counts().duplicates, 1);
  EXPECT_EQ(many.counts().duplicates, 1);
  EXPECT_EQ(many.newest(), one.newest());
  one.Flush();
  many.Flush();
  const std::vector<std::int64_t> seqs = Drain(one);
  EXPECT_EQ(Drain(many), seqs);
  EXPECT_EQ(seqs.size(), 2'013u);
}

TEST(SampleQueue, GrowsPastItsFirstBufferInOrder) {
  SampleQueue queue(Duration::Seconds(1000));
  for (std::int64_t k = 0; k < 5000; ++k) queue.Push(SampleAt(k ^ 1));
  queue.Flush();
  const std::vector<std::int64_t> seqs = Drain(queue);
  ASSERT_EQ(seqs.size(), 5000u);
  for (std::int64_t k = 0; k < 5000; ++k) ASSERT_EQ(seqs[static_cast<std::size_t>(k)], k);
}

}  // namespace
}  // namespace wellgyro

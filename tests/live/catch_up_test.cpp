#include "wellgyro/live/catch_up.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/bus/log_writer.h"

#include "bus/simulated_messages.h"
#include "support/scratch.h"
#include "support/small_hole.h"

namespace wellgyro {
namespace {

using Sent = std::vector<HeldMessage>;

Sent FirstMessages(std::size_t count) {
  Sent sent;
  test::ForEachMessage(
      SimulationOf(testing::SmallHole{.to_md = 20}),
      [&](const std::string& channel, std::span<const std::byte> bytes, std::int64_t received_us) {
        if (sent.size() == count) return;
        sent.push_back({channel, {bytes.begin(), bytes.end()}, received_us});
      });
  return sent;
}

void Log(const std::string& path, std::span<const HeldMessage> messages) {
  auto log = LogWriter::Open(path);
  ASSERT_TRUE(log);
  for (const HeldMessage& m : messages) {
    ASSERT_FALSE(log->Write(m.channel, m.bytes, m.received_us));
  }
  ASSERT_FALSE(log->Close());
}

/// A survey that catches up, what it has used, and a clock that goes on by `tick_us` at each look.
struct Catching {
  explicit Catching(std::int64_t tick_us, std::function<void(int look)> look = {})
      : clock{[this, tick_us] { return now += tick_us; },
              [this, tick_us, look = std::move(look)] {
                if (look) look(++looks);
                return now += tick_us;
              }} {}
  Catching(const Catching&) = delete;
  Catching& operator=(const Catching&) = delete;

  void Fill(const std::string& log) {
    auto bus = LiveBus::Open("memq://");
    ASSERT_TRUE(bus);
    ASSERT_TRUE(catch_up.FillAndJoin(*bus, {log}));
  }
  void ExpectOnceEachOf(const Sent& sent) const {
    EXPECT_EQ(used.size(), sent.size());
    for (const auto& [message, times] : used) EXPECT_EQ(times, 1) << message.first;
  }

  Channels channels;
  LiveObserver observer;
  std::int64_t now = 0;
  int looks = 0;
  LiveClock clock;
  Notices notices{observer, clock};
  std::map<std::pair<std::string, std::vector<std::byte>>, int> used;
  CatchUp catch_up{
      channels, clock, notices,
      [this](std::string_view channel, std::span<const std::byte> bytes, std::int64_t, bool) {
        ++used[{std::string(channel), {bytes.begin(), bytes.end()}}];
      }};
};

// Killed while the first samples still waited for their sender to be known, a survey has depths in
// its log and no sample. A recorder beside it has both.
TEST(CatchUp, WhatWaitedForItsSenderComesFromTheRecordersLog) {
  const Channels channels;
  const Sent sent = FirstMessages(200);
  Sent own;
  int samples = 0;
  for (const HeldMessage& m : sent) {
    samples += m.channel == channels.imu ? 1 : 0;
    if (m.channel != channels.imu) own.push_back(m);
    if (samples == 3 && m.channel == channels.depth) break;
  }
  ASSERT_EQ(samples, 3);
  ASSERT_LT(own.size() + 3, sent.size());
  const support::Scratch scratch;
  const std::string ours = (scratch.path() / "own.lcm").string();
  const std::string theirs = (scratch.path() / "recorder.lcm").string();
  Log(ours, own);
  Log(theirs, sent);

  Catching survey(1'000'000);
  ASSERT_FALSE(survey.catch_up.OwnLog(ours, 0));
  survey.Fill(theirs);
  survey.ExpectOnceEachOf(sent);
}

// A recorder's log that has just begun has the first samples behind the depths that came with them,
// when their sender is known. A survey that hears the bus from the fourth depth on does not join
// before that, and takes from the log what came before it listened.
TEST(CatchUp, WhatWaitsInTheRecorderIsWaitedFor) {
  const Channels channels;
  const Sent sent = FirstMessages(200);
  const auto is_sample = [&](const HeldMessage& m) { return m.channel == channels.imu; };
  const auto nth_sample = [&](int n) {
    auto at = sent.begin();
    while (!is_sample(*at) || --n > 0) ++at;
    return at;
  };
  const auto listens = nth_sample(3), known = nth_sample(4);
  const support::Scratch scratch;
  const std::string theirs = (scratch.path() / "recorder.lcm").string();
  auto log = LogWriter::Open(theirs);
  ASSERT_TRUE(log);
  const auto write = [&](auto begin, auto end, bool samples) {
    for (auto m = begin; m != end; ++m) {
      if (is_sample(*m) != samples) continue;
      ASSERT_FALSE(log->Write(m->channel, m->bytes, m->received_us));
    }
    ASSERT_FALSE(log->Flush());
  };
  write(sent.begin(), known, false);

  // The fourth sample comes between the third look at the log and the next.
  Catching survey(100'000, [&](int look) {
    if (look != 4) return;
    write(sent.begin(), known + 1, true);
    for (auto m = known + 1; m != sent.end(); ++m) {
      EXPECT_FALSE(log->Write(m->channel, m->bytes, m->received_us));
    }
    EXPECT_FALSE(log->Flush());
  });
  for (auto m = listens; m != sent.end(); ++m) {
    survey.catch_up.Hold(m->channel, m->bytes, m->received_us);
  }
  survey.Fill(theirs);
  survey.ExpectOnceEachOf(sent);
}

// Killed before it had used any sample or depth, a survey has only what is sent again in its log:
// what is behind that is told by the time it was heard at, in whatever order the recorder wrote it.
TEST(CatchUp, WhatWasHeardSinceIsUsedInTheRecordersOrder) {
  const Channels channels;
  Sent sent = FirstMessages(200);
  const auto sent_again = [&](const HeldMessage& m) {
    return m.channel != channels.imu && m.channel != channels.depth;
  };
  const auto begin = std::find_if_not(sent.begin(), sent.end(), sent_again);
  ASSERT_GT(begin - sent.begin(), 0);
  std::int64_t at = 1'000'000;
  for (HeldMessage& m : sent) m.received_us = at += 50'000;
  const support::Scratch scratch;
  const std::string ours = (scratch.path() / "own.lcm").string();
  const std::string theirs = (scratch.path() / "recorder.lcm").string();
  Log(ours, {sent.begin(), begin});
  // The first samples behind the depths that came with them.
  Sent written = sent;
  const auto first = written.begin() + (begin - sent.begin());
  std::stable_partition(first, first + 30,
                        [&](const HeldMessage& m) { return m.channel != channels.imu; });
  Log(theirs, written);

  Catching survey(1'000'000);
  ASSERT_FALSE(survey.catch_up.OwnLog(ours, 0));
  survey.Fill(theirs);
  survey.ExpectOnceEachOf(sent);
}

}  // namespace
}  // namespace wellgyro

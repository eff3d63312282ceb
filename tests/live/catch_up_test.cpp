#include "wellgyro/live/catch_up.h"

#include <cstddef>
#include <cstdint>
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

  LiveObserver observer;
  std::int64_t now = 0;
  const LiveClock clock{[&] { return now += 1'000'000; }, [&] { return now += 1'000'000; }};
  Notices notices(observer, clock);
  std::map<std::pair<std::string, std::vector<std::byte>>, int> used;
  CatchUp catch_up(
      channels, clock, notices,
      [&](std::string_view channel, std::span<const std::byte> bytes, std::int64_t, bool) {
        ++used[{std::string(channel), {bytes.begin(), bytes.end()}}];
      });
  ASSERT_FALSE(catch_up.OwnLog(ours, 0));
  auto bus = LiveBus::Open("memq://");
  ASSERT_TRUE(bus);
  ASSERT_TRUE(catch_up.FillAndJoin(*bus, {theirs}));
  EXPECT_EQ(used.size(), sent.size());
  for (const auto& [message, times] : used) EXPECT_EQ(times, 1) << message.first;
}

}  // namespace
}  // namespace wellgyro

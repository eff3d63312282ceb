// A live session as a vendor's program runs it: over multicast, in this process.
#include "wellgyro/live/session.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "wellgyro/bus/encode.h"
#include "wellgyro/bus/lcm_live.h"
#include "wellgyro/io/result/run_file.h"
#include "wellgyro/io/text_file.h"
#include "wellgyro/survey/run_adjuster.h"

#include "bus/multicast.h"
#include "bus/simulated_messages.h"
#include "support/scratch.h"
#include "support/small_hole.h"

namespace wellgyro {
namespace {

using std::chrono::milliseconds;

std::int64_t Micros(auto now) {
  return std::chrono::duration_cast<std::chrono::microseconds>(now.time_since_epoch()).count();
}

/// What the session tells, from whichever thread.
struct Observer : LiveObserver {
  void OnNotice(std::string_view sentence) override { said.emplace_back(sentence); }
  void OnStation(const Station&) override { ++stations; }
  void OnStatus(const Status& status) override {
    ++statuses;
    oldest = std::max(oldest.load(), status.data_age);
    busy += status.text.starts_with("busy") ? 1 : 0;
  }
  void OnStuck(const std::optional<RunVerdict>& what) override {
    kept = what;
    stuck_us = Micros(std::chrono::steady_clock::now());
  }
  std::optional<RunVerdict> kept;
  std::vector<std::string> said;
  std::atomic<int> stations = 0, statuses = 0, busy = 0;
  std::atomic<double> oldest = 0;  ///< newest sample that a status told of [s]
  std::atomic<std::int64_t> stuck_us = 0;
};

/// Takes its time, as the adjustment of a long run does.
struct SlowAdjuster : RunAdjuster {
  SmoothedRun Adjust(const RunHistory& history) const override {
    ++begun;
    while (!release) std::this_thread::sleep_for(milliseconds(20));
    return {history.attitude, history.states, std::nullopt};
  }
  mutable std::atomic<int> begun = 0;
  std::atomic<bool> release = false;
};

class Session : public ::testing::Test {
 protected:
  void SetUp() override {
    if (const std::string lacks = test::NoMulticast(port_); !lacks.empty()) GTEST_SKIP() << lacks;
    setup_.job.job = JobOf(hole_);
    setup_.url = "udpm://239.255.76.67:" + std::to_string(port_);
    setup_.out = (scratch_.path() / "out").string();
    setup_.clock = {[] { return Micros(std::chrono::system_clock::now()); },
                    [] { return Micros(std::chrono::steady_clock::now()); }};
  }

  /// Sends the run, slowly enough for one thread.
  void Send(LiveBus& bus, bool finish) {
    int sent = 0;
    test::ForEachMessage(SimulationOf(hole_), [&](const auto& channel, auto bytes, std::int64_t) {
      ASSERT_FALSE(bus.Publish(channel, bytes));
      if (++sent % 20 == 0) std::this_thread::sleep_for(milliseconds(1));
    });
    if (finish) Order(bus, Command::Kind::kFinish);
  }
  void Order(LiveBus& bus, Command::Kind kind) {
    Command command;
    command.utc = SimulationOf(hole_).streams.begin_utc + Duration::Seconds(1e5);
    command.command_id = 1;
    command.kind = kind;
    std::vector<std::byte> bytes;
    Encode(command, bytes);
    ASSERT_FALSE(bus.Publish("WELLGYRO_CMD", bytes));
  }

  testing::SmallHole hole_{.to_md = 100};
  std::uint16_t port_ = static_cast<std::uint16_t>(20'000 + getpid() % 40'000);
  support::Scratch scratch_;
  LiveSetup setup_;
  Observer observer_;
};

TEST_F(Session, SurveysRecordsAndResumesInTheSameFolder) {
  setup_.record = (scratch_.path() / "heard.lcm").string();
  auto speaking = LiveBus::Open(setup_.url);
  ASSERT_TRUE(speaking);
  {
    auto session = LiveSession::Open(setup_, observer_);
    ASSERT_TRUE(session) << session.fault().text;
    std::thread sender([&] {
      Send(*speaking, false);
      std::this_thread::sleep_for(milliseconds(500));
      (*session)->Stop();
    });
    const LiveOutcome outcome = (*session)->Run();
    sender.join();
    EXPECT_EQ(outcome.ended, LiveOutcome::Ended::kInterrupted);
    EXPECT_TRUE(outcome.usable());
  }
  setup_.resume = true;
  auto session = LiveSession::Open(setup_, observer_);
  ASSERT_TRUE(session) << session.fault().text;
  std::thread sender([&] {
    std::this_thread::sleep_for(milliseconds(300));
    Order(*speaking, Command::Kind::kFinish);
  });
  const LiveOutcome outcome = (*session)->Run();
  sender.join();
  EXPECT_EQ(outcome.ended, LiveOutcome::Ended::kFinished);
  EXPECT_FALSE(outcome.fault);
  ASSERT_TRUE(outcome.usable());
  EXPECT_EQ(outcome.record->operations.size(), 1u);
  EXPECT_GT(observer_.stations, 5);
  const auto run = ReadTextFile(scratch_.path() / "out" / "run.toml");
  ASSERT_TRUE(run) << run.fault().text;
  EXPECT_NE(run->find("\nprogram = \"wellgyro\"\n"), std::string::npos);
  EXPECT_NE(run->find("\nadjuster = \"least squares of rotations\"\n"), std::string::npos);
}

// 2026-11-24: what was sent just before a stop was in the receiver's hands only, or waited for
// samples behind it: run.toml named a FINISH as obeyed, or nothing, of a survey that had not ended.
TEST_F(Session, AnOrderJustBeforeAStopIsObeyed) {
  auto speaking = LiveBus::Open(setup_.url);
  ASSERT_TRUE(speaking);
  auto session = LiveSession::Open(setup_, observer_);
  ASSERT_TRUE(session) << session.fault().text;
  std::thread sender([&] {
    Send(*speaking, true);
    (*session)->Stop();
  });
  const LiveOutcome outcome = (*session)->Run();
  sender.join();
  EXPECT_EQ(outcome.ended, LiveOutcome::Ended::kFinished);
  EXPECT_EQ(outcome.record->operations.size(), 1u);
  EXPECT_TRUE(outcome.usable());
  EXPECT_THROW((*session)->Run(), std::logic_error) << "a session runs once";
}

TEST_F(Session, AFolderHasOneSession) {
  auto session = LiveSession::Open(setup_, observer_);
  ASSERT_TRUE(session) << session.fault().text;
  Observer other;
  const auto second = LiveSession::Open(setup_, other);
  ASSERT_FALSE(second);
  EXPECT_NE(second.fault().text.find("another wellgyro"), std::string::npos);
}

// As when it reads a long log again.
TEST_F(Session, BusyBeforeItsFirstStatusItTellsOfNoOldData) {
  auto session = LiveSession::Open(setup_, observer_);
  ASSERT_TRUE(session) << session.fault().text;
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (observer_.busy == 0 && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(milliseconds(20));
  }
  EXPECT_GT(observer_.busy, 0) << "the rig was not told that it lives";
  EXPECT_EQ(observer_.oldest, 0) << "s old, though nothing has come";
}

TEST_F(Session, WhileItAdjustsItsStatusGoesOnAndAStopIsHeeded) {
  SlowAdjuster adjuster;
  auto session = LiveSession::Open(setup_, observer_);
  ASSERT_TRUE(session) << session.fault().text;
  AdjustBy(adjuster, **session);
  auto speaking = LiveBus::Open(setup_.url);
  std::thread runner([&] { (*session)->Run(); });
  Send(*speaking, true);
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (adjuster.begun == 0 && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(milliseconds(20));
  }
  ASSERT_GT(adjuster.begun, 0) << "FINISH was not obeyed";
  std::this_thread::sleep_for(milliseconds(3500));
  EXPECT_GE(observer_.busy, 2);
  const std::int64_t stop = Micros(std::chrono::steady_clock::now());
  (*session)->Stop();
  std::this_thread::sleep_for(milliseconds(2200));
  EXPECT_GT(observer_.stuck_us, 0) << "nobody was told";
  EXPECT_LT(observer_.stuck_us - stop, 2'000'000);
  EXPECT_TRUE(observer_.kept) << "files were written before the adjustment";
  adjuster.release = true;
  runner.join();
}

TEST(SessionSetup, WithoutAClockOrAFolderIsRefused) {
  Observer observer;
  LiveSetup setup;
  setup.out = "never-made";
  EXPECT_THROW(static_cast<void>(LiveSession::Open(setup, observer)), std::invalid_argument);
  setup.clock.utc_us = [] { return std::int64_t{0}; };
  EXPECT_THROW(static_cast<void>(LiveSession::Open(setup, observer)), std::invalid_argument);
  setup.clock.monotonic_us = setup.clock.utc_us;
  setup.out.clear();
  const auto session = LiveSession::Open(setup, observer);
  ASSERT_FALSE(session);
  EXPECT_NE(session.fault().text.find("`out`"), std::string::npos) << session.fault().text;
}

}  // namespace
}  // namespace wellgyro

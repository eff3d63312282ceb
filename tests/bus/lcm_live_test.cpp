#include "wellgyro/bus/lcm_live.h"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/wait.h>
#include <unistd.h>

#include "wellgyro/bus/feed.h"

#include "bus/generated_messages.h"
#include "bus/multicast.h"

namespace wellgyro::test {
namespace {

using testing::HasSubstr;
using Woken = LiveBus::Woken;

struct Got {
  std::string channel;
  Bytes data;
};

LiveBus::Handler Into(std::vector<Got>& got) {
  return [&got](std::string_view channel, std::span<const std::byte> data, std::int64_t) {
    got.push_back({std::string(channel), Bytes(data.begin(), data.end())});
  };
}

LiveBus Memory() {
  Result<LiveBus> bus = LiveBus::Open("memq://");
  if (!bus) throw std::runtime_error(bus.fault().text);
  return std::move(*bus);
}

Woken Waited(LiveBus& bus, int timeout_ms) {
  const Result<Woken> woken = bus.Wait(timeout_ms);
  if (!woken) throw std::runtime_error(woken.fault().text);
  return *woken;
}

TEST(LcmLive, PublishThenHearInOneThread) {
  LiveBus bus = Memory();
  std::vector<Got> got;
  ASSERT_FALSE(bus.Subscribe({}, Into(got)));
  EXPECT_EQ(Waited(bus, 0), Woken::kIdle);
  for (int i = 0; i < 300; ++i) ASSERT_FALSE(bus.Publish("A", Bytes(static_cast<std::size_t>(i))));
  EXPECT_EQ(Waited(bus, 0), Woken::kMessages);
  ASSERT_EQ(got.size(), 300U) << "more than LCM's own queue of 30";
  EXPECT_EQ(got[299].data.size(), 299U);
  EXPECT_EQ(Waited(bus, 0), Woken::kIdle);
}

TEST(LcmLive, OneWaitHandsOnABurstAndDrainTheRest) {
  LiveBus bus = Memory();
  std::vector<Got> got;
  ASSERT_FALSE(bus.Subscribe({}, Into(got)));
  for (int i = 0; i < LiveBus::kBurst + 50; ++i) ASSERT_FALSE(bus.Publish("A", {}));
  EXPECT_EQ(Waited(bus, 0), Woken::kMessages);
  EXPECT_EQ(got.size(), std::size_t{LiveBus::kBurst});
  EXPECT_EQ(*bus.Drain(), 50);
  EXPECT_EQ(*bus.Drain(), 0);
}

TEST(LcmLive, ChannelsAreTakenLiterally) {
  LiveBus bus = Memory();
  std::vector<Got> got;
  ASSERT_FALSE(bus.Subscribe({"A.B", "C+", "A.B"}, Into(got)));
  for (const char* channel : {"A.B", "AxB", "A.BB", "C+", "CC"}) {
    ASSERT_FALSE(bus.Publish(channel, {}));
  }
  EXPECT_EQ(Waited(bus, 0), Woken::kMessages);
  ASSERT_EQ(got.size(), 2U);
  EXPECT_EQ(got[0].channel, "A.B");
  EXPECT_EQ(got[1].channel, "C+");
}

TEST(LcmLive, WhatAHandlerThrowsComesOutAndTheBusGoesOn) {
  LiveBus bus = Memory();
  int calls = 0;
  ASSERT_FALSE(bus.Subscribe({}, [&calls](auto&&...) {
    if (++calls == 1) throw std::domain_error("from the handler");
  }));
  ASSERT_FALSE(bus.Publish("A", {}));
  ASSERT_FALSE(bus.Publish("A", {}));
  EXPECT_THROW(Waited(bus, 0), std::domain_error);
  EXPECT_EQ(Waited(bus, 0), Woken::kMessages);
  EXPECT_EQ(calls, 2);
}

TEST(LcmLive, StopEndsEveryWaitAndDrainGivesWhatHadCome) {
  LiveBus bus = Memory();
  std::vector<Got> got;
  ASSERT_FALSE(bus.Subscribe({}, Into(got)));
  ASSERT_FALSE(bus.Publish("A", {}));
  bus.Stop();
  EXPECT_EQ(Waited(bus, -1), Woken::kStopped);
  EXPECT_EQ(Waited(bus, -1), Woken::kStopped);
  EXPECT_EQ(*bus.Drain(), 1);
  EXPECT_EQ(got.size(), 1U);
}

LiveBus* to_stop = nullptr;

TEST(LcmLive, ASignalHandlerMayStopAWaitThatHasBegun) {
  LiveBus bus = Memory();
  std::vector<Got> got;
  ASSERT_FALSE(bus.Subscribe({}, Into(got)));
  to_stop = &bus;
  struct sigaction action {};
  action.sa_flags = SA_RESTART;  // what signal(2) gives, and what liblcm alone never wakes from
  action.sa_handler = [](int) { to_stop->Stop(); };
  struct sigaction before {};
  ASSERT_EQ(sigaction(SIGUSR1, &action, &before), 0);
  const pthread_t waiting = pthread_self();
  std::thread killer([waiting] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    pthread_kill(waiting, SIGUSR1);
  });
  EXPECT_EQ(Waited(bus, -1), Woken::kStopped);
  killer.join();
  sigaction(SIGUSR1, &before, nullptr);
}

TEST(LcmLive, UrlsThatCannotBe) {
  const auto said = [](const char* url) {
    const Result<LiveBus> bus = LiveBus::Open(url);
    return bus ? std::string("opened") : bus.fault().text;
  };
  EXPECT_THAT(said(""), HasSubstr("udpm://239.255.76.67:7667?ttl=0"));
  EXPECT_THAT(said("log.lcm"), HasSubstr("no LCM URL"));
  EXPECT_THAT(said("file://log.lcm"), HasSubstr("by its path"));
  EXPECT_THAT(said("http://x"), HasSubstr("udpm, tcpq and memq"));
  EXPECT_THAT(said("udpm://239.255.76.67:0"), HasSubstr("port"));
  EXPECT_THAT(said("udpm://239.255.76.67:99999"), HasSubstr("port"));
  EXPECT_THAT(said("udpm://127.0.0.1:7667"), HasSubstr("no multicast group"));
  EXPECT_THAT(said("udpm://somewhere:7667"), HasSubstr("no multicast group"));
  EXPECT_THAT(said("udpm://239.255.76.67:7667?ttl=x"), HasSubstr("ttl=x"));
  EXPECT_THAT(said("udpm://239.255.76.67:7667?ttl=256"), HasSubstr("255"));
  EXPECT_THAT(said("udpm://239.255.76.67:7667?ttl"), HasSubstr("number"));
  EXPECT_THAT(said("udpm://239.255.76.67:7667?ttl=0&recv_buf_size=-1"), HasSubstr("recv_buf"));
  EXPECT_THAT(said("udpm://239.255.76.67:7667?tll=1"), HasSubstr("tll"));
}

TEST(LcmLive, NoBroker) {
  const Result<LiveBus> bus = LiveBus::Open("tcpq://127.0.0.1:9");
  ASSERT_FALSE(bus);
  EXPECT_THAT(bus.fault().text, HasSubstr("no broker answers"));
}

TEST(LcmLive, ChannelsOfWrongLength) {
  LiveBus bus = Memory();
  EXPECT_THROW(static_cast<void>(bus.Publish("", {})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(bus.Publish(std::string(64, 'A'), {})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(bus.Subscribe({""}, [](auto&&...) {})), std::invalid_argument);
}

/// In a process that ends with it: whether it can have a network of its own, with nothing up.
bool LeaveTheNetwork() { return unshare(CLONE_NEWUSER | CLONE_NEWNET) == 0; }

TEST(LcmLive, AMissingRouteIsNamedWithTheCommandThatAddsIt) {
  const pid_t child = fork();
  if (child == 0) _exit(LeaveTheNetwork() ? 0 : errno);
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  if (const int error = WEXITSTATUS(status); error != 0) {
    GTEST_SKIP() << "no network namespaces here: " << std::strerror(error);
  }
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  const auto open_without_network = [] {
    if (!LeaveTheNetwork()) std::exit(2);
    const Result<LiveBus> bus = LiveBus::Open("udpm://239.255.76.67:7667");
    if (!bus) std::fputs(bus.fault().text.c_str(), stderr);
    std::exit(bus ? 1 : 0);
  };
  EXPECT_EXIT(open_without_network(), testing::ExitedWithCode(0),
              "ip route add 224.0.0.0/4 dev lo");
}

class LcmLiveMulticast : public testing::Test {
 protected:
  void SetUp() override {
    if (const std::string lacks = NoMulticast(port_); !lacks.empty()) GTEST_SKIP() << lacks;
  }
  std::string Url() const { return "udpm://239.255.76.67:" + std::to_string(port_); }

 private:
  // A port of its own: LCM 1.3 hears every group on its port.
  std::uint16_t port_ = static_cast<std::uint16_t>(20'000 + getpid() % 40'000);
};

TEST_F(LcmLiveMulticast, ARestingListenerLosesNothing) {
  const std::string url = Url();
  Result<LiveBus> listening = LiveBus::Open(url);
  ASSERT_TRUE(listening) << listening.fault().text;
  EXPECT_THAT(listening->url(), HasSubstr("ttl=0&recv_buf_size=4194304"));
  std::vector<Got> got;
  const auto fault = listening->Subscribe({"WELLGYRO_DEPTH"}, Into(got));
  ASSERT_FALSE(fault) << fault->text;
  Result<LiveBus> speaking = LiveBus::Open(url);
  ASSERT_TRUE(speaking);
  const Bytes depth = BytesOf(GeneratedDepth());
  // Nobody listens meanwhile; LCM's own 30 messages and a small kernel buffer must not matter.
  constexpr std::size_t kCount = 200;
  for (std::size_t i = 0; i < kCount; ++i) {
    ASSERT_FALSE(speaking->Publish("WELLGYRO_DEPTH", depth));
  }
  while (got.size() < kCount && Waited(*listening, 2000) == Woken::kMessages) continue;
  ASSERT_EQ(got.size(), kCount);
  EXPECT_EQ(got.back().data, depth);
  EXPECT_EQ(listening->kernel_drops(), 0);
  ASSERT_TRUE(listening->granted_receive_buffer());
  EXPECT_GT(*listening->granted_receive_buffer(), 100'000);
  EXPECT_EQ(listening->refused(), 0);
}

// 10 kHz in batches of 32. LCM's own thread goes on reading while the consumer stands.
TEST_F(LcmLiveMulticast, AConsumerThatStandsForASecondLosesNothing) {
  const std::string url = Url();
  Result<LiveBus> listening = LiveBus::Open(url);
  ASSERT_TRUE(listening) << listening.fault().text;
  constexpr std::int64_t kCount = 625;
  std::int64_t heard = 0, wrong = 0;
  const auto handler = [&](std::string_view, std::span<const std::byte> data, std::int64_t) {
    std::int64_t number = -1;
    std::memcpy(&number, data.data(), sizeof number);
    wrong += number == heard++ ? 0 : 1;
    if (heard == 100) std::this_thread::sleep_for(std::chrono::seconds(1));
  };
  const auto fault = listening->Subscribe({"BATCH"}, handler);
  ASSERT_FALSE(fault) << fault->text;
  std::thread speaker([&url] {
    Result<LiveBus> speaking = LiveBus::Open(url);
    if (!speaking) return;
    Bytes bytes(1336);
    auto due = std::chrono::steady_clock::now();
    for (std::int64_t i = 0; i < kCount; ++i) {
      std::memcpy(bytes.data(), &i, sizeof i);
      static_cast<void>(speaking->Publish("BATCH", bytes));
      std::this_thread::sleep_until(due += std::chrono::microseconds(3200));
    }
  });
  while (heard < kCount && Waited(*listening, 3000) == Woken::kMessages) continue;
  speaker.join();
  EXPECT_EQ(heard, kCount);
  EXPECT_EQ(wrong, 0) << "each once and in order";
}

// Datagrams that LCM takes for messages and that no sender of LCM makes.
TEST(LcmLive, HostileMessagesThroughTheWholeWayIn) {
  struct Count : Listener {
    void OnDepth(const DepthMark&) override { ++good; }
    void OnFault(const Fault&) override { ++faults; }
    int good = 0;
    int faults = 0;
  } count;
  LiveBus bus = Memory();
  Feed feed({}, count);
  ASSERT_FALSE(bus.Subscribe({}, [&feed](std::string_view channel, std::span<const std::byte> data,
                                         std::int64_t) { feed.Take(channel, data); }));
  const Bytes depth = BytesOf(GeneratedDepth());
  for (std::size_t size = 0; size <= depth.size(); ++size) {
    ASSERT_FALSE(bus.Publish("WELLGYRO_DEPTH", std::span(depth).first(size)));
  }
  EXPECT_EQ(Waited(bus, 0), Woken::kMessages);
  EXPECT_EQ(count.good, 1);
  EXPECT_EQ(count.faults, Feed::kFaultsHeard);
  EXPECT_EQ(feed.malformed(), static_cast<std::int64_t>(depth.size()));
}

}  // namespace
}  // namespace wellgyro::test

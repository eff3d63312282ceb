// One build, the same messages: the same survey, bit for bit, live over every transport and from
// the log; and how the streams interleave does not matter within the job's latency.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "wellgyro/bus/lcm_live.h"
#include "wellgyro/bus/log_reader.h"
#include "wellgyro/bus/log_writer.h"
#include "wellgyro/bus/survey_log.h"
#include "wellgyro/io/result/run_file.h"

#include "bus/broker.h"
#include "bus/multicast.h"
#include "bus/simulated_messages.h"
#include "support/scratch.h"
#include "support/small_hole.h"

namespace wellgyro {
namespace {

struct Sent {
  std::string channel;
  std::vector<std::byte> bytes;
  std::int64_t utime_us = 0;
};

const testing::SmallHole kHole = {.inclination_deg = 35,
                                  .azimuth_deg = 70,
                                  .latitude_deg = 57,
                                  .to_md = 200,
                                  .rpm = 1,
                                  .imu_hz = 25,
                                  .depth_hz = 5,
                                  .walk = 0.01,
                                  .accel_noise_g = 5e-5};

Simulation NoisyRun() {
  Simulation simulation = SimulationOf(kHole);
  simulation.seed = 11;
  simulation.tool.errors.utc_jitter = 1e-3;
  simulation.streams.batch = 25;
  return simulation;
}

std::vector<Sent> Messages(const Simulation& simulation) {
  std::vector<Sent> messages;
  test::ForEachMessage(simulation, [&](const std::string& channel, std::span<const std::byte> bytes,
                                       std::int64_t now) {
    messages.push_back({channel, {bytes.begin(), bytes.end()}, now});
  });
  return messages;
}

Job SomeJob() {
  Job job = JobOf(kHole);
  job.depth.latency = 2;
  return job;
}

/// The result files of a survey but source.toml, as one text.
class Surveyed {
 public:
  Surveyed() : surveyor_(SomeJob(), sink_), listener_(surveyor_, sink_), feed_({}, listener_) {}
  void Take(std::string_view channel, std::span<const std::byte> bytes) {
    feed_.Take(channel, bytes);
  }
  std::string Files() {
    surveyor_.Finish();
    const Survey survey = surveyor_.Current(0);
    EXPECT_EQ(survey.unusable, "");
    EXPECT_EQ(survey.chosen.size(), 11u);
    std::string text;
    for (const OutputFile& file : ResultFiles({}, {}, SomeJob(), survey)) {
      if (file.name != "source.toml") text += file.name + "\n" + file.bytes;
    }
    return text;
  }

 private:
  Sink sink_;
  Surveyor surveyor_;
  SurveyorListener listener_;
  Feed feed_;
};

std::string FromLog(const std::vector<Sent>& messages) {
  const support::Scratch folder;
  const std::string path = (folder.path() / "run.lcm").string();
  auto writer = LogWriter::Open(path);
  EXPECT_TRUE(writer);
  for (const Sent& m : messages) EXPECT_FALSE(writer->Write(m.channel, m.bytes, m.utime_us));
  EXPECT_FALSE(writer->Close());
  auto reader = LogReader::Open(path);
  EXPECT_TRUE(reader);
  Surveyed surveyed;
  LogEvent event;
  while (reader->Next(event)) surveyed.Take(event.channel, event.data);
  return surveyed.Files();
}

/// The messages in the order in which they come when depth comes 1.5 s later than it was sent and
/// modes 1 s, against a latency of 2 s.
std::vector<Sent> Late(const std::vector<Sent>& messages) {
  std::vector<std::pair<std::int64_t, const Sent*>> order;
  for (const Sent& m : messages) {
    const std::int64_t late = m.channel == Channels{}.depth  ? 1'500'000
                              : m.channel == Channels{}.mode ? 1'000'000
                                                             : 0;
    order.emplace_back(m.utime_us + late, &m);
  }
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Sent> result;
  for (const auto& [time, m] : order) result.push_back(*m);
  return result;
}

/// One bus sends, another hears; of memq only one object can do both.
std::string FromBus(const std::string& url, const std::vector<Sent>& messages) {
  auto hearing = LiveBus::Open(url);
  EXPECT_TRUE(hearing) << hearing.fault().text;
  const bool memory = url == "memq://";
  auto speaking = memory ? Result<LiveBus>(Fault{}) : LiveBus::Open(url);
  EXPECT_TRUE(memory || speaking);
  LiveBus& out = memory ? *hearing : *speaking;
  Surveyed live;
  std::size_t heard = 0;
  EXPECT_FALSE(hearing->Subscribe(
      {}, [&](std::string_view channel, std::span<const std::byte> data, std::int64_t) {
        ++heard;
        live.Take(channel, data);
      }));
  std::size_t sent = 0;
  for (const Sent& m : messages) {
    EXPECT_FALSE(out.Publish(m.channel, m.bytes));
    ++sent;
    // The smallest buffer holds thirty such messages.
    while (sent - heard > 15) {
      const auto woken = hearing->Wait(2000);
      if (!woken || *woken != LiveBus::Woken::kMessages) {
        ADD_FAILURE() << "after " << sent << " messages " << heard << " came";
        return {};
      }
    }
  }
  while (heard < sent) {
    const auto woken = hearing->Wait(2000);
    if (!woken || *woken != LiveBus::Woken::kMessages) break;
  }
  EXPECT_EQ(heard, sent);
  return live.Files();
}

/// On tcpq a subscription takes effect when the broker has it.
class SameBytes : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    if (GetParam() != "udpm") return;
    if (const std::string lacks = test::NoMulticast(port_); !lacks.empty()) GTEST_SKIP() << lacks;
  }
  std::string Url() {
    if (GetParam() == "tcpq") return broker_.url();
    if (GetParam() == "udpm") return "udpm://239.255.76.67:" + std::to_string(port_);
    return "memq://";
  }
  // Its own: LCM 1.3 hears every group on its port.
  const std::uint16_t port_ = static_cast<std::uint16_t>(20'000 + getpid() % 40'000);
  test::Broker broker_;
};

TEST_P(SameBytes, LiveAndFromTheLogInTwoInterleavings) {
  const std::string url = Url();
  const std::vector<Sent> messages = Messages(NoisyRun());
  const std::string log = FromLog(messages);
  EXPECT_GT(log.size(), 5000u);
  EXPECT_EQ(FromBus(url, messages), log);
  EXPECT_EQ(FromBus(url, Late(messages)), log);
  EXPECT_EQ(FromLog(Late(messages)), log);
}

INSTANTIATE_TEST_SUITE_P(Transports, SameBytes, ::testing::Values("memq", "udpm", "tcpq"),
                         [](const auto& transport) { return transport.param; });

}  // namespace
}  // namespace wellgyro

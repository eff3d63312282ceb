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
#include <variant>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/bus/encode.h"
#include "wellgyro/bus/lcm_live.h"
#include "wellgyro/bus/log_reader.h"
#include "wellgyro/bus/log_writer.h"
#include "wellgyro/bus/surveyor_listener.h"
#include "wellgyro/io/run_file.h"
#include "wellgyro/simulate/sample_batcher.h"
#include "wellgyro/simulate/simulator.h"

#include "bus/broker.h"
#include "bus/multicast.h"
#include "support/scratch.h"

namespace wellgyro {
namespace {

struct Sent {
  std::string channel;
  std::vector<std::byte> bytes;
  std::int64_t utime_us = 0;
};

Simulation NoisyRun() {
  Simulation simulation;
  simulation.seed = 11;
  simulation.well.end_md = 300;
  simulation.well.inclination.start = FromDegrees(35);
  simulation.well.azimuth.start = FromDegrees(70);
  simulation.earth.latitude = FromDegrees(57);
  simulation.tool.errors.gyro_noise.angle_random_walk = 0.01 * units::kDegPerSqrtHour;
  simulation.tool.errors.accel_noise = 5e-5 * units::kStandardGravity;
  simulation.tool.errors.utc_jitter = 1e-3;
  RunStop stop;
  stop.seconds = 90;
  RunMove move;
  move.to_md = 200;
  move.roll.rate = kTwoPi / 60;
  simulation.run.steps = {stop, move, stop};
  simulation.streams.imu_hz = 25;
  simulation.streams.batch = 25;
  simulation.streams.depth_hz = 5;
  return simulation;
}

std::vector<Sent> Messages(const Simulation& simulation) {
  const Channels channels;
  std::vector<Sent> messages;
  std::vector<std::byte> bytes;
  Simulator simulator(simulation);
  SampleBatcher batcher(simulation.streams, simulation.seed);
  SampleBatch batch;
  std::int64_t now = 0;
  const auto send = [&](const std::string& channel, const auto& record) {
    Encode(record, bytes);
    messages.push_back({channel, bytes, now});
  };
  SimulatedStep step;
  while (simulator.Next(step)) {
    if (const auto* sample = std::get_if<ImuSample>(&step)) {
      now = (sample->stamp.utc.ns + sample->stamp.period_ns) / 1000;
      if (batcher.Push(*sample, batch)) {
        send(channels.imu, std::span<const ImuSample>(batch.samples));
      }
    } else if (const auto* mark = std::get_if<DepthMark>(&step)) {
      now = mark->utc.ns / 1000;
      send(channels.depth, *mark);
    } else {
      send(channels.mode, std::get<ToolMode>(step));
    }
  }
  if (batcher.Flush(batch)) send(channels.imu, std::span<const ImuSample>(batch.samples));
  return messages;
}

Job SomeJob() {
  Job job;
  job.well.latitude = FromDegrees(57);
  job.noise.angle_random_walk = 0.01 * units::kDegPerSqrtHour;
  job.errors.accel_noise = 5e-5 * units::kStandardGravity;
  job.depth.latency = 2;
  job.stations.every = 20;
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

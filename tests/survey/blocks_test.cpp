// Law: samples that go through the survey by the block say what each of them says by itself.
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <gtest/gtest.h>

#include "wellgyro/math/random.h"

#include "support/simulated_survey.h"
#include "support/small_hole.h"

namespace wellgyro {
namespace {

constexpr double kHz = 500;

testing::SmallHole HoleOfBlocks() {
  return {.to_md = 40,
          .rpm = 2,
          .imu_hz = kHz,
          .depth_hz = 10,
          .accel_noise_g = 5e-5,
          .stations_every = 5};
}

std::int64_t NumberAt(double seconds) { return static_cast<std::int64_t>(seconds * kHz); }

/// What happens to real streams: spikes, lost samples, a flag, temperatures that change, a UTC that
/// jitters from message to message, a clock that jumps and a session that begins anew. False: lost.
bool Spoil(ImuSample& sample, std::int64_t& jitter, Random& random) {
  SampleStamp& stamp = sample.stamp;
  const std::int64_t seq = stamp.seq;
  if (seq % 50 == 0) jitter = static_cast<std::int64_t>(2e5 * random.Normal()) / 1000 * 1000;
  stamp.utc.ns += jitter;
  stamp.temperature = 20 + 0.25F * static_cast<float>(seq / 730);
  stamp.gyro_saturated = seq > NumberAt(120) && seq < NumberAt(120) + 3;
  if (seq % 4711 == 17) sample.w_IT_T.x() += 0.02;
  if (seq % 6101 == 18) sample.f_T.y() -= 3;
  if (seq >= NumberAt(130) && seq < NumberAt(130) + 37) return false;
  if (seq >= NumberAt(150)) stamp.tool_time.ns += 3'000'000'000;
  if (seq >= NumberAt(190)) {
    stamp.session += 1;
    stamp.seq -= NumberAt(190);
    stamp.tool_time.ns -= 150'000'000'000;
  }
  return true;
}

std::vector<SimulatedStep> Sent(const Simulation& simulation) {
  std::vector<SimulatedStep> steps;
  Simulator simulator(simulation);
  Random random(2);
  std::int64_t jitter = 0;
  for (SimulatedStep step; simulator.Next(step);) {
    auto* sample = std::get_if<ImuSample>(&step);
    if (sample == nullptr || Spoil(*sample, jitter, random)) steps.push_back(step);
  }
  return steps;
}

void PushOperations(const Simulation& simulation, Surveyor& surveyor) {
  const UtcTime begin = simulation.streams.begin_utc;
  ToolMode mode;
  mode.utc = begin + Duration::Seconds(45.0007);
  mode.index_position = 1;
  surveyor.Push(mode);
  Command command;
  command.kind = Command::Kind::kTakeStation;
  command.utc = begin + Duration::Seconds(111.1111);
  command.command_id = 1;
  surveyor.Push(command);
  Event event;
  event.kind = Event::Kind::kDepthRezero;
  event.utc = begin + Duration::Seconds(140.0303);
  event.has_value = true;
  event.value_m = 30;
  surveyor.Push(event);
  event.kind = Event::Kind::kRunBegin;
  event.utc = begin + Duration::Seconds(240.0505);
  surveyor.Push(event);
}

std::string TextOf(const Survey& survey) {
  std::string text = survey.unusable;
  for (const Station& s : survey.passes) {
    text += fmt::format("{} {} {} {:a} {:a} {:a} {:a} {:a} {:a} {}\n", s.run, s.utc.ns,
                        static_cast<int>(s.kind), s.md, s.inclination, s.azimuth, s.toolface,
                        s.cov_md_inc_azi(2, 2), s.p_WT_W.x(), static_cast<int>(s.quality));
  }
  for (const Check& c : survey.checks) {
    text +=
        fmt::format("{} {} {:a} {:a}\n", c.code, c.run, c.value.value_or(0), c.sigma.value_or(0));
  }
  for (const RunSummary& r : survey.runs) {
    text +=
        fmt::format("{} {} {} {} {} {} {} {} {} {:a} {:a} {} {}\n", r.run, r.samples,
                    r.samples_lost, r.samples_gyro_mended, r.samples_accel_mended,
                    r.samples_gyro_saturated, r.samples_aliased, r.clock_jumps, r.samples_unsynced,
                    r.temperature_min, r.temperature_max, r.begin.ns, r.end.ns);
  }
  return text;
}

/// Everything told and made, of samples that come `batch` at a time.
std::string Surveyed(const Simulation& simulation, const Job& job,
                     const std::vector<SimulatedStep>& steps, std::size_t batch) {
  testing::CollectingSink sink;
  Surveyor surveyor(job, sink);
  PushOperations(simulation, surveyor);
  std::vector<ImuSample> samples;
  for (const SimulatedStep& step : steps) {
    const auto* sample = std::get_if<ImuSample>(&step);
    if (const auto* mark = std::get_if<DepthMark>(&step)) surveyor.Push(*mark);
    if (sample == nullptr) continue;
    samples.push_back(*sample);
    if (samples.size() < batch) continue;
    surveyor.Push(std::span<const ImuSample>(std::exchange(samples, {})));
  }
  surveyor.Push(std::span<const ImuSample>(samples));
  surveyor.Finish();
  std::string text;
  for (const Station& s : sink.stations) {
    text +=
        fmt::format("{} {} {:a} {:a} {:a}\n", s.revision, s.utc.ns, s.md, s.inclination, s.azimuth);
  }
  for (const Fault& fault : sink.faults) text += fault.text + "\n";
  return text + TextOf(surveyor.Current(simulation.streams.tool));
}

TEST(Blocks, SayWhatTheirSamplesSayOneByOne) {
  const Simulation simulation = SimulationOf(HoleOfBlocks());
  const std::vector<SimulatedStep> steps = Sent(simulation);
  // One by one no block has more than one sample, and each goes the long way.
  const std::string one = Surveyed(simulation, JobOf(HoleOfBlocks()), steps, 1);
  EXPECT_NE(one.find("impossible beside their neighbours"), std::string::npos);
  EXPECT_NE(one.find("the clock jumps before"), std::string::npos);
  EXPECT_NE(one.find("are missing"), std::string::npos);
  EXPECT_NE(one.find("depth_jump"), std::string::npos);
  for (const std::size_t batch : {7u, 64u, 500u, 3000u}) {
    EXPECT_EQ(Surveyed(simulation, JobOf(HoleOfBlocks()), steps, batch), one) << batch;
  }
}

}  // namespace
}  // namespace wellgyro

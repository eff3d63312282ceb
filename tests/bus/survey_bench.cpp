// Log to stations: how fast, and where the time goes. Counters are samples a second.
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <benchmark/benchmark.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/bus/decode.h"
#include "wellgyro/bus/encode.h"
#include "wellgyro/bus/log_reader.h"
#include "wellgyro/bus/log_writer.h"
#include "wellgyro/bus/surveyor_listener.h"
#include "wellgyro/io/run_file.h"
#include "wellgyro/simulate/sample_batcher.h"
#include "wellgyro/simulate/simulator.h"

#include "support/scratch.h"

namespace wellgyro {
namespace {

Simulation LongRun(double imu_hz) {
  Simulation simulation;
  simulation.seed = 3;
  simulation.well.end_md = 2000;
  simulation.well.inclination.start = FromDegrees(35);
  simulation.well.azimuth.start = FromDegrees(70);
  simulation.earth.latitude = FromDegrees(57);
  simulation.tool.errors.gyro_noise.angle_random_walk = 0.01 * units::kDegPerSqrtHour;
  simulation.tool.errors.accel_noise = 5e-5 * units::kStandardGravity;
  RunStop stop;
  stop.seconds = 90;
  RunMove move;
  move.speed = 1;
  // As many samples at every rate.
  move.to_md = 2e6 / imu_hz - 180;
  move.roll.rate = kTwoPi / 60;
  simulation.run.steps = {stop, move, stop};
  simulation.streams.imu_hz = imu_hz;
  simulation.streams.batch = 100;
  simulation.streams.depth_hz = 10;
  return simulation;
}

Job TheJob() {
  Job job;
  job.well.latitude = FromDegrees(57);
  job.noise.angle_random_walk = 0.01 * units::kDegPerSqrtHour;
  job.errors.accel_noise = 5e-5 * units::kStandardGravity;
  job.stations.every = 10;
  return job;
}

class Log {
 public:
  explicit Log(double imu_hz) {
    const Simulation simulation = LongRun(imu_hz);
    const Channels channels;
    auto writer = LogWriter::Open(path());
    Simulator simulator(simulation);
    SampleBatcher batcher(simulation.streams, simulation.seed);
    SampleBatch batch;
    std::vector<std::byte> bytes;
    const auto write = [&](const std::string& channel) {
      static_cast<void>(writer->Write(channel, bytes, 0));
    };
    SimulatedStep step;
    while (simulator.Next(step)) {
      if (const auto* sample = std::get_if<ImuSample>(&step)) {
        ++samples_;
        if (!batcher.Push(*sample, batch)) continue;
        Encode(std::span<const ImuSample>(batch.samples), bytes);
        write(channels.imu);
      } else if (const auto* mark = std::get_if<DepthMark>(&step)) {
        Encode(*mark, bytes);
        write(channels.depth);
      }
    }
  }
  std::string path() const { return (folder_.path() / "run.lcm").string(); }
  std::int64_t samples() const { return samples_; }

  /// One log for each rate, made once.
  static const Log& At(double imu_hz) {
    static const Log slow(1'000), fast(10'000);
    return imu_hz > 5'000 ? fast : slow;
  }

 private:
  support::Scratch folder_;
  std::int64_t samples_ = 0;
};

template <class Take>
void ReadLog(benchmark::State& state, Take take) {
  const Log& log = Log::At(static_cast<double>(state.range(0)));
  for (auto unused : state) {
    auto reader = LogReader::Open(log.path());
    LogEvent event;
    while (reader->Next(event)) take(event);
  }
  state.SetItemsProcessed(state.iterations() * log.samples());
}

void Read(benchmark::State& state) {
  std::size_t bytes = 0;
  ReadLog(state, [&](const LogEvent& event) {
    bytes += event.data.size() + std::to_integer<std::size_t>(event.data.front());
  });
  benchmark::DoNotOptimize(bytes);
}
BENCHMARK(Read)->Arg(1'000)->Arg(10'000)->Unit(benchmark::kMillisecond);

void ReadAndDecode(benchmark::State& state) {
  Listener deaf;
  Feed feed({}, deaf);
  ReadLog(state, [&](const LogEvent& event) { feed.Take(event.channel, event.data); });
}
BENCHMARK(ReadAndDecode)->Arg(1'000)->Arg(10'000)->Unit(benchmark::kMillisecond);

/// The whole: reading, decoding, surveying, and the text of the files.
void LogToStations(benchmark::State& state) {
  const Log& log = Log::At(static_cast<double>(state.range(0)));
  for (auto unused : state) {
    Sink sink;
    Surveyor surveyor(TheJob(), sink);
    SurveyorListener listener(surveyor, sink);
    Feed feed({}, listener);
    auto reader = LogReader::Open(log.path());
    LogEvent event;
    while (reader->Next(event)) feed.Take(event.channel, event.data);
    surveyor.Finish();
    const auto files = ResultFiles({}, {}, TheJob(), surveyor.Current(0));
    benchmark::DoNotOptimize(files.size());
  }
  state.SetItemsProcessed(state.iterations() * log.samples());
}
BENCHMARK(LogToStations)->Arg(1'000)->Arg(10'000)->Unit(benchmark::kMillisecond);

void TextOfTheFiles(benchmark::State& state) {
  const Log& log = Log::At(static_cast<double>(state.range(0)));
  Sink sink;
  Surveyor surveyor(TheJob(), sink);
  SurveyorListener listener(surveyor, sink);
  Feed feed({}, listener);
  auto reader = LogReader::Open(log.path());
  LogEvent event;
  while (reader->Next(event)) feed.Take(event.channel, event.data);
  surveyor.Finish();
  for (auto unused : state) {
    const auto files = ResultFiles({}, {}, TheJob(), surveyor.Current(0));
    benchmark::DoNotOptimize(files.size());
  }
  state.SetItemsProcessed(state.iterations() * log.samples());
}
BENCHMARK(TextOfTheFiles)->Arg(1'000)->Arg(10'000)->Unit(benchmark::kMillisecond);

/// A hundred tools at 10 Hz in batches of 10, and one: the load must be linear in the streams.
void Tools(benchmark::State& state) {
  const auto tools = static_cast<std::int32_t>(state.range(0));
  constexpr int kSeconds = 600;
  for (auto unused : state) {
    Sink sink;
    Surveyor surveyor(TheJob(), sink);
    std::vector<ImuSample> batch(10);
    for (int second = 0; second < kSeconds; ++second) {
      DepthMark mark;
      mark.utc = UtcTime{(1'700'000'000 + second) * 1'000'000'000LL};
      mark.seq = second;
      mark.md = second;
      surveyor.Push(mark);
      for (std::int32_t tool = 0; tool < tools; ++tool) {
        for (int k = 0; k < 10; ++k) {
          ImuSample& sample = batch[static_cast<std::size_t>(k)];
          sample.stamp.tool = tool;
          sample.stamp.seq = second * 10 + k;
          sample.stamp.period_ns = 100'000'000;
          sample.stamp.tool_time = ToolTime{sample.stamp.seq * 100'000'000};
          sample.stamp.utc = mark.utc + Duration{k * 100'000'000};
          sample.f_T = {4.9, 0, -8.5};
          sample.w_IT_T = {1e-5, 2e-5, 0};
        }
        surveyor.Push(std::span<const ImuSample>(batch));
      }
    }
    benchmark::DoNotOptimize(surveyor.tally().received);
  }
  state.SetItemsProcessed(state.iterations() * kSeconds * 10 * tools);
}
BENCHMARK(Tools)->Arg(1)->Arg(50)->Arg(100)->Arg(200)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace wellgyro

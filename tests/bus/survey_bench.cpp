// Log to stations: how fast, and where the time goes. Counters are samples a second.
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "wellgyro/bus/decode.h"
#include "wellgyro/bus/log_reader.h"
#include "wellgyro/bus/log_writer.h"
#include "wellgyro/bus/survey_log.h"
#include "wellgyro/io/result/run_file.h"
#include "wellgyro/simulate/simulator.h"

#include "bus/simulated_messages.h"
#include "support/scratch.h"
#include "support/small_hole.h"

namespace wellgyro {
namespace {

/// As many samples at every rate.
testing::SmallHole LongHole(double imu_hz) {
  return {.inclination_deg = 35,
          .azimuth_deg = 70,
          .latitude_deg = 57,
          .to_md = 2e6 / imu_hz - 180,
          .rpm = 1,
          .imu_hz = imu_hz,
          .depth_hz = 10,
          .walk = 0.01,
          .accel_noise_g = 5e-5,
          .stations_every = 10};
}

Job TheJob(AttitudeSpec::Order order) {
  Job job = JobOf(LongHole(1'000));
  job.attitude.order = order;
  return job;
}

class Log {
 public:
  explicit Log(double imu_hz) {
    Simulation simulation = SimulationOf(LongHole(imu_hz));
    simulation.seed = 3;
    simulation.streams.batch = 100;
    samples_ = Simulator(simulation).sample_count();
    auto writer = LogWriter::Open(path());
    test::ForEachMessage(simulation, [&writer](const std::string& channel,
                                               std::span<const std::byte> bytes, std::int64_t) {
      static_cast<void>(writer->Write(channel, bytes, 0));
    });
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

/// Time spent in the parts of the way; looking at the clock for every message costs 1 % of it.
class Stopwatch {
 public:
  /// What has passed since the last call is `part`'s.
  void Lap(double& part) {
    const auto now = std::chrono::steady_clock::now();
    part += std::chrono::duration<double>(now - last_).count();
    last_ = now;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

struct Shares {
  double reading = 0, decoding = 0, surveying = 0, writing = 0;  ///< [s]
};

/// Stands between decoding and surveying.
class TimedListener : public SurveyorListener {
 public:
  TimedListener(Surveyor& surveyor, Sink& sink, Stopwatch& watch, Shares& shares)
      : SurveyorListener(surveyor, sink), watch_(watch), shares_(shares) {}
  void OnImu(std::span<const ImuSample> batch) override {
    watch_.Lap(shares_.decoding);
    SurveyorListener::OnImu(batch);
    watch_.Lap(shares_.surveying);
  }
  void OnDepth(const DepthMark& mark) override {
    watch_.Lap(shares_.decoding);
    SurveyorListener::OnDepth(mark);
    watch_.Lap(shares_.surveying);
  }

 private:
  Stopwatch& watch_;
  Shares& shares_;
};

/// The whole: reading, decoding, surveying, and the text of the files, with the share of each.
void LogToStations(benchmark::State& state, AttitudeSpec::Order order) {
  const Log& log = Log::At(static_cast<double>(state.range(0)));
  const Job job = TheJob(order);
  Shares shares;
  for (auto unused : state) {
    Sink sink;
    Surveyor surveyor(job, sink);
    Stopwatch watch;
    TimedListener listener(surveyor, sink, watch, shares);
    Feed feed({}, listener);
    auto reader = LogReader::Open(log.path());
    LogEvent event;
    while (reader->Next(event)) {
      watch.Lap(shares.reading);
      feed.Take(event.channel, event.data);
      watch.Lap(shares.decoding);
    }
    surveyor.Finish();
    watch.Lap(shares.surveying);
    const auto files = ResultFiles({}, {}, job, surveyor.Current(0));
    benchmark::DoNotOptimize(files.size());
    watch.Lap(shares.writing);
  }
  state.SetItemsProcessed(state.iterations() * log.samples());
  const double percent =
      100 / (shares.reading + shares.decoding + shares.surveying + shares.writing);
  state.counters["reading_%"] = shares.reading * percent;
  state.counters["decoding_%"] = shares.decoding * percent;
  state.counters["surveying_%"] = shares.surveying * percent;
  state.counters["writing_%"] = shares.writing * percent;
}
BENCHMARK_CAPTURE(LogToStations, second_order, AttitudeSpec::Order::kSecond)
    ->Arg(1'000)
    ->Arg(10'000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(LogToStations, third_order, AttitudeSpec::Order::kThird)
    ->Arg(1'000)
    ->Arg(10'000)
    ->Unit(benchmark::kMillisecond);

/// A hundred tools at 10 Hz in batches of 10, and one: the load must be linear in the streams.
void Tools(benchmark::State& state) {
  const auto tools = static_cast<std::int32_t>(state.range(0));
  constexpr int kSeconds = 600;
  for (auto unused : state) {
    Sink sink;
    Surveyor surveyor(TheJob(AttitudeSpec::Order::kThird), sink);
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

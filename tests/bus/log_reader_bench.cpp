#include <stdexcept>

#include <benchmark/benchmark.h>
#include <lcm/lcm-cpp.hpp>

#include "wellgyro/bus/decode.h"
#include "wellgyro/bus/encode.h"
#include "wellgyro/bus/feed.h"
#include "wellgyro/bus/log_reader.h"
#include "wellgyro/bus/log_writer.h"

#include "support/scratch.h"

// Reading logs, ours beside liblcm's in one run: BM_Log* / BM_LiblcmLog* give the ratio that is to
// be 10 or more. BM_FeedLog/100 reads and decodes batches: 30 M samples/s or more.
namespace wellgyro {
namespace {

/// A log of imu batches of `n` samples each (n = 1: 108 bytes of data an event).
class Log {
 public:
  Log(int n, int events) : path_((scratch_.path() / "bench.lcm").string()) {
    std::vector<ImuSample> batch(static_cast<std::size_t>(n));
    std::vector<std::byte> bytes;
    auto writer = LogWriter::Open(path_, IfExists::kReplace);
    if (!writer) throw std::runtime_error(writer.fault().text);
    for (int i = 0; i < events; ++i) {
      for (int k = 0; k < n; ++k) {
        ImuSample& s = batch[static_cast<std::size_t>(k)];
        s.stamp.seq = std::int64_t{i} * n + k;
        s.stamp.period_ns = 10'000'000;
        s.stamp.tool_time.ns = s.stamp.seq * s.stamp.period_ns;
        s.w_IT_T = {1e-5 * k, -3e-5, 0};
        s.f_T = {0.1, -0.2, -9.8 + 1e-6 * i};
      }
      Encode(batch, bytes);
      if (writer->Write("WELLGYRO_IMU", bytes, i)) throw std::runtime_error("disk full");
    }
    if (writer->Close()) throw std::runtime_error("disk full");
  }
  const std::string& path() const { return path_; }

 private:
  support::Scratch scratch_;
  std::string path_;
};

constexpr int kEvents = 200'000;

void BM_Log(benchmark::State& state) {
  const Log log(1, kEvents);
  for (auto _ : state) {
    auto reader = LogReader::Open(log.path());
    LogEvent event;
    std::int64_t sum = 0;
    while (reader->Next(event)) sum += std::to_integer<int>(event.data[8]) + event.number;
    benchmark::DoNotOptimize(sum);
  }
  state.SetItemsProcessed(state.iterations() * kEvents);
}
BENCHMARK(BM_Log)->Unit(benchmark::kMillisecond);

void BM_LiblcmLog(benchmark::State& state) {
  const Log log(1, kEvents);
  for (auto _ : state) {
    lcm::LogFile file(log.path(), "r");
    std::int64_t sum = 0;
    while (const lcm::LogEvent* event = file.readNextEvent()) {
      sum += static_cast<const char*>(event->data)[8] + event->eventnum;
    }
    benchmark::DoNotOptimize(sum);
  }
  state.SetItemsProcessed(state.iterations() * kEvents);
}
BENCHMARK(BM_LiblcmLog)->Unit(benchmark::kMillisecond);

struct Sum : Listener {
  void OnImu(std::span<const ImuSample> batch) override {
    for (const ImuSample& s : batch) sum += s.f_T[2];
    samples += static_cast<std::int64_t>(batch.size());
  }
  double sum = 0;
  std::int64_t samples = 0;
};

void BM_FeedLog(benchmark::State& state) {
  const auto n = static_cast<int>(state.range(0));
  const Log log(n, kEvents / n * 10);
  std::int64_t samples = 0;
  for (auto _ : state) {
    Sum sum;
    Feed feed({}, sum);
    auto reader = LogReader::Open(log.path());
    LogEvent event;
    while (reader->Next(event)) feed.Take(event.channel, event.data, event.data_offset);
    benchmark::DoNotOptimize(sum.sum);
    samples += sum.samples;
  }
  state.SetItemsProcessed(samples);
}
BENCHMARK(BM_FeedLog)->Arg(10)->Arg(100)->Unit(benchmark::kMillisecond);

void BM_DecodeImuBatch(benchmark::State& state) {
  std::vector<ImuSample> batch(100);
  for (std::size_t k = 0; k < batch.size(); ++k) {
    batch[k].stamp.seq = static_cast<std::int64_t>(k);
    batch[k].stamp.period_ns = 1;
    batch[k].stamp.tool_time.ns = static_cast<std::int64_t>(k);
  }
  std::vector<std::byte> bytes;
  Encode(batch, bytes);
  std::vector<ImuSample> buffer;
  for (auto _ : state) {
    auto samples = DecodeImuBatch(bytes, buffer, "WELLGYRO_IMU");
    benchmark::DoNotOptimize(samples->data());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * 100);
}
BENCHMARK(BM_DecodeImuBatch);

}  // namespace
}  // namespace wellgyro

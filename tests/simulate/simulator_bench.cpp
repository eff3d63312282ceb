#include <benchmark/benchmark.h>

#include "wellgyro/simulate/simulator.h"

#include "cases.h"

namespace wellgyro {
namespace {

// A run of an hour and a half, sample by sample.
void Play(benchmark::State& state) {
  Simulation s = WeavingRun();
  s.streams.imu_hz = static_cast<double>(state.range(0));
  if (state.range(1) != 0) {
    s.tool.has_gz = true;
    s.tool.errors.gyro_noise = {.quantization = 1e-7,
                                .angle_random_walk = 1e-6,
                                .bias_instability = 1e-7,
                                .rate_random_walk = 1e-9,
                                .rate_ramp = 1e-11,
                                .bias_instability_correlation_time = 600};
    s.tool.errors.accel_noise = 1e-4;
    s.tool.errors.time_skew = 1e-3;
  }
  std::int64_t samples = 0;
  for (auto _ : state) {
    Simulator simulator(s);
    SimulatedStep step;
    while (simulator.Next(step)) benchmark::DoNotOptimize(step);
    samples += simulator.sample_count();
  }
  state.SetItemsProcessed(samples);
}
BENCHMARK(Play)
    ->ArgNames({"hz", "errors"})
    ->Args({100, 0})
    ->Args({100, 1})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace wellgyro

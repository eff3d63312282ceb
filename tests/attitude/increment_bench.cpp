#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <benchmark/benchmark.h>

#include "wellgyro/attitude/increment_builder.h"

namespace wellgyro {
namespace {

// A tool that turns at 3 rpm in a hole of 60 deg, with some noise.
std::vector<ImuSample> Samples(double rate_hz) {
  std::vector<ImuSample> samples(200'000);
  std::uint32_t state = 1;
  const auto noise = [&state] {
    state = state * 1664525u + 1013904223u;
    return static_cast<double>(state) / 4294967296. - 0.5;
  };
  for (std::size_t k = 0; k < samples.size(); ++k) {
    ImuSample& s = samples[k];
    const double roll = 0.314 * static_cast<double>(k) / rate_hz;
    s.w_IT_T << 1e-3 * std::cos(roll) + 1e-6 * noise(), -1e-3 * std::sin(roll), 0;
    s.f_T << 8.5 * std::cos(roll) + 1e-3 * noise(), -8.5 * std::sin(roll) + 1e-3 * noise(), -4.9;
    s.stamp.period_ns = static_cast<std::int32_t>(std::lround(1e9 / rate_hz));
    s.stamp.seq = static_cast<std::int64_t>(k);
    s.stamp.tool_time.ns = s.stamp.seq * s.stamp.period_ns;
  }
  return samples;
}

// The yardstick: what any attitude from three gyro axes must do at least, q * exp(w dt / 2) by
// series, one chain, no Earth, no store.
void QuaternionChain(benchmark::State& state) {
  const std::vector<ImuSample> samples = Samples(10'000);
  double q0 = 1, q1 = 0, q2 = 0, q3 = 0;
  for (auto _ : state) {
    for (const ImuSample& s : samples) {
      const double half = 5e-5;
      const double x = s.w_IT_T.x() * half, y = s.w_IT_T.y() * half, z = s.w_IT_T.z() * half;
      const double n = x * x + y * y + z * z;
      const double c = 1 - n * (0.5 - n * (1. / 24)), k = 1 - n * (1. / 6 - n * (1. / 120));
      const double a = k * x, b = k * y, d = k * z;
      const double r0 = q0 * c - q1 * a - q2 * b - q3 * d;
      const double r1 = q0 * a + q1 * c + q2 * d - q3 * b;
      const double r2 = q0 * b - q1 * d + q2 * c + q3 * a;
      const double r3 = q0 * d + q1 * b - q2 * a + q3 * c;
      q0 = r0, q1 = r1, q2 = r2, q3 = r3;
    }
    benchmark::DoNotOptimize(q0);
    benchmark::DoNotOptimize(q3);
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(samples.size()));
}
BENCHMARK(QuaternionChain);

// From sample to increments of a second, cuts and all.
void Increments(benchmark::State& state, IncrementOptions::Order order) {
  const auto rate = state.range(0);
  const std::vector<ImuSample> samples = Samples(static_cast<double>(rate));
  IncrementOptions options;
  options.order = order;
  options.accel_noise = 5e-4;
  for (auto _ : state) {
    IncrementBuilder builder(options);
    double seconds = 0;
    for (const ImuSample& s : samples) {
      builder.Push(s, false);
      if ((s.stamp.seq + 1) % rate == 0) builder.Cut();
      while (builder.Ready()) seconds += builder.Pop().seconds;
    }
    builder.Flush();
    benchmark::DoNotOptimize(seconds);
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(samples.size()));
}
BENCHMARK_CAPTURE(Increments, second_order, IncrementOptions::kSecond)
    ->ArgName("hz")
    ->Arg(100)
    ->Arg(1000)
    ->Arg(10'000);
BENCHMARK_CAPTURE(Increments, third_order, IncrementOptions::kThird)
    ->ArgName("hz")
    ->Arg(100)
    ->Arg(1000)
    ->Arg(10'000);

}  // namespace
}  // namespace wellgyro

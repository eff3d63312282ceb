// The exact octave analysis beside a plain read of the same array, in one run:
//   cmake --build --preset release --target bench-noise && .build/release/tests/noise/bench-noise
#include <array>
#include <vector>

#include <benchmark/benchmark.h>

#include "wellgyro/math/random.h"
#include "wellgyro/noise/allan_stream.h"
#include "wellgyro/noise/allan_variance.h"

namespace wellgyro {
namespace {

const std::vector<double>& Log(std::int64_t samples) {
  static std::vector<double> rate;
  if (static_cast<std::int64_t>(rate.size()) != samples) {
    Random random(1);
    rate.resize(static_cast<std::size_t>(samples));
    for (auto& y : rate) y = 1e3 + random.Normal();
  }
  return rate;
}

void Count(benchmark::State& state) {
  state.counters["per_sample"] = benchmark::Counter(
      static_cast<double>(state.range(0)),
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

// As anybody writes it: one sum.
void PlainRead(benchmark::State& state) {
  const auto& rate = Log(state.range(0));
  for (auto _ : state) {
    double sum = 0;
    for (const double y : rate) sum += y;
    benchmark::DoNotOptimize(sum);
  }
  Count(state);
}

// As fast as memory gives it: sixteen sums, so that no addition waits for another.
void FastestRead(benchmark::State& state) {
  const auto& rate = Log(state.range(0));
  for (auto _ : state) {
    std::array<double, 16> sums{};
    for (std::size_t i = 0; i + 16 <= rate.size(); i += 16) {
      for (std::size_t j = 0; j < 16; ++j) sums[j] += rate[i + j];
    }
    benchmark::DoNotOptimize(sums);
  }
  Count(state);
}

void ExactOctaves(benchmark::State& state) {
  const auto& rate = Log(state.range(0));
  const auto factors = OctaveFactors(state.range(0));
  for (auto _ : state) {
    auto result = AllanVariance(rate, 0.01, factors);
    benchmark::DoNotOptimize(result);
  }
  Count(state);
}

void StreamOctaves(benchmark::State& state) {
  const auto& rate = Log(state.range(0));
  for (auto _ : state) {
    AllanStream stream(0.01);
    stream.Push(rate);
    auto result = stream.Result();
    benchmark::DoNotOptimize(result);
  }
  Count(state);
}

BENCHMARK(PlainRead)->Arg(10'000'000)->Unit(benchmark::kMillisecond);
BENCHMARK(FastestRead)->Arg(10'000'000)->Unit(benchmark::kMillisecond);
BENCHMARK(ExactOctaves)->Arg(1'000'000)->Arg(10'000'000)->Unit(benchmark::kMillisecond);
BENCHMARK(StreamOctaves)->Arg(10'000'000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace wellgyro

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <benchmark/benchmark.h>

#include "wellgyro/trajectory/minimum_curvature.h"

namespace wellgyro {
namespace {

void StationsPerSecond(benchmark::State& state) {
  const auto n = static_cast<std::size_t>(state.range(0));
  std::vector<double> md(n), inclination(n), azimuth(n), severity(n);
  std::vector<Eigen::Vector3d> position(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double s = 0.1 * static_cast<double>(i);
    md[i] = s;
    inclination[i] = 0.8 + 0.6 * std::sin(s * 1e-3);
    azimuth[i] = std::fmod(s * 3e-3, kTwoPi);
  }
  for (auto _ : state) {
    MinimumCurvature(md, inclination, azimuth, {0, 0, 0}, position, severity);
    benchmark::DoNotOptimize(position.data());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(n));
}
BENCHMARK(StationsPerSecond)->Arg(1'000)->Arg(100'000);

}  // namespace
}  // namespace wellgyro

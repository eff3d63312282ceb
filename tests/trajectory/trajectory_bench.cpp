#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <benchmark/benchmark.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/trajectory/trajectory.h"

namespace wellgyro {
namespace {

struct Survey {
  explicit Survey(std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) {
      const double s = 0.1 * static_cast<double>(i);
      md.push_back(s);
      inclination.push_back(0.8 + 0.6 * std::sin(s * 1e-3));
      azimuth.push_back(std::fmod(s * 3e-3, kTwoPi));
    }
  }
  std::vector<double> md, inclination, azimuth;
};

void Made(benchmark::State& state) {
  const Survey s(static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) {
    benchmark::DoNotOptimize(Trajectory(s.md, s.inclination, s.azimuth, {0, 0, 0}));
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(Made)->Arg(100'000);

// A walk over the whole well in steps that no station repeats.
void ByMd(benchmark::State& state) {
  const Survey s(static_cast<std::size_t>(state.range(0)));
  const Trajectory well(s.md, s.inclination, s.azimuth, {0, 0, 0});
  double u = 0;
  for (auto _ : state) {
    u = std::fmod(u + 0.6180339887, 1.0);
    benchmark::DoNotOptimize(well.AtMd(u * well.md_end()));
  }
}
BENCHMARK(ByMd)->Arg(1'000)->Arg(100'000);

void ByTvd(benchmark::State& state) {
  const Survey s(static_cast<std::size_t>(state.range(0)));
  const Trajectory well(s.md, s.inclination, s.azimuth, {0, 0, 0});
  const double deep = well.station(well.size() - 1).position_W.z();
  double u = 0;
  for (auto _ : state) {
    u = std::fmod(u + 0.6180339887, 1.0);
    benchmark::DoNotOptimize(well.MdAtTvd(u * deep));
  }
}
BENCHMARK(ByTvd)->Arg(1'000)->Arg(100'000);

}  // namespace
}  // namespace wellgyro

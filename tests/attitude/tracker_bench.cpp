#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <benchmark/benchmark.h>

#include "wellgyro/attitude/tracker.h"
#include "wellgyro/base/angle.h"

#include "attitude/tracker_truth.h"

namespace wellgyro {
namespace {

truth::Path TurningTool() {
  return [](double t) {
    truth::Motion m;
    m.inclination = 0.7 + 0.03 * std::sin(0.01 * t);
    m.inclination_rate = 3e-4 * std::cos(0.01 * t);
    m.azimuth = 1 + 1e-3 * t;
    m.azimuth_rate = 1e-3;
    m.toolface = 0.3 * t;
    m.toolface_rate = 0.3;
    m.md = 0.6 * t;
    m.speed = 0.6;
    return m;
  };
}

const std::vector<ImuSample>& Samples() {
  static const std::vector<ImuSample> kSamples = [] {
    const Site site = truth::SiteOf(1);
    const truth::Path path = TurningTool();
    truth::Sensors sensors;
    sensors.has_gz = true;
    std::vector<ImuSample> samples;
    for (std::int64_t k = 0; k < 10'000; ++k) {
      samples.push_back(truth::SampleAt(path, sensors, site, k, 100));
    }
    return samples;
  }();
  return kSamples;
}

// The yardstick: what any attitude from three gyro axes must do at least, q * exp(w dt / 2) by
// series, one chain, no Earth, no store.
void QuaternionChain(benchmark::State& state) {
  const std::vector<ImuSample>& samples = Samples();
  double q0 = 1, q1 = 0, q2 = 0, q3 = 0;
  for (auto _ : state) {
    for (const ImuSample& s : samples) {
      const double half = 0.005;
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

// The same with sin and cos of the library.
void QuaternionChainLibm(benchmark::State& state) {
  const std::vector<ImuSample>& samples = Samples();
  double q0 = 1, q1 = 0, q2 = 0, q3 = 0;
  for (auto _ : state) {
    for (const ImuSample& s : samples) {
      const double half = 0.005;
      const double x = s.w_IT_T.x() * half, y = s.w_IT_T.y() * half, z = s.w_IT_T.z() * half;
      const double n = std::sqrt(x * x + y * y + z * z);
      const double c = std::cos(n), k = n > 0 ? std::sin(n) / n : 1;
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
BENCHMARK(QuaternionChainLibm);

// From the second minute on, when the observer has settled.
void Tracker(benchmark::State& state, TrackerOptions::Order order) {
  std::vector<ImuSample> samples = Samples();
  for (ImuSample& s : samples) s.has_gz = false;
  const Site site = truth::SiteOf(1);
  const AlongHole along{100, 0.6, 0, 0, true};
  TrackerOptions options;
  options.order = order;
  HighSideTracker settled(options);
  settled.SetAzimuth(1.0);
  const std::size_t begin = 5000;
  for (std::size_t k = 0; k < begin; ++k) settled.Push(samples[k], along, site);
  for (auto _ : state) {
    HighSideTracker tracker = settled;
    for (std::size_t k = begin; k < samples.size(); ++k) tracker.Push(samples[k], along, site);
    Knot knot = tracker.CutKnot();
    benchmark::DoNotOptimize(knot);
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(samples.size() - begin));
}
BENCHMARK_CAPTURE(Tracker, second_order, TrackerOptions::kSecond);
BENCHMARK_CAPTURE(Tracker, third_order, TrackerOptions::kThird);

void CutKnot(benchmark::State& state) {
  HighSideTracker tracker({});
  const Site site = truth::SiteOf(1);
  for (const ImuSample& s : Samples()) tracker.Push(s, {100, 0.6, 0, 0, true}, site);
  for (auto _ : state) {
    Knot knot = tracker.CutKnot();
    benchmark::DoNotOptimize(knot);
  }
}
BENCHMARK(CutKnot);

}  // namespace
}  // namespace wellgyro

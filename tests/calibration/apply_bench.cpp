#include <span>
#include <vector>

#include <benchmark/benchmark.h>

#include "wellgyro/calibration/apply.h"
#include "wellgyro/simulate/raw_counts.h"

#include "calibration/random_tool.h"

namespace wellgyro {
namespace {

constexpr int kBatch = 100;

std::vector<RawSample> Counts(const ToolCalibration& tool) {
  Random random(2);
  RawCounter counter(tool);
  std::vector<RawSample> raw;
  for (int i = 0; i < kBatch; ++i)
    raw.push_back(counter.Count(test::RandomSample(random, true), 80));
  return raw;
}

struct Bare {
  Bare() {
    for (int g = 0; g < 3; ++g) {
      A[g] = Eigen::Matrix3d::Random();
      b[g] = Eigen::Vector3d::Random();
    }
  }
  void Apply(std::span<const RawSample> raw, std::vector<ImuSample>& out) const {
    for (std::size_t i = 0; i < raw.size(); ++i) {
      const auto& n = raw[i].counts;
      const auto at = [&](std::size_t g) {
        return Eigen::Vector3d(n[3 * g], n[3 * g + 1], n[3 * g + 2]);
      };
      out[i].stamp = raw[i].stamp;
      out[i].w_IT_T = A[0] * at(0) + b[0];
      out[i].f_T = A[1] * at(1) + b[1];
      out[i].b_T = A[2] * at(2) + b[2];
    }
  }
  Eigen::Matrix3d A[3];
  Eigen::Vector3d b[3];
};

// The measure: three bare 3x3 multiply-adds a sample over the same arrays.
void BareMultiplyAdd(benchmark::State& state) {
  const std::vector<RawSample> raw = Counts(test::RandomTool(1, {}));
  std::vector<ImuSample> out(raw.size());
  const Bare bare;
  for (auto _ : state) {
    bare.Apply(raw, out);
    benchmark::DoNotOptimize(out.data());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * kBatch);
}
BENCHMARK(BareMultiplyAdd);

void Apply(benchmark::State& state, const test::ToolShape& shape) {
  const ToolCalibration tool = test::RandomTool(1, shape);
  const std::vector<RawSample> raw = Counts(tool);
  std::vector<ImuSample> out(raw.size());
  SampleCalibrator calibrator(tool);
  for (auto _ : state) {
    calibrator.Apply(raw, out);
    benchmark::DoNotOptimize(out.data());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * kBatch);
}
BENCHMARK_CAPTURE(Apply, linear, test::ToolShape{});
BENCHMARK_CAPTURE(Apply, temperature, test::ToolShape{.temperature = true});
BENCHMARK_CAPTURE(Apply, g_terms, test::ToolShape{.temperature = true, .g_terms = true});
BENCHMARK_CAPTURE(Apply, second_order,
                  test::ToolShape{.temperature = true, .second_order = true, .g_terms = true});

// What a calibration by temperature leaves to be applied (calibrate tool): two rotors of four
// channels with polynomials in temperature, mass unbalance, quadrature, anisoelasticity and
// heating; accelerometers whose second order, 20 ug/g^2, is their own axis's.
ToolCalibration FullTool() {
  ToolCalibration tool = test::RandomTool(1, {.gyro_channels = 4, .temperature = true});
  Random random(3);
  for (std::size_t n = 0; n < 2; ++n) {
    const double M = 1e-3 * random.Normal(), Q = 1e-3 * random.Normal();
    auto& force = tool.gyro.g_dependence[n];
    force(0, 0) = force(1, 1) = M;
    force(0, 1) = Q;
    force(1, 0) = -Q;
    force(3, 0) = force(2, 2) = M;
    force(3, 2) = Q;
    force(2, 0) = -Q;
  }
  const int place[] = {5, 4, 4, 3};
  for (int c = 0; c < 4; ++c) tool.gyro.g_squared(c, place[c]) = 1e-5 * random.Normal();
  // Of sensitivities of 0.3 V per m/s^2.
  for (int c = 0; c < 3; ++c) tool.accel.second_order(c, c) = 20e-6 / 9.8 * 0.3;
  tool.gyro.heating.setConstant(1e-3);
  return tool;
}

// Samples at 100 Hz of a tool that warms by 1 degC a minute, whose thermometer reads anew, with a
// noise of 2 mdegC, with every `each` samples; 0: never.
std::vector<RawSample> Warming(const ToolCalibration& tool, int each) {
  constexpr int kSamples = 100 * kBatch;
  const std::vector<RawSample> counts = Counts(tool);
  Random random(4);
  std::vector<RawSample> raw;
  double temperature = 80;
  for (int i = 0; i < kSamples; ++i) {
    if (each > 0 && i % each == 0) temperature = 80 + 0.01 / 60 * i + 0.002 * random.Normal();
    RawSample sample = counts[static_cast<std::size_t>(i) % counts.size()];
    sample.temperature_raw[1] =
        static_cast<float>(RawTemperature(tool.thermometers[0], temperature));
    raw.push_back(sample);
  }
  return raw;
}

template <class Calibrator>
void Calibrate(benchmark::State& state, std::vector<RawSample> raw, Calibrator&& calibrator) {
  std::vector<ImuSample> out(kBatch);
  std::int64_t now = 0;
  std::size_t at = 0;
  for (auto _ : state) {
    const std::span<RawSample> batch = std::span(raw).subspan(at, kBatch);
    for (RawSample& sample : batch) sample.stamp.tool_time.ns = (now += 10'000'000);
    calibrator.Apply(batch, out);
    at = (at + kBatch) % raw.size();
    benchmark::DoNotOptimize(out.data());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * kBatch);
}

// The measure over as many samples, which the processor's nearest memory does not hold.
void BareOfMany(benchmark::State& state) { Calibrate(state, Warming(FullTool(), 0), Bare()); }
BENCHMARK(BareOfMany);

void Calibrate(benchmark::State& state, const ToolCalibration& tool, int each) {
  Calibrate(state, Warming(tool, each), SampleCalibrator(tool));
}
void FullThermal(benchmark::State& state) {
  Calibrate(state, FullTool(), static_cast<int>(state.range(0)));
}
BENCHMARK(FullThermal)->Arg(0)->Arg(100)->Arg(10)->Arg(1);

// Sensitivities by a straight line in temperature, of a tool that bends no further.
void Straight(benchmark::State& state) {
  ToolCalibration tool = FullTool();
  for (SensorGroup* group : {&tool.gyro, &tool.accel, &tool.mag}) {
    for (std::size_t n = 2; n < SensorGroup::kPowers; ++n) group->sensitivity[n].setZero();
  }
  Calibrate(state, tool, static_cast<int>(state.range(0)));
}
BENCHMARK(Straight)->Arg(100)->Arg(1);

}  // namespace
}  // namespace wellgyro

#include <cmath>
#include <filesystem>
#include <string>

#include <benchmark/benchmark.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/toml/error_model_file.h"
#include "wellgyro/uncertainty/allan_error.h"
#include "wellgyro/uncertainty/propagate.h"

namespace wellgyro {
namespace {

/// A vertical part, a build to 80 deg that turns, and a tangent, `n` stations a metre apart.
std::vector<SurveyPoint> Well(std::int64_t n) {
  std::vector<SurveyPoint> survey;
  double tvd = 0;
  for (std::int64_t k = 0; k < n; ++k) {
    const double u = static_cast<double>(k) / static_cast<double>(n);
    const double inclination = 80 * units::kDeg * std::min(1.0, std::max(0.0, 2 * (u - 0.1)));
    tvd += k > 0 ? std::cos(inclination) : 0;
    survey.push_back({static_cast<double>(k), inclination, 2.5 * u, tvd});
  }
  return survey;
}

void Run(benchmark::State& state, const std::string& name, bool terms) {
  const auto path = std::filesystem::path(WELLGYRO_DATA_DIR) / "models" / (name + ".toml");
  const Result<ErrorModel> model = ReadErrorModelFile(path);
  if (!model) return state.SkipWithError(model.fault().text.c_str());
  const std::vector<SurveyPoint> survey = Well(state.range(0));
  Surroundings place;
  place.latitude = 60 * units::kDeg;
  place.field = 50e-6;
  place.dip = 72 * units::kDeg;
  place.declination = 0;
  PropagateOptions options;
  options.terms = terms;
  for (auto _ : state) {
    const PositionUncertainty result = PropagateErrors(survey, place, *model, options);
    if (result.cov_p_W.size() != survey.size()) return state.SkipWithError("refused");
    benchmark::DoNotOptimize(result.cov_p_W.back());
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
  state.SetComplexityN(state.range(0));
}

void RunAllan(benchmark::State& state) {
  const std::vector<SurveyPoint> survey = Well(state.range(0));
  AllanRun run;
  run.speed = 0.75;
  run.initialise = 15 * units::kDeg;
  run.noise.angle_random_walk = 0.1 * units::kDegPerSqrtHour;
  run.noise.bias_instability = 0.1 * units::kDegPerHour;
  run.noise.bias_instability_correlation_time = 0.5 * units::kHour;
  run.noise.rate_random_walk = 0.1 * units::kDegPerHourSqrtHour;
  run.noise.rate_ramp = 0.1 * units::kDegPerHour2;
  for (auto _ : state) {
    const AllanUncertainty result = AllanErrors(survey, run);
    if (result.refusal) return state.SkipWithError("refused");
    benchmark::DoNotOptimize(result.cov_p_W.back());
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
  state.SetComplexityN(state.range(0));
}

BENCHMARK(RunAllan)->RangeMultiplier(10)->Range(1000, 100000)->Complexity(benchmark::oN);
BENCHMARK_CAPTURE(Run, GyroNsCt, "GYRO-NS-CT", false)
    ->RangeMultiplier(10)
    ->Range(1000, 100000)
    ->Complexity(benchmark::oN);
BENCHMARK_CAPTURE(Run, GyroNsCtEveryTerm, "GYRO-NS-CT", true)
    ->RangeMultiplier(10)
    ->Range(1000, 100000)
    ->Complexity(benchmark::oN);
BENCHMARK_CAPTURE(Run, MwdRev51, "ISCWSA-MWD-Rev5.1", false)->Arg(10000);

}  // namespace
}  // namespace wellgyro

#include <cmath>
#include <vector>

#include <benchmark/benchmark.h>

#include "wellgyro/attitude/along_hole_covariance.h"
#include "wellgyro/attitude/filter.h"
#include "wellgyro/attitude/smoother.h"
#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"

#include "attitude/filter_truth.h"

namespace wellgyro {
namespace {

// Every error the filter can carry: 19 states.
FilterSetup Everything() {
  FilterSetup s = filter_truth::SetupAt(FromDegrees(60));
  s.gyro = {.angle_random_walk = 0.01 * units::kDegPerSqrtHour,
            .bias_instability = 0.05 * units::kDegPerHour,
            .rate_random_walk = 0.05 * units::kDegPerHourSqrtHour,
            .rate_ramp = 0.05 * units::kDegPerHour2,
            .bias_instability_correlation_time = 600};
  s.errors = {.gyro_bias_sigma = 0.1 * units::kDegPerHour,
              .mass_unbalance_sigma = 0.05 * units::kDegPerHourPerG,
              .quadrature_sigma = 0.05 * units::kDegPerHourPerG,
              .gyro_scale_sigma = 3e-4,
              .gyro_misalignment_sigma = 3e-4,
              .accel_bias_sigma = 0.2 * units::kMilliG,
              .roll_offset_sigma = 1e-3,
              .time_skew_sigma = 1e-2,
              .latitude_sigma = 1e-3};
  s.start_azimuth = 1;
  s.start_sigma = 1e-3;
  return s;
}

std::vector<Knot> Hour() {
  filter_truth::Plan plan;
  plan.motion = [](double t) {
    return filter_truth::Pose{0.8 + 0.1 * std::sin(t / 300), 1 + t / 5000, t / 30, 0.5 * t};
  };
  plan.seconds = 3600;
  plan.knot_seconds = 1;
  plan.steps_per_knot = 2;
  return filter_truth::MakeKnots(plan, Everything(), 1).knots;
}

AzimuthFilter Filtered(const std::vector<Knot>& knots) {
  AzimuthFilter filter(Everything());
  for (std::size_t i = 0; i < knots.size(); ++i) {
    filter.Step(knots[i]);
    if (i % 60 == 0) filter.MarkStation();
  }
  return filter;
}

void Filter(benchmark::State& state) {
  const auto knots = Hour();
  for (auto _ : state) benchmark::DoNotOptimize(Filtered(knots).attitude());
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(knots.size()));
}
BENCHMARK(Filter)->Unit(benchmark::kMillisecond);

void SmoothHour(benchmark::State& state) {
  const AzimuthFilter filter = Filtered(Hour());
  for (auto _ : state) benchmark::DoNotOptimize(Smooth(filter.history()));
  state.SetItemsProcessed(state.iterations() * 3600);
}
BENCHMARK(SmoothHour)->Unit(benchmark::kMillisecond);

void SixtyPositions(benchmark::State& state) {
  const AzimuthFilter filter = Filtered(Hour());
  for (auto _ : state) {
    benchmark::DoNotOptimize(CovarianceAlongHole(filter.stations(), TimeAlongHole::kWithDepth,
                                                 Eigen::Matrix3d::Zero(), 0));
  }
  state.SetItemsProcessed(state.iterations() * 60);
}
BENCHMARK(SixtyPositions)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace wellgyro

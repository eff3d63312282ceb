// A field of a thousand offset wells of 300 stations: which of them can come near.
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <benchmark/benchmark.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/survey/wells/separation.h"

namespace wellgyro {
namespace {

struct Known {
  SurveyedWell well;
  PositionUncertainty errors;
};

/// Down, and out at up to 70 deg to any side, from slots on pads within 8 km; covariances grow with
/// depth as an MWD's do.
Known Draw(std::mt19937_64& engine) {
  std::uniform_real_distribution<double> uniform(0, 1);
  const double azimuth = 2 * kPi * uniform(engine), most = 1.2 * uniform(engine);
  std::vector<SurveyPoint> stations;
  for (int k = 0; k < 300; ++k) {
    const double build = std::min(1.0, std::max(0.0, (k - 20) / 80.0));
    stations.push_back({10.0 * k, most * build, azimuth + 0.002 * k, 0});
  }
  const double north = 8000 * uniform(engine), east = 8000 * uniform(engine);
  Known known{SurveyWell(stations, {north, east, 0}), {}};
  for (const SurveyPoint& p : known.well.survey) {
    const double sigma = 0.2 + 0.006 * p.md;
    known.errors.cov_p_W.push_back(sigma * sigma * Eigen::Matrix3d::Identity());
  }
  return known;
}

std::vector<Known> Field() {
  std::mt19937_64 engine(1);
  std::vector<Known> wells;
  for (int i = 0; i < 1001; ++i) wells.push_back(Draw(engine));
  return wells;
}

// Everything from positions and covariances on: trees of every well, the screen, and the rows of
// those that are left.
void ScreenThousandWells(benchmark::State& state) {
  const std::vector<Known> wells = Field();
  const SeparationRule rule;
  std::size_t left = 0, rows = 0;
  for (auto _ : state) {
    left = rows = 0;
    const HoleLine reference({&wells[0].well, &wells[0].errors});
    for (std::size_t i = 1; i < wells.size(); ++i) {
      const HoleLine offset({&wells[i].well, &wells[i].errors});
      if (!MayFallBelow(reference, offset, rule, 1.5)) continue;
      ++left;
      if (state.range(0) == 0) continue;
      rows += Separations(reference, offset, Pairing::kTwoWells, rule).size();
    }
    benchmark::DoNotOptimize(rows);
  }
  state.counters["wells left"] = static_cast<double>(left);
  state.counters["rows"] = static_cast<double>(rows);
}
BENCHMARK(ScreenThousandWells)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace wellgyro

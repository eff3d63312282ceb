// From the bench to the well: the joint calibration of tools that know their temperature, raw
// counts at the hole's temperatures, and what the survey says of itself at every depth.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/base/units.h"
#include "wellgyro/fit/tool_fit.h"
#include "wellgyro/io/toml/tool_file.h"
#include "wellgyro/math/statistics.h"
#include "wellgyro/simulate/raw_counts.h"
#include "wellgyro/simulate/truth.h"

#include "fit/tool_bench.h"
#include "fit/tool_model_truth.h"
#include "support/hour.h"

namespace wellgyro::test {
namespace {

constexpr int kParts = 5;  // of the depth
// A tool that rolls at some 20 deg/s: counts of a millionth of a deg/h would end at 0.6 deg/s.
constexpr double kRateCount = 1e-4, kForceCount = 1e-7;  // [deg/h], [g]
// More than the least that the estimator takes, 5e-5: with less, runs find the errors that a bench
// leaves better than they say, and what the bench says seems too much.
constexpr double kForceNoise = 1e-4;  // [m/s^2/sqrt(Hz)]

struct BenchQuality {
  const char* name;
  std::uint64_t seed;  ///< of the first tool, so that no two qualities have one tool in common
  double sigma_accel, sigma_gyro, sigma_table, wobble_arcsec;
};
constexpr BenchQuality kQualities[] = {{"fine", 1000, 5e-6, 0.005, 0.1, 5},
                                       {"good", 2000, 2e-5, 0.02, 0.5, 20},
                                       {"plain", 3000, 5e-5, 0.05, 1, 60},
                                       {"coarse", 4000, 1e-4, 0.1, 2, 120}};

Result<ToolCalibration> CalibratedOn(const BenchQuality& quality, const ThermalTool& tool,
                                     Random& random) {
  ThermalBench bench = ThermalBench::Any(random);
  // A bias walks, by what the fit states of it: a straight drift is less than it allows for.
  Random walk(random.Bits());
  bench.Bend(walk);
  bench.sigma_accel = quality.sigma_accel;
  bench.sigma_gyro = quality.sigma_gyro;
  bench.sigma_table = quality.sigma_table;
  bench.wobble = quality.wobble_arcsec * kRad / 3600;
  const std::vector<BenchTable> tables = {ThermalPositions(tool, bench, 0, 120, 25, 150, random),
                                          ThermalPositions(tool, bench, 1, 60, 150, 25, random),
                                          ThermalRates(tool, bench, 87.5, random)};
  ToolFitSetup setup;
  setup.reference.latitude = 60 * kRad;
  setup.reference.gravity_mps2 = units::kStandardGravity;
  setup.sigma_level = 0.3 * kRad;
  setup.sigma_north = 0.5 * kRad;
  setup.sigma_axis = 1.5e-4;
  setup.sigma_rate_scale = 1e-6;  // the simulated table turns as it says
  const auto fit = FitTool(tables, setup);
  if (!fit) return fit.fault();
  const ToolUpdate update{
      .channels = std::vector<int>{0, 1, 2, 3, 4, 5, 6},
      .unit_per_count = std::vector<double>{kForceCount, kForceCount, kForceCount, kRateCount,
                                            kRateCount, kRateCount, kRateCount}};
  return ParseTool(ToolToml(Updated({}, *fit, update)), "tool.toml");
}

Simulation HoleRun(std::uint64_t seed) {
  wellgyro::testing::Hour hour;
  hour.inclination_deg = 35;
  hour.azimuth_deg = 70;
  hour.swing_deg = 30;
  hour.minutes = 20;
  hour.stops = 2;
  hour.speed = 0.5837;  // no whole number of the depth's steps between two marks
  Simulation simulation = SimulationOf(hour, 0);
  simulation.seed = seed;
  // Accelerometers that are known worse than the Earth's gravity take their errors for its.
  wellgyro::testing::DrawGravity(seed, simulation);
  simulation.tool.has_gz = true;
  simulation.tool.errors.gyro_noise.angle_random_walk = 1e-3 * units::kDegPerSqrtHour;
  simulation.tool.errors.accel_noise = kForceNoise;
  simulation.tool.errors.depth_resolution = hour.depth_resolution;
  return simulation;
}

Job JobOf(const Simulation& simulation) {
  Job job;
  job.well.latitude = simulation.earth.latitude;
  job.noise.angle_random_walk = 1e-3 * units::kDegPerSqrtHour;
  job.errors.accel_noise = kForceNoise;
  job.tie_in.md = 5;
  job.tie_in.tvd = 0;
  job.stations.every = 10;
  return job;
}

/// The survey of the counts that a tool makes of the run, which warms by 4 degC from `temperature`
/// on [degC]; what heating does to its gyros comes with the tool model's lag.
Survey SurveyOfCounts(const Simulation& simulation, const Job& job, double temperature,
                      RawCounter& counter) {
  Sink sink;
  Surveyor surveyor(job, sink);
  const double seconds = 20 * 60, warming = 4, lag = SensorGroup{}.heating_lag;
  wellgyro::testing::Play(simulation, surveyor, [&](SimulatedStep& step) {
    const auto* sample = std::get_if<ImuSample>(&step);
    if (sample == nullptr) return true;
    const double t = static_cast<double>(sample->stamp.tool_time.ns) * 1e-9;
    const double rate = warming / seconds * -std::expm1(-t / lag);
    const RawSample raw = counter.Count(*sample, temperature + warming * t / seconds, rate);
    surveyor.Push(std::span<const RawSample>(&raw, 1));
    return false;
  });
  surveyor.Finish();
  return surveyor.Current(simulation.streams.tool);
}

/// Squares of errors over their variances, by parts of the depth; the mean of the stations of each
/// part: within a tool they go together.
struct PartSquares {
  std::array<double, kParts> inclination{}, azimuth{}, place{};

  /// Of station `i` of `n`.
  void Add(std::size_t i, std::size_t n, double d_inclination, double d_azimuth,
           const Eigen::Matrix3d& cov_md_inc_azi, const Eigen::Vector2d& off,
           const Eigen::Matrix2d& cov_off) {
    const std::size_t at = i * kParts / n;
    double stations = 0;
    for (std::size_t j = 1; j < n; ++j) stations += j * kParts / n == at ? 1 : 0;
    inclination[at] += std::pow(d_inclination, 2) / cov_md_inc_azi(1, 1) / stations;
    azimuth[at] += std::pow(d_azimuth, 2) / cov_md_inc_azi(2, 2) / stations;
    place[at] += off.dot(cov_off.inverse() * off) / 2 / stations;
  }
  void Print(const char* name, double tools) const {
    std::printf("  %s: inclination, azimuth, place\n", name);
    for (std::size_t k = 0; k < kParts; ++k) {
      std::printf("  %.2f %.2f %.2f\n", std::sqrt(inclination[k] / tools),
                  std::sqrt(azimuth[k] / tools), std::sqrt(place[k] / tools));
    }
  }
};

struct WellScore {
  double tools = 0;
  int withheld = 0;  ///< runs that fail give no sigma
  int unlike = 0;    ///< perfect tools' runs that fail, as chance has them: nothing to compare with
  PartSquares bench;  ///< beyond the survey of a perfect tool, over what the calibration adds to it
  PartSquares whole;  ///< off where the tool was, over what the survey says of itself

  void Take(const Survey& survey, const Survey& perfect, const Truth& truth) {
    const std::size_t n = std::min(survey.chosen.size(), perfect.chosen.size());
    tools += 1;
    const auto truth_at = [&](const Station& s) {
      return truth.At(static_cast<double>(s.tool_time.ns) * 1e-9);
    };
    const Eigen::Vector3d start_W = truth_at(survey.chosen.front()).p_WT_W;
    for (std::size_t i = 1; i < n; ++i) {
      const Station &a = survey.chosen[i], &b = perfect.chosen[i];
      const auto square = [](const Eigen::Matrix3d& cov) -> Eigen::Matrix2d {
        return cov.topLeftCorner<2, 2>();
      };
      bench.Add(i, n, a.inclination - b.inclination, std::remainder(a.azimuth - b.azimuth, kTwoPi),
                a.cov_md_inc_azi - b.cov_md_inc_azi, (a.p_WT_W - b.p_WT_W).head<2>(),
                square(a.cov_p_WT_W - b.cov_p_WT_W));
      // The covariance counts what depths are misread by: not the hole's place at a misread depth.
      const TruthState here = truth_at(a);
      whole.Add(i, n, a.inclination - here.inclination,
                std::remainder(a.azimuth - here.azimuth, kTwoPi), a.cov_md_inc_azi,
                (a.p_WT_W - (here.p_WT_W - start_W)).head<2>(), square(a.cov_p_WT_W));
    }
  }
  void Print(const char* name) const {
    std::printf("%s bench, %.0f tools, %d more fail, of %d a perfect one would; by depth\n", name,
                tools, withheld, unlike);
    bench.Print("beyond a perfect tool's", tools);
    whole.Print("off the truth", tools);
    std::fflush(stdout);
  }
};

/// Calibrates tools of one quality of bench and surveys with them.
void SurveyWith(const BenchQuality& quality, int tools, WellScore& score) {
  for (int i = 0; i < tools; ++i) {
    const std::uint64_t seed = quality.seed + static_cast<std::uint64_t>(i);
    Random random(seed);
    const ThermalTool truth = ThermalTool::Any(random);
    const auto tool = CalibratedOn(quality, truth, random);
    ASSERT_TRUE(tool.has_value()) << tool.fault().text;
    const Simulation simulation = HoleRun(seed);
    Job job = JobOf(simulation);
    Sink sink;
    const Survey perfect = wellgyro::testing::SurveyOf(simulation, job, sink);
    if (perfect.runs.front().verdict.verdict == Verdict::kFail) {
      ++score.unlike;
      continue;
    }
    job.errors = *tool->errors;
    job.errors.accel_noise = kForceNoise;
    job.tool = *tool;
    ToolCalibration model = ModelOf(truth);
    model.gyro.unit_per_count.setConstant(kRateCount);
    model.accel.unit_per_count.setConstant(kForceCount);
    RawCounter counter(model);
    const double temperature = 40 + 90 * random.Uniform();
    const Survey survey = SurveyOfCounts(simulation, job, temperature, counter);
    ASSERT_GT(survey.chosen.size(), 40u) << survey.unusable;
    ASSERT_TRUE(survey.runs.front().fit && survey.runs.front().fit->converged);
    if (survey.runs.front().verdict.verdict == Verdict::kFail) {
      ++score.withheld;
      for (const std::string& cause : survey.runs.front().verdict.causes) {
        std::printf("  tool %d at %.0f degC fails: %s\n", i, temperature, cause.c_str());
      }
      continue;
    }
    score.Take(survey, perfect, wellgyro::Truth(simulation));
  }
}

class ToolWell : public testing::TestWithParam<BenchQuality> {};

TEST_P(ToolWell, WhatTheBenchLeavesIsWhatTheSurveySays) {
  WellScore score;
  SurveyWith(GetParam(), WELLGYRO_LONG ? 100 : 1, score);
  score.Print(GetParam().name);
  EXPECT_LE(score.withheld, WELLGYRO_LONG ? 4 : 0);
  EXPECT_LE(score.unlike, WELLGYRO_LONG ? 5 : 0);
  ASSERT_GT(score.tools, 0);
  // One in a thousand of the chi-square of that many tools, were the stations of a part all one.
  const double low = ChiSquareQuantile(0.0005, score.tools) / score.tools;
  const double high = ChiSquareQuantile(0.9995, score.tools) / score.tools;
  for (const PartSquares& parts : {score.bench, score.whole}) {
    for (const auto& squares : {parts.inclination, parts.azimuth, parts.place}) {
      for (const double square : squares) {
        EXPECT_LT(square / score.tools, high);
        EXPECT_GT(square / score.tools, low);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Benches, ToolWell, testing::ValuesIn(kQualities),
                         [](const auto& instance) { return std::string(instance.param.name); });

}  // namespace
}  // namespace wellgyro::test

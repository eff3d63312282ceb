// From the bench to the well: the joint calibration of tools that know their temperature, raw
// counts at the hole's temperatures, and what the survey says of itself at every depth.
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/base/units.h"
#include "wellgyro/fit/tool_fit.h"
#include "wellgyro/io/toml/tool_file.h"
#include "wellgyro/simulate/raw_counts.h"

#include "fit/tool_bench.h"
#include "fit/tool_model_truth.h"
#include "support/hour.h"

namespace wellgyro::test {
namespace {

constexpr int kParts = 5;  // of the depth

struct BenchQuality {
  const char* name;
  double sigma_accel, sigma_gyro, sigma_table, wobble_arcsec;
};
constexpr BenchQuality kQualities[] = {{"fine", 5e-6, 0.005, 0.1, 5},
                                       {"good", 2e-5, 0.02, 0.5, 20},
                                       {"plain", 5e-5, 0.05, 1, 60},
                                       {"coarse", 1e-4, 0.1, 2, 120}};

Result<ToolCalibration> CalibratedOn(const BenchQuality& quality, const ThermalTool& tool,
                                     Random& random) {
  ThermalBench bench = ThermalBench::Any(random);
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
  const auto fit = FitTool(tables, setup);
  if (!fit) return fit.fault();
  const ToolUpdate update{.channels = std::vector<int>{0, 1, 2, 3, 4, 5, 6},
                          .unit_per_count = std::vector<double>{1e-6}};
  return ParseTool(ToolToml(Updated({}, *fit, update)), "tool.toml");
}

Simulation HoleRun(std::uint64_t seed) {
  wellgyro::testing::Hour hour;
  hour.inclination_deg = 35;
  hour.azimuth_deg = 70;
  hour.swing_deg = 30;
  hour.minutes = 20;
  hour.stops = 2;
  Simulation simulation = SimulationOf(hour, 0);
  simulation.seed = seed;
  simulation.tool.has_gz = true;
  simulation.tool.errors.gyro_noise.angle_random_walk = 1e-3 * units::kDegPerSqrtHour;
  simulation.tool.errors.accel_noise = 1e-5;
  return simulation;
}

Job JobOf(const Simulation& simulation) {
  Job job;
  job.well.latitude = simulation.earth.latitude;
  job.noise.angle_random_walk = 1e-3 * units::kDegPerSqrtHour;
  job.errors.accel_noise = 1e-5;
  job.tie_in.md = 5;
  job.stations.every = 10;
  return job;
}

/// The survey of the counts that a tool makes of the run, which warms up from 40 to 120 degC.
Survey SurveyOfCounts(const Simulation& simulation, const Job& job, RawCounter& counter) {
  Sink sink;
  Surveyor surveyor(job, sink);
  const double seconds = 20 * 60;
  wellgyro::testing::Play(simulation, surveyor, [&](SimulatedStep& step) {
    const auto* sample = std::get_if<ImuSample>(&step);
    if (sample == nullptr) return true;
    const double part = static_cast<double>(sample->stamp.tool_time.ns) * 1e-9 / seconds;
    const RawSample raw = counter.Count(*sample, 40 + 80 * part);
    surveyor.Push(std::span<const RawSample>(&raw, 1));
    return false;
  });
  surveyor.Finish();
  return surveyor.Current(simulation.streams.tool);
}

/// Squares of errors over what the calibration says of them, against the survey of a perfect tool.
struct Score {
  std::array<double, kParts> inclination{}, azimuth{}, place{}, number{};

  void Take(const Survey& survey, const Survey& perfect) {
    const std::size_t n = std::min(survey.chosen.size(), perfect.chosen.size());
    for (std::size_t i = 1; i < n; ++i) {
      const Station &a = survey.chosen[i], &b = perfect.chosen[i];
      const std::size_t at = i * kParts / n;
      const Eigen::Matrix3d angles = a.cov_md_inc_azi - b.cov_md_inc_azi;
      const Eigen::Matrix2d places = (a.cov_p_WT_W - b.cov_p_WT_W).topLeftCorner<2, 2>();
      const Eigen::Vector2d off = (a.p_WT_W - b.p_WT_W).head<2>();
      inclination[at] += std::pow(a.inclination - b.inclination, 2) / angles(1, 1);
      azimuth[at] += std::pow(std::remainder(a.azimuth - b.azimuth, kTwoPi), 2) / angles(2, 2);
      place[at] += off.dot(places.inverse() * off) / 2;
      number[at] += 1;
    }
  }
};

TEST(ToolWell, WhatTheBenchLeavesIsWhatTheSurveySays) {
  const int tools = WELLGYRO_LONG ? 25 : 1;
  for (const BenchQuality& quality : kQualities) {
    Score score;
    for (int i = 0; i < tools; ++i) {
      Random random(500 + static_cast<std::uint64_t>(i));
      ThermalTool truth = ThermalTool::Any(random);
      // The tool model follows heating by a minute's lag: what that misses is no bench's error.
      truth.heating.setZero();
      const auto tool = CalibratedOn(quality, truth, random);
      ASSERT_TRUE(tool.has_value()) << tool.fault().text;
      const Simulation simulation = HoleRun(1 + static_cast<std::uint64_t>(i));
      Job job = JobOf(simulation);
      Sink sink;
      const Survey perfect = wellgyro::testing::SurveyOf(simulation, job, sink);
      job.errors = *tool->errors;
      job.errors.accel_noise = 1e-5;
      job.tool = *tool;
      RawCounter counter(ModelOf(truth));
      const Survey survey = SurveyOfCounts(simulation, job, counter);
      ASSERT_GT(survey.chosen.size(), 40u) << survey.unusable;
      score.Take(survey, perfect);
    }
    std::printf("%s bench, %d tools, by depth: inclination, azimuth, place\n", quality.name, tools);
    for (std::size_t k = 0; k < kParts; ++k) {
      const double rms[] = {std::sqrt(score.inclination[k] / score.number[k]),
                            std::sqrt(score.azimuth[k] / score.number[k]),
                            std::sqrt(score.place[k] / score.number[k])};
      std::printf("  %.2f %.2f %.2f\n", rms[0], rms[1], rms[2]);
      for (const double value : rms) EXPECT_LT(value, WELLGYRO_LONG ? 1.3 : 3.5);
    }
  }
}

}  // namespace
}  // namespace wellgyro::test

// All bench data of a tool in one adjustment.
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "wellgyro/fit/tool_fit.h"

#include "fit/tool_bench.h"

namespace wellgyro::test {
namespace {

using testing::Contains;
using testing::HasSubstr;

struct Bench {
  ThermalTool tool;
  ThermalBench bench;
  std::vector<BenchTable> tables;
};

Bench AnyBench(Random& random) {
  Bench b{ThermalTool::Any(random), ThermalBench::Any(random), {}};
  b.tables.push_back(ThermalPositions(b.tool, b.bench, 0, 120, 25, 150, random));
  b.tables.push_back(ThermalPositions(b.tool, b.bench, 1, 60, 150, 25, random));
  b.tables.push_back(ThermalRates(b.tool, b.bench, 87.5, random));
  return b;
}

ToolFitSetup Setup() {
  ToolFitSetup setup;
  setup.reference.latitude = 60 * kRad;
  setup.sigma_level = 0.3 * kRad;
  setup.sigma_north = 0.5 * kRad;
  setup.sigma_axis = 1.5e-4;
  return setup;
}

bool IsOfTheTool(const std::string& name) {
  return name.rfind("accel_", 0) == 0 || name.rfind("gyro_", 0) == 0;
}

struct Score {
  double square = 0, number = 0;                 // of the tool's parameters, with their covariance
  double bench_square = 0, bench_number = 0;     // of the bench's, one by one
  int missed = 0;                                // terms of the truth that were left out
};

Score ScoreOf(const ToolFit& fit, const std::map<std::string, double>& truth) {
  const FitReport& report = fit.calibration.report;
  Score score;
  std::vector<Eigen::Index> places;
  std::map<std::string, double> left = truth;
  Eigen::VectorXd error(report.values.size());
  for (Eigen::Index i = 0; i < report.values.size(); ++i) {
    const std::string& name = report.parameters[static_cast<std::size_t>(i)];
    const auto found = truth.find(name);
    error[i] = report.values[i] - (found == truth.end() ? 0 : found->second);
    left.erase(name);
    if (IsOfTheTool(name)) {
      places.push_back(i);
    } else {
      score.bench_square += error[i] * error[i] / report.cov(i, i);
      score.bench_number += 1;
    }
  }
  score.missed = static_cast<int>(left.size());
  const Eigen::MatrixXd cov = report.cov(places, places);
  const Eigen::VectorXd scale = cov.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd r = scale.asDiagonal() * cov * scale.asDiagonal();
  const Eigen::VectorXd e = scale.cwiseProduct(error(places));
  score.square = e.dot(r.ldlt().solve(e));
  score.number = static_cast<double>(places.size());
  return score;
}

void Sum(const Score& one, Score& all) {
  all.square += one.square;
  all.number += one.number;
  all.bench_square += one.bench_square;
  all.bench_number += one.bench_number;
  all.missed += one.missed;
}

TEST(ToolFit, ParametersAndNuisancesWithinTheirSigmas) {
  Random random(31);
  Score all;
  const int benches = WELLGYRO_LONG ? 200 : 4;
  for (int i = 0; i < benches; ++i) {
    const Bench b = AnyBench(random);
    const auto fit = FitTool(b.tables, Setup());
    ASSERT_TRUE(fit.has_value()) << fit.fault().text;
    EXPECT_TRUE(fit->calibration.report.outlier_lines.empty());
    Sum(ScoreOf(*fit, TruthOf(b.tool, b.bench)), all);
  }
  std::printf("%d benches: %.0f parameters of the tool, squares over their number %.3f; %.0f of the "
              "bench, %.3f; %d terms of the truth left out\n",
              benches, all.number, all.square / all.number, all.bench_number,
              all.bench_square / all.bench_number, all.missed);
  // Of so many by chance: 95 %.
  const double chance = WELLGYRO_LONG ? 0.05 : 2.6 * std::sqrt(2 / all.number);
  EXPECT_NEAR(all.square / all.number, 1, chance);
  EXPECT_NEAR(all.bench_square / all.bench_number, 1, 2.6 * std::sqrt(2 / all.bench_number));
  EXPECT_LE(all.missed, all.number / 20);
}

}  // namespace
}  // namespace wellgyro::test

// The covariance of a tool's calibration by its sources.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Dense>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "wellgyro/calibration/error_sources.h"
#include "wellgyro/calibration/prior.h"
#include "wellgyro/calibration/uncertainty_budget.h"
#include "wellgyro/fit/tool_fit.h"

#include "fit/tool_bench.h"

namespace wellgyro::test {
namespace {

using testing::Contains;
using testing::Not;

ToolFitSetup BudgetPriors() {
  ToolFitSetup setup;
  setup.reference.latitude = 60 * kRad;
  setup.reference.gravity_mps2 = 9.8192;
  setup.sigma_level = 0.3 * kRad;
  setup.sigma_north = 0.5 * kRad;
  setup.sigma_axis = 1.5e-4;
  return setup;
}

std::vector<BenchTable> BudgetTables(const ThermalTool& tool, const ThermalBench& bench,
                                     Random& random) {
  return {ThermalPositions(tool, bench, 0, 120, 25, 150, random),
          ThermalPositions(tool, bench, 1, 60, 150, 25, random),
          ThermalRates(tool, bench, 87.5, random)};
}

Eigen::MatrixXd SumOf(const CovarianceParts& parts) {
  Eigen::MatrixXd sum = parts.cov.front();
  for (std::size_t k = 1; k < parts.cov.size(); ++k) sum += parts.cov[k];
  return sum;
}

// Largest difference of two covariances in their own sigmas.
double LargestDifference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const Eigen::VectorXd scale = b.diagonal().cwiseSqrt().cwiseInverse();
  return (scale.asDiagonal() * (a - b) * scale.asDiagonal()).cwiseAbs().maxCoeff();
}

TEST(ToolBudget, ContributionsAddUpToTheCovariance) {
  Random random(91);
  for (int i = 0; i < 2; ++i) {
    const ThermalTool tool = ThermalTool::Any(random);
    const ThermalBench bench = ThermalBench::Any(random);
    const auto fit = FitTool(BudgetTables(tool, bench, random), BudgetPriors());
    ASSERT_TRUE(fit.has_value()) << fit.fault().text;
    const FitReport& report = fit->calibration.report;
    const UncertaintyBudget& budget = report.budget;
    ASSERT_EQ(budget.contributions.rows(), report.cov.rows());
    EXPECT_THAT(budget.sources,
                testing::ElementsAre("readings", "level", "north", "inclination", "seat",
                                     "rate scale", "latitude", "drift", "terms left out"));
    EXPECT_EQ(budget.n_type_a, 1);
    double largest = 0;
    for (Eigen::Index k = 0; k < report.cov.rows(); ++k) {
      const double square = budget.contributions.row(k).squaredNorm();
      largest = std::max(largest, std::abs(square / report.cov(k, k) - 1));
    }
    std::printf("sum of squares of contributions off by %.1e, members' covariance by %.1e\n",
                largest, LargestDifference(SumOf(fit->members_by_source), fit->members.cov));
    EXPECT_LT(largest, 1e-9);
    EXPECT_LT(LargestDifference(SumOf(fit->members_by_source), fit->members.cov), 1e-9);
  }
}

// Readings nearly without noise, the same in all calls, at one temperature, where all that the
// bench may be off by is zero.
struct StillBench {
  ThermalTool tool;
  ThermalBench bench;
  double inclination = 0;  ///< zero of the stand [rad]

  static StillBench Any() {
    Random random(92);
    StillBench still{ThermalTool::Any(random), {}};
    for (int n = 1; n < 4; ++n) still.tool.ba[n].setZero(), still.tool.bg[n].setZero();
    still.tool.Sa[1].setZero();
    still.tool.MQ[1].setZero();
    still.tool.heating.setZero();
    for (Eigen::Vector3d& level : still.bench.level) level.setZero();
    for (Eigen::Vector2d& seat : still.bench.seat) seat.setZero();
    for (Eigen::Vector4d& drift : still.bench.drift) drift.setZero();
    // What tells one reading of an attitude from another, a thousandth of what is stated.
    still.bench.wobble = 0;
    still.bench.sigma_accel = 2e-8;
    still.bench.sigma_gyro = 2e-5;
    still.bench.sigma_table = 5e-4;
    return still;
  }
  std::vector<BenchTable> Tables() const {
    Random order(93);
    std::vector<BenchTable> tables = {ThermalPositions(tool, bench, 0, 96, 87.5, 87.5, order),
                                      ThermalRates(tool, bench, 87.5, order)};
    // A stand that shows less than it inclines by.
    tables[0].values.col(*tables[0].Find("inc")).array() -= inclination / kRad;
    return tables;
  }
};

// Priors about as narrow as what the readings tell; all noise is stated.
ToolFitSetup AllStated() {
  ToolFitSetup setup = BudgetPriors();
  setup.sigma_level = 2e-6;
  setup.sigma_north = 2e-4;
  setup.sigma_inclination = 2e-6;
  setup.sigma_latitude = 1e-4;
  setup.sigma_axis = 3e-5;
  setup.sigma_rate_scale = 3e-6;
  setup.sigma_wobble = 1e-5;
  setup.sigma_accel = 2e-5;
  setup.sigma_gyro = 0.02;
  setup.sigma_gyro_table = 0.5;
  return setup;
}

struct Push {
  const char* source;
  std::vector<std::pair<std::string, double*>> by;  // parameters, and where they are held
  double sigma;
};

std::vector<Push> PushesOf(StillBench& b, const ToolFitSetup& setup) {
  Push seat{"seat", {}, setup.sigma_axis};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string name = std::string("axis_") + "xyz"[axis] + "_of_table_2";
    seat.by.emplace_back(name + "[0]", &b.bench.seat[axis][0]);
    seat.by.emplace_back(name + "[1]", &b.bench.seat[axis][1]);
  }
  double* const level = b.bench.level[0].data();
  return {{"level", {{"level_1[0]", level}, {"level_1[1]", level + 1}}, setup.sigma_level},
          {"north", {{"north_1", level + 2}}, setup.sigma_north},
          {"inclination", {{"inclination_1", &b.inclination}}, setup.sigma_inclination},
          {"latitude", {{"latitude", &b.bench.latitude_error}}, setup.sigma_latitude},
          {"rate scale", {{"rate_scale_2", &b.bench.rate_scale}}, setup.sigma_rate_scale},
          seat};
}

Eigen::Index PlaceOf(const std::string& name, const std::vector<std::string>& names) {
  const auto found = std::find(names.begin(), names.end(), name);
  EXPECT_NE(found, names.end()) << name;
  return found - names.begin();
}

// A bench that is off by a prior's sigma, y = A x exactly: the estimate is off by C e_j / sigma_j,
// which is what the prior contributes to its uncertainty.
TEST(ToolBudget, ABenchThatIsOffByASigmaMovesTheEstimateByItsContribution) {
  StillBench b = StillBench::Any();
  const ToolFitSetup setup = AllStated();
  const auto fit = FitTool(b.Tables(), setup);
  ASSERT_TRUE(fit.has_value()) << fit.fault().text;
  const FitReport& report = fit->calibration.report;
  const UncertaintyBudget& budget = report.budget;
  EXPECT_EQ(budget.n_type_a, 0);
  EXPECT_THAT(budget.sources, Not(Contains("readings")));
  EXPECT_EQ(budget.dof.minCoeff(), UncertaintyBudget::kManyDof);
  const Eigen::VectorXd u = report.cov.diagonal().cwiseSqrt();
  for (const Push& push : PushesOf(b, setup)) {
    Eigen::VectorXd squares = Eigen::VectorXd::Zero(u.size());
    for (const auto& [name, held] : push.by) {
      *held = push.sigma;
      const auto moved = FitTool(b.Tables(), setup);
      *held = 0;
      ASSERT_TRUE(moved.has_value()) << moved.fault().text;
      ASSERT_EQ(moved->calibration.report.parameters, report.parameters);
      Eigen::VectorXd error = moved->calibration.report.values - report.values;
      error[PlaceOf(name, report.parameters)] -= push.sigma;
      squares += error.cwiseAbs2();
    }
    const Eigen::Index column = PlaceOf(push.source, budget.sources);
    // Smaller contributions than a twentieth of u are lost in the second order of the turns, and in
    // terms left out, whose means follow the readings.
    constexpr double kLeast = 0.05;
    double worst = 0;
    std::size_t seen = 0;
    for (Eigen::Index i = 0; i < u.size(); ++i) {
      const double expected = budget.contributions(i, column);
      if (expected < kLeast * u[i]) continue;
      ++seen;
      worst = std::max(worst, std::abs(std::sqrt(squares[i]) / expected - 1));
    }
    std::printf("%s: %zu parameters, off by %.2g of the contribution\n", push.source, seen, worst);
    EXPECT_LT(worst, 0.01);
    EXPECT_GE(seen, push.by.size());
  }
}

// Noise that is the only variance to be found: it has the degrees of freedom that the readings
// leave it, fewer than readings less the sensors' parameters by what the bench takes of them.
TEST(ToolBudget, FreedomIsWhatTheReadingsLeave) {
  Random random(94);
  const StillBench b = StillBench::Any();
  BenchTable table = b.Tables().front();
  table.columns.resize(8);
  table.values.conservativeResize(Eigen::NoChange, 8);
  for (double& reading : table.values.rightCols(3).reshaped()) reading += 2e-5 * random.Normal();
  ToolFitSetup setup = AllStated();
  setup.sigma_accel.reset();
  setup.sigma_wobble = 1e-9;
  const auto fit = FitTool(std::vector{table}, setup);
  ASSERT_TRUE(fit.has_value()) << fit.fault().text;
  const FitReport& report = fit->calibration.report;
  const UncertaintyBudget& budget = report.budget;
  const double priors = 3;  // two of level, one of inclination
  for (Eigen::Index i = 0; i < budget.dof.size(); ++i) {
    const double share = budget.contributions(i, 0) / budget.contributions.row(i).norm();
    const double dof = budget.dof[i] * std::pow(share, 4);
    EXPECT_GE(dof, (report.dof - priors) * (1 - 1e-6));
    EXPECT_LE(dof, report.dof * (1 + 1e-6));
  }
}

// What a bench and an earlier calibration contribute to the calibration of both.
TEST(ToolBudget, APriorIsASource) {
  Random random(95);
  const ThermalTool tool = ThermalTool::Any(random);
  const auto fit_of = [&] {
    return FitTool(BudgetTables(tool, ThermalBench::Any(random), random), BudgetPriors());
  };
  const auto earlier = fit_of(), fit = fit_of();
  ASSERT_TRUE(earlier.has_value() && fit.has_value());
  const JoinedTool joined =
      JoinPrior(Updated({}, *fit, ToolUpdate{}), Updated({}, *earlier, ToolUpdate{}));
  ASSERT_EQ(joined.members, fit->members.names);
  CovarianceParts parts = Propagated(fit->members_by_source, joined.by_bench);
  parts.Add("prior", joined.cov_by_prior);
  const Eigen::MatrixXd& cov = joined.tool.gyro.covariance->cov;
  EXPECT_LT(LargestDifference(SumOf(parts), cov), 1e-6);
  const CovarianceParts of_sources = SourcesByParts(joined.tool, joined.members, parts, 100);
  EXPECT_EQ(of_sources.sources.back(), "prior");
  const CalibrationSources sources = SourcesOf(joined.tool, 100);
  const UncertaintyBudget budget = BudgetOf(of_sources);
  const Eigen::Index at = sources.At("gyro_bias_x");
  EXPECT_NEAR(budget.contributions.row(at).squaredNorm() / sources.cov(at, at), 1, 1e-6);
  EXPECT_GT(budget.contributions(at, budget.contributions.cols() - 1), 0);
}

// JCGM 100:2008, G.4.1: of a product of three factors, 0.25, 0.57 and 0.82 % from 10, 5 and 15
// readings, and k of table G.2.
TEST(ToolBudget, EffectiveFreedomAndCoverageAreThoseOfTheGuide) {
  CovarianceParts parts;
  const double u[] = {0.25, 0.57, 0.82}, dof[] = {9, 4, 14};
  parts.variance_cov = Eigen::Matrix3d::Zero();
  for (int k = 0; k < 3; ++k) {
    parts.Add("readings", Eigen::MatrixXd::Constant(1, 1, u[k] * u[k]));
    parts.variance_cov(k, k) = 2 / dof[k];
  }
  UncertaintyBudget budget = BudgetOf(parts);
  EXPECT_EQ(budget.sources, std::vector<std::string>{"readings"});
  EXPECT_NEAR(budget.contributions(0, 0), 1.03, 0.005);
  EXPECT_NEAR(budget.dof[0], 19.0, 0.05);
  parts.Add("level", Eigen::MatrixXd::Constant(1, 1, 3 * 1.0598));
  budget = BudgetOf(parts);
  EXPECT_EQ(budget.n_type_a, 1);
  // u^2 is four times as large by a source without doubt.
  EXPECT_NEAR(budget.dof[0], 16 * 19.0, 16 * 0.05);
  for (const auto& [freedom, k] :
       {std::pair(3.0, 3.31), std::pair(10.0, 2.28), std::pair(20.0, 2.13), std::pair(50.0, 2.05),
        std::pair(UncertaintyBudget::kManyDof, 2.0)}) {
    EXPECT_NEAR(CoverageFactor(freedom).value(), k, 0.005 * k) << freedom;
  }
  EXPECT_FALSE(CoverageFactor(1.9).has_value());
}

}  // namespace
}  // namespace wellgyro::test

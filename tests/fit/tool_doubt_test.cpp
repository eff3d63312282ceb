// What readings cannot tell must be doubted, and what contradicts the table's settings told.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Dense>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "wellgyro/fit/tool_fit.h"

#include "fit/tool_bench.h"
#include "fit/tool_claims.h"

namespace wellgyro::test {
namespace {

using testing::HasSubstr;

// Errors of the fit's parameters over their sigmas; `most` of a sigma.
double ErrorOf(const ToolFit& fit, const std::string& name, double truth, double most) {
  const FitReport& report = fit.calibration.report;
  const auto found = std::find(report.parameters.begin(), report.parameters.end(), name);
  if (found == report.parameters.end()) {
    ADD_FAILURE() << "no parameter " << name;
    return 0;
  }
  const Eigen::Index at = found - report.parameters.begin();
  const double sigma = std::sqrt(report.cov(at, at));
  EXPECT_LT(sigma, most) << name;
  return (report.values[at] - truth) / sigma;
}

BenchTable AtInclinations(const BenchTable& data, const std::vector<double>& inclinations) {
  BenchTable some{data.source, data.columns, {}, {}};
  std::vector<Eigen::Index> rows;
  for (int i = 0; i < data.rows(); ++i) {
    const double its = data.values(i, *data.Find("inc"));
    if (std::count(inclinations.begin(), inclinations.end(), its) == 0) continue;
    rows.push_back(i);
    some.lines.push_back(data.lines[static_cast<std::size_t>(i)]);
  }
  some.values = data.values(rows, Eigen::all);
  return some;
}

// At 45 and 135 deg the square of the force along the axis is g^2 / 2 throughout: half of a second
// order of 2 mg/g^2 was the bias's, 338 of its sigmas.
TEST(ToolClaims, ASecondOrderThatThePositionsDoNotTellIsDoubted) {
  Random random(105);
  ThermalTool tool = ThermalTool::Any(random);
  tool.heating.setZero();
  tool.K2 = {0, 0, 2e-3};
  const ThermalBench bench = ThermalBench::Any(random);
  const BenchTable all = ThermalPositions(tool, bench, 0, 120, 25, 25.001, random);
  const BenchTable rates = ThermalRates(tool, bench, 25, random);
  const double bias = tool.Accel(Eigen::Vector3d::Zero(), -1)[2];
  const auto few = FitTool(std::vector{AtInclinations(all, {45, 135}), rates}, AtLatitude(60));
  ASSERT_TRUE(few.has_value()) << few.fault().text;
  EXPECT_LT(std::abs(ErrorOf(*few, "accel_b[2]", bias, 1e-3)), 3);
  EXPECT_LT(std::abs(ErrorOf(*few, "accel_K2[2,2]", 2e-3, 2e-3)), 3);
  EXPECT_TRUE(Says(few->calibration.report,
                   "accel_K2[2,2]: these readings hardly tell it from accel_b[2]"));
  EXPECT_TRUE(Says(few->calibration.report, "no position lies at inclination 0, 90, 180 deg"));
  // The survey's covariance has the two together: at 45 deg their sum is surer than either.
  const auto place = [&](const std::string& name) {
    const auto& names = few->members.names;
    return std::find(names.begin(), names.end(), name) - names.begin();
  };
  const auto b = place("accel.bias.p0[2]"), k = place("accel.second_order[2,2]");
  const Eigen::MatrixXd& cov = few->members.cov;
  const double half = 9.80665 * 9.80665 / 2;
  const double at_45 = cov(b, b) + 2 * half * cov(b, k) + half * half * cov(k, k);
  EXPECT_LT(at_45, cov(b, b) / 3);
  // Positions all round tell it, whatever it was thought to be, and doubt nothing.
  const auto whole = FitTool(std::vector{all, rates}, AtLatitude(60));
  ASSERT_TRUE(whole.has_value()) << whole.fault().text;
  EXPECT_LT(std::abs(ErrorOf(*whole, "accel_b[2]", bias, 3e-5)), 4);
  EXPECT_LT(std::abs(ErrorOf(*whole, "accel_K2[2,2]", 2e-3, 3e-5)), 4);
  EXPECT_FALSE(Says(whole->calibration.report, "hardly tell it"));
}

// Two temperatures show a slope; between them a bend was taken for nothing, and the bias at the
// middle, which is by the ends alone, off by it.
TEST(ToolClaims, ABendBetweenTwoTemperaturesIsDoubted) {
  Random random(106);
  ThermalTool tool = ThermalTool::Any(random);
  tool.heating.setZero();
  const ThermalBench bench = ThermalBench::Any(random);
  const std::vector<BenchTable> tables = {
      ThermalPositions(tool, bench, 0, 120, 25, 25.001, random),
      ThermalPositions(tool, bench, 1, 120, 150, 150.001, random),
      ThermalRates(tool, bench, 87.5, random)};
  const auto fit = FitTool(tables, AtLatitude(60));
  ASSERT_TRUE(fit.has_value()) << fit.fault().text;
  for (int c = 0; c < 3; ++c) {
    const std::string name = "accel_b[" + std::to_string(c) + "]";
    EXPECT_LT(std::abs(ErrorOf(*fit, name, tool.ba[0][c], 2e-2)), 4);
  }
  EXPECT_TRUE(Says(fit->calibration.report, "these readings hardly tell it from accel_b[0]"));
}

// Rates that are 5e-4 off made sensitivities as wrong, hundreds of their sigmas.
TEST(ToolClaims, TheScaleOfTheRateTableIsDoubted) {
  Random random(107);
  const ThermalTool tool = ThermalTool::Any(random);
  ThermalBench bench = ThermalBench::Any(random);
  ToolFitSetup setup = AtLatitude(60);
  for (const double scale : {5e-4, 2e-3}) {
    bench.rate_scale = scale;
    const std::vector<BenchTable> tables = {ThermalPositions(tool, bench, 0, 120, 25, 150, random),
                                            ThermalPositions(tool, bench, 1, 60, 150, 25, random),
                                            ThermalRates(tool, bench, 87.5, random)};
    const auto fit = FitTool(tables, setup);
    ASSERT_TRUE(fit.has_value()) << fit.fault().text;
    // Beyond what the prior holds the readings at rest contradict it, and that is told.
    EXPECT_EQ(Says(fit->calibration.report, "rate_scale_3: the readings ask for"), scale > 1e-3);
    ToolFitSetup sure = setup;
    sure.sigma_rate_scale = 1e-6;
    const auto exact = FitTool(tables, sure);
    ASSERT_TRUE(exact.has_value()) << exact.fault().text;
    for (int c = 0; c < 2; ++c) {
      const std::string name = "gyro_S[" + std::to_string(c) + "," + std::to_string(c) + "]";
      if (scale < 1e-3) EXPECT_LT(std::abs(ErrorOf(*fit, name, tool.U(c, c), 4e-4)), 3);
      EXPECT_GT(std::abs(ErrorOf(*exact, name, tool.U(c, c), 1e-5)), 50);  // told for certain
    }
    const auto& sources = fit->calibration.report.budget.sources;
    EXPECT_EQ(std::count(sources.begin(), sources.end(), "rate scale"), 1);
  }
}

constexpr const char* kStopTold = "look at that stop of the stand";

// All readings at azimuth 90 deg written as of 93: the fit made noise of it, 4 to 6 sigmas off.
TEST(ToolClaims, AStopOfTheStandThatIsOffIsTold) {
  Random random(108);
  const std::vector<BenchTable> sound = SmallBench(true, random);
  EXPECT_EQ(RemarkOf(sound, kStopTold), "");
  const std::pair<const char*, const char*> angles[] = {
      {"az", "azimuth 93 deg: its readings suit one of -"},
      {"inc", "inclination 90.02 deg: its readings suit one of -0.0"}};
  for (const auto& [column, told] : angles) {
    std::vector<BenchTable> wrong = sound;
    const double written = column == angles[0].first ? 93 : 90.02;  // more are left out as outliers
    for (int k = 0; k < 2; ++k) {
      for (double& angle : wrong[static_cast<std::size_t>(k)].values.col(*wrong[0].Find(column))) {
        if (angle == 90) angle = written;
      }
    }
    EXPECT_THAT(RemarkOf(wrong, kStopTold), HasSubstr(told));
  }
  ExpectRarelyTold(kStopTold, WELLGYRO_LONG, random);
}

// A bias that is another in one table, as after the power was off; times in minutes, of which
// heating terms are wrong by as much.
TEST(ToolClaims, ABiasOfOneTableAndTimesInMinutesAreTold) {
  Random random(109);
  ThermalTool tool = ThermalTool::Any(random);
  tool.heating.setZero();
  const ThermalBench bench = ThermalBench::Any(random);
  std::vector<BenchTable> twice = {ThermalPositions(tool, bench, 0, 84, 25, 25.001, random),
                                   ThermalPositions(tool, bench, 1, 84, 25, 25.001, random),
                                   ThermalRates(tool, bench, 25, random)};
  EXPECT_FALSE(Says(FitTool(twice, AtLatitude(60))->calibration.report, "its bias is not"));
  twice[0].values.col(*twice[0].Find("m_x1")).array() += 0.3;
  const auto told = FitTool(twice, AtLatitude(60));
  ASSERT_TRUE(told.has_value()) << told.fault().text;
  EXPECT_TRUE(Says(told->calibration.report, "channel m_x1 reads"));
  const std::vector<BenchTable> tables = SmallBench(true, random);
  std::vector<BenchTable> minutes = tables;
  for (std::size_t k = 0; k < 2; ++k) minutes[k].values.col(*minutes[k].Find("t_s")) /= 60;
  const auto fast = FitTool(minutes, AtLatitude(60));
  ASSERT_TRUE(fast.has_value()) << fast.fault().text;
  EXPECT_TRUE(Says(fast->calibration.report, "t_s is not in seconds"));
  EXPECT_FALSE(Says(FitTool(tables, AtLatitude(60))->calibration.report, "t_s is not in seconds"));
}

}  // namespace
}  // namespace wellgyro::test

// All bench data of a tool in one adjustment.
#include "wellgyro/fit/tool_fit.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Dense>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

/// `walk`: by which drifts bend, as the fit takes them to; null: they are straight.
Bench AnyBench(Random& random, Random* walk = nullptr) {
  Bench b{ThermalTool::Any(random), ThermalBench::Any(random), {}};
  if (walk != nullptr) {
    b.bench.Bend(*walk);
    b.bench.rate_scale = ToolFitSetup().sigma_rate_scale * walk->Normal();
  }
  b.tables.push_back(ThermalPositions(b.tool, b.bench, 0, 120, 25, 150, random));
  b.tables.push_back(ThermalPositions(b.tool, b.bench, 1, 60, 150, 25, random));
  b.tables.push_back(ThermalRates(b.tool, b.bench, 87.5, random));
  return b;
}

ToolFitSetup Stated() {
  ToolFitSetup setup;
  setup.reference.latitude = 60 * kRad;
  setup.reference.gravity_mps2 = 9.8192;  // the readings are in this
  setup.sigma_level = 0.3 * kRad;
  setup.sigma_north = 0.5 * kRad;
  setup.sigma_axis = 1.5e-4;
  return setup;
}

bool IsOfTheTool(const std::string& name) {
  return name.rfind("accel_", 0) == 0 || name.rfind("gyro_", 0) == 0;
}

struct Score {
  double square = 0, number = 0;              // of the tool's parameters, with their covariance
  double bench_square = 0, bench_number = 0;  // of the bench's, one by one
  int missed = 0;                             // terms of the truth that were left out
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

std::vector<std::string> DriftsTold(const ToolFit& fit) {
  std::vector<std::string> told;
  for (const std::string& remark : fit.calibration.report.remarks) {
    if (remark.find("where a drift has a sigma of") != remark.npos) told.push_back(remark);
  }
  return told;
}

TEST(ToolFit, ParametersAndNuisancesWithinTheirSigmas) {
  Random random(31), walk(32);
  Score all;
  const int benches = WELLGYRO_LONG ? 200 : 1;
  for (int i = 0; i < benches; ++i) {
    const Bench b = AnyBench(random, &walk);
    const auto fit = FitTool(b.tables, Stated());
    ASSERT_TRUE(fit.has_value()) << fit.fault().text;
    EXPECT_TRUE(fit->calibration.report.outlier_lines.empty());
    if (!WELLGYRO_LONG) EXPECT_THAT(DriftsTold(*fit), testing::IsEmpty());
    Sum(ScoreOf(*fit, TruthOf(b.tool, b.bench)), all);
  }
  std::printf(
      "%d benches: %.0f parameters of the tool, squares over their number %.3f; %.0f of the "
      "bench, %.3f; %d terms of the truth left out\n",
      benches, all.number, all.square / all.number, all.bench_number,
      all.bench_square / all.bench_number, all.missed);
  // Beyond by chance once in a thousand.
  const double chance = WELLGYRO_LONG ? 0.05 : 3.3 * std::sqrt(2 / all.number);
  EXPECT_NEAR(all.square / all.number, 1, chance);
  EXPECT_NEAR(all.bench_square / all.bench_number, 1, 3.3 * std::sqrt(2 / all.bench_number));
  EXPECT_LE(all.missed, all.number / 20);
}

// 2026-11-24: of 200 benches some had a loop and a bend of drift for what heating does, and biases
// wrong by 0.3 deg/h with sigmas of 0.003. These three of them, of the run of 200: the sum of
// squares alone prefers a loop and two bends in the last.
TEST(ToolFit, ALoopAndABendDoNotStandForHeating) {
  Random random(31);
  for (int i = 0; i <= 186; ++i) {
    const Bench b = AnyBench(random);
    if (i != 5 && i != 18 && i != 186) continue;
    const auto fit = FitTool(b.tables, Stated());
    ASSERT_TRUE(fit.has_value()) << fit.fault().text;
    const Score score = ScoreOf(*fit, TruthOf(b.tool, b.bench));
    EXPECT_LT(score.square / score.number, 1 + 3.3 * std::sqrt(2 / score.number)) << i;
  }
}

bool IsRival(const std::string& remark) {
  return remark.find("gyro_heating") != std::string::npos &&
         remark.find("could as well be") != std::string::npos;
}

// Heating of a hundredth, and no rate table at the middle temperature: a loop explains as much.
TEST(ToolFit, TermsThatDoTheSameWorkAreTold) {
  for (const double part : {1.0, 0.01}) {
    Random random(31);
    Bench b{ThermalTool::Any(random), ThermalBench::Any(random), {}};
    b.tool.heating *= part;
    b.tables.push_back(ThermalPositions(b.tool, b.bench, 0, 120, 25, 150, random));
    b.tables.push_back(ThermalPositions(b.tool, b.bench, 1, 60, 150, 25, random));
    const auto fit = FitTool(b.tables, Stated());
    ASSERT_TRUE(fit.has_value()) << fit.fault().text;
    const std::vector<std::string>& remarks = fit->calibration.report.remarks;
    EXPECT_EQ(std::any_of(remarks.begin(), remarks.end(), IsRival), part < 1);
  }
}

// Ten times what the prior says, of one gyro on the first table. A bend would not show: on a ramp
// up and one down it is a loop of hysteresis and a square of the temperature.
TEST(ToolFit, ATableTwiceAndAMisnamedColumnAreRefused) {
  Random random(77);
  const ThermalTool tool = ThermalTool::Any(random);
  const ThermalBench bench = ThermalBench::Any(random);
  BenchTable positions = ThermalPositions(tool, bench, 0, 48, 25, 40, random);
  positions.source = "a.csv";
  ToolFitSetup setup;
  setup.reference.latitude = 60 * kRad;
  std::vector<BenchTable> tables = {positions, positions};
  tables[1].source = "b.csv";
  const auto twice = FitTool(tables, setup);
  ASSERT_FALSE(twice.has_value());
  EXPECT_EQ(twice.fault().source, "b.csv");
  EXPECT_NE(twice.fault().text.find("the same readings as a.csv"), std::string::npos);
  tables[1].values.col(*positions.Find("t_s")).array() += 20000;
  const auto later = FitTool(tables, setup);
  ASSERT_FALSE(later.has_value());
  EXPECT_EQ(later.fault().source, "b.csv");
  EXPECT_NE(later.fault().text.find("line 2 repeats the readings of a.csv, line 2"),
            std::string::npos);
  const auto z = static_cast<std::size_t>(*positions.Find("Gz"));
  tables = {positions};
  tables[0].columns[z] = "Gq";
  const auto misnamed = FitTool(tables, setup);
  ASSERT_FALSE(misnamed.has_value());
  EXPECT_NE(misnamed.fault().text.find("column Gz is missing beside Gx, Gy"), std::string::npos);
}

bool Remarks(const ToolFit& fit, const std::string& words) {
  const auto& remarks = fit.calibration.report.remarks;
  return std::any_of(remarks.begin(), remarks.end(), [&](const std::string& remark) {
    return remark.find(words) != std::string::npos;
  });
}

// What no residual shows: noise found from next to nothing, a latitude that mass unbalance takes.
TEST(ToolFit, FewReadingsAndAnUncheckedLatitudeAreTold) {
  Random random(78);
  ThermalTool tool = ThermalTool::Any(random);
  tool.heating.setZero();
  const ThermalBench bench = ThermalBench::Any(random);
  ToolFitSetup setup;
  setup.reference.latitude = 60 * kRad;
  const std::vector<BenchTable> few = {ThermalPositions(tool, bench, 0, 13, 30, 30.1, random)};
  const auto small = FitTool(few, setup);
  ASSERT_TRUE(small.has_value()) << small.fault().text;
  EXPECT_TRUE(Remarks(*small, "accelerometers give "));
  EXPECT_TRUE(Remarks(*small, "no rate table"));
  const std::vector<BenchTable> many = {ThermalPositions(tool, bench, 0, 96, 30, 30.1, random),
                                        ThermalRates(tool, bench, 30, random)};
  const auto large = FitTool(many, setup);
  ASSERT_TRUE(large.has_value()) << large.fault().text;
  EXPECT_FALSE(Remarks(*large, " readings more than there are unknowns"));
  EXPECT_FALSE(Remarks(*large, "no rate table"));
  EXPECT_FALSE(Remarks(*large, "attitudes repeat to"));
}

// Inclinations that are off by .3 deg, up and down by turns, are no noise of the accelerometers.
TEST(ToolFit, ScatterThatNoBenchHasIsTold) {
  Random random(79);
  ThermalTool tool = ThermalTool::Any(random);
  tool.heating.setZero();
  const ThermalBench bench = ThermalBench::Any(random);
  BenchTable data = ThermalPositions(tool, bench, 0, 96, 30, 30.1, random);
  const int inclination = *data.Find("inc");
  for (int i = 0; i < data.rows(); ++i) data.values(i, inclination) += i % 2 == 0 ? 0.3 : -0.3;
  ToolFitSetup setup;
  setup.reference.latitude = 60 * kRad;
  const std::vector<BenchTable> tables = {data};
  const auto fit = FitTool(tables, setup);
  ASSERT_TRUE(fit.has_value()) << fit.fault().text;
  EXPECT_TRUE(Remarks(*fit, "attitudes repeat to"));
}

TEST(ToolFit, ADriftBeyondItsPriorIsTold) {
  Random random(33);
  Bench b{ThermalTool::Any(random), ThermalBench::Any(random), {}};
  b.bench.drift[0][0] = 1;
  b.tables.push_back(ThermalPositions(b.tool, b.bench, 0, 120, 25, 150, random));
  b.tables.push_back(ThermalPositions(b.tool, b.bench, 1, 60, 150, 25, random));
  b.tables.push_back(ThermalRates(b.tool, b.bench, 87.5, random));
  const auto fit = FitTool(b.tables, Stated());
  ASSERT_TRUE(fit.has_value()) << fit.fault().text;
  EXPECT_THAT(DriftsTold(*fit),
              Contains(testing::StartsWith("gyro_drift_1[0]: the readings ask for")));
}

// Ways in which bench data are not what they should be.
using Corruption = void (*)(Bench& bench, ToolFitSetup& setup, Random& random);

int Column(const BenchTable& data, const char* name) { return *data.Find(name); }

const std::vector<std::pair<const char*, Corruption>> kCorruptions = {
    {"none", [](Bench&, ToolFitSetup&, Random&) {}},
    {"accelerometers in m/s2 in a part of the rows",
     [](Bench& b, ToolFitSetup&, Random&) {
       b.tables[0].values.block(10, Column(b.tables[0], "Gx"), 30, 3) *= 9.80665;
     }},
    {"one gyro in deg/s",
     [](Bench& b, ToolFitSetup&, Random&) {
       for (BenchTable& t : b.tables) t.values.col(Column(t, "m_y1")) /= 3600;
     }},
    {"two channels swapped",
     [](Bench& b, ToolFitSetup&, Random&) {
       BenchTable& t = b.tables[0];
       t.values.col(Column(t, "Gx")).swap(t.values.col(Column(t, "Gy")));
     }},
    {"a sign",
     [](Bench& b, ToolFitSetup&, Random&) {
       for (BenchTable& t : b.tables) t.values.col(Column(t, "m_x1")) *= -1;
     }},
    {"outliers",
     [](Bench& b, ToolFitSetup&, Random& random) {
       BenchTable& t = b.tables[0];
       for (int k = 0; k < 8; ++k) {
         const auto row = static_cast<Eigen::Index>(random.Uniform() * t.rows());
         t.values(row, Column(t, "Gx") + k % 3) += 0.1 * random.Normal();
         t.values(row, Column(t, "m_x1") + k % 4) += 20 * random.Normal();
       }
     }},
    {"drift that bends",
     [](Bench& b, ToolFitSetup&, Random& random) {
       BenchTable& t = b.tables[0];
       const double size = 0.3 * random.Normal();
       for (int i = 0; i < t.rows(); ++i) {
         const double time = -1 + 2.0 * i / (t.rows() - 1);
         t.values(i, Column(t, "m_x1")) += size * (time * time - 1.0 / 3);
       }
     }},
    {"wrong latitude",
     [](Bench&, ToolFitSetup& setup, Random& random) {
       *setup.reference.latitude += (random.Uniform() < 0.5 ? -1 : 1) * 2 * kRad;
     }},
    {"wrong gravity",
     [](Bench&, ToolFitSetup& setup, Random&) {
       setup.reference.gravity *= 1.002;
       setup.reference.gravity_mps2 *= 1.002;
     }},
    {"a level beyond what was said",
     [](Bench&, ToolFitSetup& setup, Random&) { setup.sigma_level = 0.005 * kRad; }},
    {"no temperatures written down",
     [](Bench& b, ToolFitSetup&, Random&) {
       for (BenchTable& t : b.tables) t.columns[static_cast<std::size_t>(Column(t, "T_C"))] = "X";
     }},
    {"one cone",
     [](Bench& b, ToolFitSetup&, Random&) {
       for (int k = 0; k < 2; ++k) {
         BenchTable& t = b.tables[static_cast<std::size_t>(k)];
         std::vector<Eigen::Index> kept;
         BenchTable cone{t.source, t.columns, {}, {}};
         for (int i = 0; i < t.rows(); ++i) {
           if (t.values(i, Column(t, "inc")) != 45) continue;
           kept.push_back(i);
           cone.lines.push_back(t.lines[static_cast<std::size_t>(i)]);
         }
         cone.values = t.values(kept, Eigen::all);
         t = cone;
       }
       b.tables.pop_back();
     }},
};

// A sentence beside those that every fit has.
bool HasWord(const FitReport& report) {
  return !report.outlier_lines.empty() ||
         std::any_of(report.remarks.begin(), report.remarks.end(),
                     [](const std::string& remark) { return remark.rfind("left out:", 0) != 0; });
}

// The largest error of a tool's parameter over its sigma.
double Worst(const ToolFit& fit, const std::map<std::string, double>& truth) {
  const FitReport& report = fit.calibration.report;
  double worst = 0;
  for (Eigen::Index i = 0; i < report.values.size(); ++i) {
    const std::string& name = report.parameters[static_cast<std::size_t>(i)];
    const auto found = truth.find(name);
    if (!IsOfTheTool(name) || found == truth.end()) continue;
    worst = std::max(worst, std::abs(report.values[i] - found->second) /
                                std::sqrt(std::max(1e-300, report.cov(i, i))));
  }
  return worst;
}

TEST(ToolFit, CorruptedBenchesAreNeverWrongWithoutAWord) {
  Random random(32);
  const int of_each = WELLGYRO_LONG ? 25 : 1;
  int refused = 0, told = 0, sound = 0, silent = 0;
  for (const auto& [name, corrupt] : kCorruptions) {
    const std::string_view few[] = {"one gyro in deg/s", "wrong latitude", "one cone"};
    if (!WELLGYRO_LONG && std::find(few, few + 3, name) == few + 3) continue;
    for (int k = 0; k < of_each; ++k) {
      Bench b = AnyBench(random);
      ToolFitSetup setup = Stated();
      corrupt(b, setup, random);
      const auto fit = FitTool(b.tables, setup);
      if (!fit) {
        ++refused;
        EXPECT_STRNE(name, "none") << fit.fault().text;
        continue;
      }
      // The largest of a hundred passes that once in 160 sound benches.
      constexpr double kLargest = 4;
      const double worst = Worst(*fit, TruthOf(b.tool, b.bench));
      if (HasWord(fit->calibration.report)) {
        ++told;
      } else if (worst < kLargest) {
        ++sound;
      } else {
        ++silent;
        ADD_FAILURE() << name << ": wrong by " << worst << " sigmas without a word";
      }
    }
  }
  std::printf(
      "corrupted benches: %d refused, %d told, %d within four sigmas, %d wrong in silence\n",
      refused, told, sound, silent);
  EXPECT_EQ(silent, 0);
}

}  // namespace
}  // namespace wellgyro::test

// What a bench does not show must be in the covariance, in words, or refused.
#include "fit/tool_claims.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Dense>
#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "wellgyro/calibration/history.h"
#include "wellgyro/calibration/members.h"
#include "wellgyro/fit/position_fit.h"
#include "wellgyro/fit/thermometer_fit.h"
#include "wellgyro/fit/tool_fit.h"
#include "wellgyro/fit/tool_verify.h"

#include "fit/tool_bench.h"
#include "fit/tool_model_truth.h"

namespace wellgyro::test {
namespace {

using testing::HasSubstr;

// A member's error over its sigma, which is not to be more than `most`.
double Normalised(const ToolFit& fit, const std::string& member, double truth, double most) {
  const auto& names = fit.members.names;
  const auto at = std::find(names.begin(), names.end(), member) - names.begin();
  if (at == static_cast<std::ptrdiff_t>(names.size())) {
    ADD_FAILURE() << "no member " << member;
    return 0;
  }
  const double sigma = std::sqrt(fit.members.cov(at, at));
  EXPECT_LT(sigma, most) << member;
  return (fit.member_values[at] - truth) / sigma;
}

// Sensitivities that change with temperature, seen by the Earth's rate alone where the rate table
// was read at one: too little to be kept as a term, and wrong at the other temperatures.
TEST(ToolClaims, ASensitivityThatNoTableReadWhenHotIsUnsure) {
  Random random(91);
  double worst = 0;
  for (int bench = 0; bench < (WELLGYRO_LONG ? 6 : 1); ++bench) {
    ThermalTool tool = ThermalTool::Any(random);
    ThermalTool at_hot = tool;
    constexpr double change = 5e-4, kPerHour = kRad / 3600;
    at_hot.U.row(0) *= 1 + change;
    const ThermalBench b = ThermalBench::Any(random);
    // Straight in temperature: between the two tools, as far as the ramp has come.
    std::vector<BenchTable> tables;
    for (const int which : {0, 1}) {
      Random same(100 + static_cast<std::uint64_t>(10 * bench + which)), again = same;
      const double from = which == 0 ? 25 : 150, to = which == 0 ? 150 : 25;
      BenchTable table = ThermalPositions(tool, b, which, 120, from, to, same);
      const BenchTable hot = ThermalPositions(at_hot, b, which, 120, from, to, again);
      const int gyro = *table.Find("m_x1"), T = *table.Find("T_C");
      for (int i = 0; i < table.rows(); ++i) {
        const double tau = (table.values(i, T) - 87.5) / 62.5;
        table.values(i, gyro) += tau * (hot.values(i, gyro) - table.values(i, gyro));
      }
      tables.push_back(table);
    }
    tables.push_back(ThermalRates(tool, b, 87.5, random));
    const auto fit = FitTool(tables, AtLatitude(60));
    ASSERT_TRUE(fit.has_value()) << fit.fault().text;
    const std::string name = NameOf({true, CalibrationMember::Kind::kSensitivity, 1, 0, 0});
    const double off = Normalised(*fit, name, change * tool.U(0, 0) / kPerHour, 1e-3 / kPerHour);
    worst = std::max(worst, std::abs(off));
  }
  std::printf("a sensitivity that changes by 5e-4: off by %.2f sigmas at most\n", worst);
  EXPECT_LT(worst, 4);
}

// On a ramp up and down the bend of a drift is a square of the temperature, too small to be kept.
TEST(ToolClaims, ASquareOfTheTemperatureThatADriftTakesIsUnsure) {
  Random random(92);
  double square = 0;
  constexpr int kBenches = WELLGYRO_LONG ? 10 : 2;
  for (int bench = 0; bench < kBenches; ++bench) {
    ThermalTool tool = ThermalTool::Any(random);
    tool.bg[2].setConstant(0.1);
    tool.bg[3].setZero();
    const ThermalBench b = ThermalBench::Any(random);
    const std::vector<BenchTable> tables = {ThermalPositions(tool, b, 0, 120, 25, 150, random),
                                            ThermalPositions(tool, b, 1, 120, 150, 25, random),
                                            ThermalRates(tool, b, 87.5, random)};
    const auto fit = FitTool(tables, AtLatitude(60));
    ASSERT_TRUE(fit.has_value()) << fit.fault().text;
    const auto bias = [&](int power, double truth) {
      const std::string name = NameOf({true, CalibrationMember::Kind::kBias, power, 1, 0});
      square += std::pow(Normalised(*fit, name, truth, 0.15), 2) / (2 * kBenches);
    };
    bias(0, tool.bg[0][1]);
    bias(2, tool.bg[2][1]);
  }
  std::printf("a square of .1 deg/h beside a drift: squares %.2f\n", square);
  EXPECT_LT(square, 4);
}

TEST(ToolClaims, TheOtherHemisphereIsTold) {
  Random random(93);
  const ThermalTool tool = ThermalTool::Any(random);
  ThermalBench south = ThermalBench::Any(random);
  south.latitude = -35;
  const std::vector<BenchTable> tables = {ThermalPositions(tool, south, 0, 120, 25, 150, random),
                                          ThermalPositions(tool, south, 1, 60, 150, 25, random),
                                          ThermalRates(tool, south, 87.5, random)};
  const auto right = FitTool(tables, AtLatitude(-35));
  ASSERT_TRUE(right.has_value()) << right.fault().text;
  EXPECT_FALSE(Says(right->calibration.report, "is the latitude's sign right?"));
  // The tool's own force terms, some deg/h/g, stand beside twice the Earth's rate.
  const auto wrong = FitTool(tables, AtLatitude(35));
  ASSERT_TRUE(wrong.has_value()) << wrong.fault().text;
  EXPECT_TRUE(Says(wrong->calibration.report, "is the latitude's sign right?"));
}

// What stepped on the way is told by where it did, or by the stretch that does not belong to the
// rest.
TEST(ToolClaims, AStepOfASensorIsTold) {
  Random random(95);
  const ThermalTool tool = ThermalTool::Any(random);
  const ThermalBench bench = ThermalBench::Any(random);
  const std::vector<BenchTable> sound = {ThermalPositions(tool, bench, 0, 120, 25, 150, random),
                                         ThermalPositions(tool, bench, 1, 60, 150, 25, random),
                                         ThermalRates(tool, bench, 87.5, random)};
  const auto said = [](const std::vector<BenchTable>& tables) {
    const auto fit = FitTool(tables, AtLatitude(60));
    EXPECT_TRUE(fit.has_value()) << fit.fault().text;
    const FitReport& report = fit->calibration.report;
    return Says(report, "beside those before") || Says(report, "readings in a row") ||
           Says(report, "accelerometers do not drift so");
  };
  int false_alarms = said(sound) ? 1 : 0;
  for (int more = 1; more < (WELLGYRO_LONG ? 60 : 1); ++more) {
    const ThermalBench other = ThermalBench::Any(random);
    false_alarms += said({ThermalPositions(tool, other, 0, 120, 25, 150, random),
                          ThermalPositions(tool, other, 1, 60, 150, 25, random),
                          ThermalRates(tool, other, 87.5, random)})
                        ? 1
                        : 0;
  }
  std::printf("sound benches told of a step: %d\n", false_alarms);
  EXPECT_LE(false_alarms, WELLGYRO_LONG ? 3 : 0);  // one in a hundred
  for (const auto& [channel, step] : {std::pair("m_x1", 0.3), std::pair("Gx", 3e-4)}) {
    std::vector<BenchTable> stepped = sound;
    stepped[0].values.col(*stepped[0].Find(channel)).tail(60).array() += step;
    EXPECT_TRUE(said(stepped)) << channel;
  }
}

using Wrong = void (*)(BenchTable& positions);

// What happens to single rows of positions, with the lines that must go.
struct WrongRows {
  const char* name;
  Wrong make;
  std::vector<int> lines;
};

const std::vector<WrongRows> kWrongRows = {
    {"0.01 g", [](BenchTable& t) { t.values(7, *t.Find("Gx")) += 0.01; }, {9}},
    {"1 g", [](BenchTable& t) { t.values(7, *t.Find("Gx")) += 1; }, {9}},
    {"1000 g", [](BenchTable& t) { t.values(7, *t.Find("Gx")) += 1000; }, {9}},
    {"an inclination misread", [](BenchTable& t) { t.values(20, *t.Find("inc")) += 9; }, {22}},
    {"another position's label",
     [](BenchTable& t) { t.values.row(10).segment(2, 3) = t.values.row(40).segment(2, 3); },
     {12}},
    {"readings of two rows exchanged",
     [](BenchTable& t) {
       const Eigen::Index n = t.values.cols() - 5;
       t.values.row(10).tail(n).swap(t.values.row(11).tail(n));
     },
     {12, 13}},
};

// Least squares spread a wrong row over all the others. From 0.1 g on it hid in noise
// that had grown by it; or the rate table's rows went in its place.
void ExpectLeftOut(std::vector<BenchTable> tables, const WrongRows& wrong) {
  wrong.make(tables.front());
  const auto fit = FitTool(tables, AtLatitude(60));
  ASSERT_TRUE(fit.has_value()) << wrong.name << ": " << fit.fault().text;
  EXPECT_EQ(fit->calibration.report.outlier_lines, wrong.lines) << wrong.name;
}

TEST(ToolClaims, WrongRowsAloneAreLeftOut) {
  Random random(96);
  const std::vector<BenchTable> room = SmallBench(false, random);
  for (const WrongRows& wrong : kWrongRows) ExpectLeftOut(room, wrong);
  const std::vector<BenchTable> chamber = SmallBench(true, random);
  const std::size_t first = WELLGYRO_LONG ? 0 : kWrongRows.size() - 2;
  for (std::size_t k = first; k < kWrongRows.size(); ++k) ExpectLeftOut(chamber, kWrongRows[k]);
}

// 0.1 deg of a stand's dial passed for noise, with the bias of z ten sigmas off: its
// sine has a mean over the attitudes. Beside that it has a pattern of its own.
TEST(ToolClaims, AStandsZeroOfInclinationIsFound) {
  Random random(99);
  std::vector<BenchTable> tables = SmallBench(false, random);
  const auto sound = FitTool(tables, AtLatitude(60));
  ASSERT_TRUE(sound.has_value()) << sound.fault().text;
  tables[0].values.col(*tables[0].Find("inc")).array() += 0.1;
  const auto off = FitTool(tables, AtLatitude(60));
  ASSERT_TRUE(off.has_value()) << off.fault().text;
  ASSERT_EQ(off->members.names, sound->members.names);
  const Eigen::VectorXd sigma = sound->members.cov.diagonal().cwiseSqrt();
  // The prior of 0.05 deg draws by 1e-4 of the angle at most, which is known to 1e-5 rad.
  EXPECT_LT((off->member_values - sound->member_values).cwiseQuotient(sigma).cwiseAbs().maxCoeff(),
            0.1);
  const auto zero = std::find_if(off->nuisances.begin(), off->nuisances.end(),
                                 [](const BenchNuisance& n) { return n.name == "inclination_1"; });
  ASSERT_NE(zero, off->nuisances.end());
  EXPECT_LT(zero->sigma, 1e-4);
  EXPECT_LT(std::abs(zero->value + 0.1 * kRad), 4 * zero->sigma);
}

constexpr const char* kTableTold = "measure that table again";

// Of two sweeps of a chamber, up and down, one per cent or ten degrees of one passed for noise or
// heating.
TEST(ToolClaims, ATableThatContradictsTheOthersIsTold) {
  Random random(100);
  std::vector<BenchTable> sound = SmallBench(true, random);
  const char* const names[] = {"up.csv", "down.csv", "rates.csv"};
  for (std::size_t t = 0; t < sound.size(); ++t) sound[t].source = names[t];
  EXPECT_EQ(RemarkOf(sound, kTableTold), "");
  std::vector<BenchTable> gain = sound, warm = sound, rates = SmallBench(false, random);
  gain[0].values.col(*gain[0].Find("Gx")) *= 1.01;
  EXPECT_THAT(RemarkOf(gain, kTableTold), HasSubstr("channel Gx reads"));
  warm[1].values.col(*warm[1].Find("T_C")).array() += 10;
  EXPECT_THAT(RemarkOf(warm, kTableTold), HasSubstr("the readings suit temperatures"));
  rates[1].values.col(*rates[1].Find("m_x1")) *= 1.01;
  EXPECT_THAT(RemarkOf(rates, kTableTold), HasSubstr("channel m_x1 reads"));
  ExpectRarelyTold(kTableTold, WELLGYRO_LONG, random);
}

// A tool of one rotor and a gyro beside it: the rotor's channels have its terms, the other its own.
TEST(ToolClaims, ARotorBesideAnotherGyroHasItsAnisoelasticTerms) {
  Random random(98);
  ThermalTool tool = ThermalTool::Any(random);
  tool.heating.setZero();
  tool.N << 0.2, -0.2, 0, 0;
  tool.MQ[0].tail(2).setZero();
  tool.MQ[1].setZero();
  const ThermalBench bench = ThermalBench::Any(random);
  std::vector<BenchTable> tables = {ThermalPositions(tool, bench, 0, 84, 25, 25.1, random),
                                    ThermalRates(tool, bench, 25, random)};
  for (BenchTable& table : tables) {
    table = WithoutColumns(table, {"m_x2"});
    table.columns[static_cast<std::size_t>(*table.Find("m_z2"))] = "m_z";
  }
  const auto fit = FitTool(tables, AtLatitude(60));
  ASSERT_TRUE(fit.has_value()) << fit.fault().text;
  const double to_si = 9.8192 * 9.8192;
  EXPECT_LT(std::abs(Normalised(*fit, "gyro.g_squared[0,5]", 0.2 / to_si, 0.05 / to_si)), 4);
  EXPECT_LT(std::abs(Normalised(*fit, "gyro.g_squared[1,4]", -0.2 / to_si, 0.05 / to_si)), 4);
  EXPECT_LT(std::abs(Normalised(*fit, "gyro.g_dependence.p0[2,0]", 0, 0.01)), 4);
}

// They were told as unknowns that no reading determines, or in remarks, or in none at all: gyros in
// deg/s throughout had sensitivities of 1/3600.
TEST(ToolClaims, RatesInAnotherUnitAreRefused) {
  Random random(97);
  const std::vector<BenchTable> sound = SmallBench(true, random);
  const auto said = [](const std::vector<BenchTable>& tables) {
    const auto fit = FitTool(tables, AtLatitude(60));
    return fit ? std::string("nothing") : fit.fault().text;
  };
  for (const double factor : {1.0 / 3600, kRad / 3600}) {  // deg/s, rad/s
    std::vector<BenchTable> table = sound, all = sound;
    table.back().values.rightCols(2) *= factor;
    EXPECT_THAT(said(table), HasSubstr("for one deg/h")) << factor;
    for (BenchTable& data : all) data.values.rightCols(2) *= factor;
    EXPECT_THAT(said(all), HasSubstr("for one deg/h")) << factor;
  }
  for (const double factor : {3600.0, kRad, 1.0 / 6}) {  // deg/h, rad/s, rpm
    std::vector<BenchTable> rates = sound;
    rates.back().values.col(*rates.back().Find("rate_deg_s")) *= factor;
    EXPECT_THAT(said(rates), HasSubstr("for one deg/h")) << factor;
  }
  // Of readings at rest alone the fit must say it.
  std::vector<BenchTable> rest = {SmallBench(false, random)[0]};
  rest[0].values.rightCols(2) /= 3600;
  EXPECT_THAT(said(rest), HasSubstr("for one deg/h"));
}

TEST(ToolClaims, ColumnsMisnamedByACapitalOrAUnitAreRefused) {
  Random random(94);
  const auto tool = ThermalTool::Any(random);
  const auto bench = ThermalBench::Any(random);
  const BenchTable sound = ThermalPositions(tool, bench, 0, 48, 25, 40, random);
  for (const auto& [from, to] :
       {std::pair("Gx", "gx"), {"Gx", "Gx[g]"}, {"m_x1", "M_X1"}, {"T_C", "t_c"}}) {
    BenchTable data = sound;
    data.columns[static_cast<std::size_t>(*data.Find(from))] = to;
    const auto fit = FitTool({&data, 1}, AtLatitude(60));
    ASSERT_FALSE(fit.has_value()) << to;
    EXPECT_THAT(fit.fault().text, HasSubstr("would not be read: its name is " + std::string(from)));
  }
}

// Half a table in mg: the complaint names that table, by lines of its own file.
TEST(ToolClaims, AComplaintStandsWhereTheReadingsAre) {
  Random random(97);
  const auto tool = ThermalTool::Any(random);
  const auto bench = ThermalBench::Any(random);
  std::vector<BenchTable> tables{ThermalPositions(tool, bench, 0, 120, 25, 150, random),
                                 ThermalPositions(tool, bench, 1, 60, 150, 25, random),
                                 ThermalRates(tool, bench, 87.5, random)};
  constexpr int kHead = 5;  // lines above the first reading
  for (std::size_t i = 0; i < tables.size(); ++i) {
    tables[i].source = fmt::format("table-{}.csv", i);
    for (int k = 0; k < tables[i].rows(); ++k) {
      tables[i].lines[static_cast<std::size_t>(k)] = kHead + k;
    }
  }
  tables[1].values.col(*tables[1].Find("Gx")).tail(30) *= 1e3;
  const auto fit = FitTool(tables, AtLatitude(60));
  ASSERT_FALSE(fit.has_value());
  EXPECT_THAT(fit.fault().text, HasSubstr("the readings do not fit"));
  EXPECT_EQ(fit.fault().source, "table-1.csv");
  EXPECT_GE(fit.fault().line, kHead + 30);
  EXPECT_LT(fit.fault().line, kHead + 60);
  EXPECT_THAT(fit.fault().text, HasSubstr(fmt::format("worst in lines {}, ", fit.fault().line)));
  EXPECT_THAT(fit.fault().text, HasSubstr(" of table-1.csv: look there"));
  // What is said of all names all; a channel is named where it tells most.
  tables[1].values.col(*tables[1].Find("Gx")).tail(30) *= 1e-3;
  for (BenchTable& data : tables) data.values.col(*data.Find("m_x1")) *= -1;
  const auto turned = FitTool(tables, AtLatitude(60));
  ASSERT_FALSE(turned.has_value());
  EXPECT_THAT(turned.fault().text, HasSubstr("channel m_x1 falls"));
  EXPECT_EQ(turned.fault().source, "table-2.csv");
}

TEST(ToolClaims, VerificationAsksForTheTemperature) {
  Random random(95);
  ThermalTool tool = ThermalTool::Any(random);
  tool.heating.setZero();
  ToolCalibration model = ModelOf(tool);
  ThermalBench bench = ThermalBench::Any(random);
  BenchTable data = ThermalPositions(tool, bench, 0, 48, 20, 20.1, random);
  VerifySetup setup;
  setup.bench = AtLatitude(60);
  setup.bench.sigma_accel = 2e-5;
  setup.bench.sigma_gyro = 0.02;
  const auto cold = VerifyTool(data, model, setup);
  ASSERT_TRUE(cold.has_value()) << cold.fault().text;
  ASSERT_TRUE(cold->beyond.has_value());
  EXPECT_NEAR(cold->beyond->first, 20, 1e-9);
  const auto T = static_cast<std::size_t>(*data.Find("T_C"));
  data.columns[T] = "remark";
  const auto without = VerifyTool(data, model, setup);
  ASSERT_FALSE(without.has_value());
  EXPECT_THAT(without.fault().text, HasSubstr("no column T_C"));
}

// Temperatures that rise from row to row are what the thermometers' errors follow, and their order
// says nothing beside them.
TEST(BenchClaims, TemperaturesThatRiseAreNoDrift) {
  Random random(96);
  int told = 0;
  constexpr int kBenches = 20;
  for (int bench = 0; bench < kBenches; ++bench) {
    TableMaker table({"t_m", "ref1", "ref2"});
    for (int i = 0; i < 30; ++i) {
      const double t = 20 + 125.0 * i / 29, truth = t + 0.4 - 0.003 * t;
      table.Add({t + 0.05 * random.Normal(), truth + 0.05 * random.Normal(),
                 truth + 0.05 * random.Normal()});
    }
    const auto fit = FitThermometer(table.Finish(), {});
    ASSERT_TRUE(fit.has_value()) << fit.fault().text;
    told += Says(fit->report, "the order of the readings") ? 1 : 0;
  }
  EXPECT_LE(told, 2);
}

TEST(BenchClaims, OneCalibrationIsGivenOnce) {
  Random random(97);
  std::vector<ToolCalibration> all;
  for (const int day : {0, 60, 60}) {
    ToolCalibration model = ModelOf(ThermalTool::Any(random));
    model.asset_serial = "T1";
    ParameterCovariance known;
    known.names = {"gyro.bias.p0[0]"};
    known.cov = Eigen::MatrixXd::Constant(1, 1, 1e-4);
    model.gyro.covariance = known;
    model.calibrated = UtcTime{86'400'000'000'000LL * (20'000 + day)};
    all.push_back(model);
  }
  EXPECT_THROW(HistoriesOf(all, {.temperature = 87.5}), std::invalid_argument);
  all.pop_back();
  EXPECT_EQ(HistoriesOf(all, {.temperature = 87.5}).size(), 1u);
}

}  // namespace
}  // namespace wellgyro::test

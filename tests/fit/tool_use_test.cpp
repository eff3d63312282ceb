// From the joint calibration to what is done with it: errors of samples, verification, history.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "wellgyro/calibration/apply.h"
#include "wellgyro/calibration/error_sources.h"
#include "wellgyro/calibration/history.h"
#include "wellgyro/calibration/members.h"
#include "wellgyro/fit/tool_verify.h"
#include "wellgyro/math/statistics.h"

#include "fit/tool_bench.h"
#include "fit/tool_model_truth.h"

namespace wellgyro::test {
namespace {

// A covariance of biases, sensitivities and force terms at two powers, all of them correlated.
ParameterCovariance AnyCovariance(Random& random) {
  ParameterCovariance known;
  std::vector<double> sigma;
  const double per_h = kRad / 3600;
  for (const bool gyro : {true, false}) {
    for (int power = 0; power < 2; ++power) {
      for (int c = 0; c < (gyro ? 4 : 3); ++c) {
        known.names.push_back(NameOf({gyro, CalibrationMember::Kind::kBias, power, c, 0}));
        sigma.push_back(gyro ? 0.02 : 2e-5);
        for (int j = 0; j < 3; ++j) {
          known.names.push_back(NameOf({gyro, CalibrationMember::Kind::kSensitivity, power, c, j}));
          sigma.push_back(gyro ? 1e-4 / per_h : 2e-5 / kG);
          if (!gyro) continue;
          known.names.push_back(NameOf({gyro, CalibrationMember::Kind::kForce, power, c, j}));
          sigma.push_back(0.01 / kG);
        }
      }
    }
  }
  const auto n = static_cast<Eigen::Index>(known.names.size());
  Eigen::MatrixXd root = Eigen::MatrixXd::Identity(n, n);
  for (double& element : root.reshaped()) element += 0.1 * random.Normal();
  const Eigen::MatrixXd r = root * root.transpose();
  const Eigen::VectorXd s = Eigen::Map<const Eigen::VectorXd>(sigma.data(), n);
  known.cov = s.asDiagonal() * r * s.asDiagonal();
  return known;
}

// Members moved by one draw of the covariance.
ToolCalibration Drawn(const ToolCalibration& model, const ParameterCovariance& known,
                      Random& random) {
  const Eigen::MatrixXd L = known.cov.llt().matrixL();
  Eigen::VectorXd z(L.cols());
  for (double& value : z) value = random.Normal();
  const Eigen::VectorXd move = L * z;
  ToolCalibration drawn = model;
  for (Eigen::Index k = 0; k < move.size(); ++k) {
    ValueOf(drawn, MemberOf(known.names[static_cast<std::size_t>(k)])) += move[k];
  }
  return drawn;
}

// A sample of the model, its counts by the formula of SensorGroup alone.
RawSample Sampled(const ThermalTool& tool, const Eigen::Vector3d& w_T, const Eigen::Vector3d& f_T,
                  double T) {
  // Bench x is -y of the tool, bench y its x.
  const auto bench = [](const Eigen::Vector3d& a) { return Eigen::Vector3d(-a.y(), a.x(), a.z()); };
  RawSample raw;
  raw.n_channels = 7;
  raw.n_temperatures = 1;
  raw.temperature_raw[0] = static_cast<float>(T);
  raw.stamp.period_ns = 10'000'000;
  const double tau = (T - 87.5) / 62.5;
  const Eigen::Vector3d a = tool.Accel(-bench(f_T) / kG, tau);
  const Eigen::Vector4d m = tool.Gyro(bench(w_T) / (kRad / 3600), bench(f_T) / kG, tau, 0);
  for (int c = 0; c < 7; ++c) {
    const double value = c < 3 ? a[c] : m[c - 3];
    raw.counts[static_cast<std::size_t>(c)] = static_cast<std::int32_t>(std::lround(value * 1e6));
  }
  return raw;
}

struct Sensed {
  Eigen::Vector3d w, f;
};
Sensed By(const ToolCalibration& model, const RawSample& raw) {
  SampleCalibrator calibrator(model);
  ImuSample out;
  EXPECT_EQ(calibrator.Apply({&raw, 1}, {&out, 1}), 1u);
  return {out.w_IT_T, out.f_T};
}

// Draws of the calibration against its covariance: what the calibrated samples are off by has the
// sources' covariance, at cold, middle and hot.
TEST(ToolUse, ErrorsOfSamplesAreThoseOfTheCalibration) {
  Random random(41);
  const ThermalTool tool = ThermalTool::Any(random);
  ToolCalibration model = ModelOf(tool);
  const ParameterCovariance known = AnyCovariance(random);
  model.gyro.covariance = known;
  constexpr int kDraws = 300;
  for (const double T : {30.0, 87.5, 145.0}) {
    const CalibrationSources sources = SourcesOf(model, T);
    double square = 0, number = 0;
    for (int draw = 0; draw < kDraws; ++draw) {
      const ToolCalibration drawn = Drawn(model, known, random);
      const Eigen::Vector3d w = 7e-5 * Noise(random, 1).normalized();
      const Eigen::Vector3d f = kG * Noise(random, 1).normalized();
      const RawSample raw = Sampled(tool, w, f, T);
      const Sensed is = By(model, raw), off = By(drawn, raw);
      Eigen::Matrix<double, 6, 1> e;
      e << off.w - is.w, off.f - is.f;
      EXPECT_LT((is.f - f).norm(), 5e-5);
      Eigen::MatrixXd H = Eigen::MatrixXd::Zero(6, sources.cov.rows());
      for (int i = 0; i < 3; ++i) {
        H(i, i) = 1;
        H.block<1, 3>(i, sources.At("gyro_scale_x") + 3 * i) = w.transpose();
        H.block<1, 3>(i, sources.At("gyro_force_xx") + 3 * i) = f.transpose();
        H(3 + i, sources.At("accel_bias_x") + i) = 1;
        H.block<1, 3>(3 + i, sources.At("accel_scale_x") + 3 * i) = f.transpose();
      }
      const Eigen::MatrixXd cov = H * sources.cov * H.transpose();
      square += e.dot(cov.ldlt().solve(e));
      number += 6;
    }
    // 99.9 % of chi-square over so many.
    EXPECT_NEAR(square / number, 1, 3.3 * std::sqrt(2 / number)) << T;
  }
}

// The tool's priors are the largest of each kind, of the sensors that were calibrated alone.
TEST(ToolUse, ErrorsLeftAreThoseOfTheSensorsOnTheBench) {
  Random random(45);
  ToolCalibration model = ModelOf(ThermalTool::Any(random));
  ErrorPriors before;
  before.gyro_bias_sigma = before.gyro_scale_sigma = before.accel_noise = 1;
  const double per_h = kRad / 3600;
  ParameterCovariance known;
  known.names = {"accel.bias.p0[1]", "accel.sensitivity.p0[2,2]", "accel.sensitivity.p0[0,1]"};
  known.cov = Eigen::Vector3d(1e-10, 4e-10 / (kG * kG), 9e-10 / (kG * kG)).asDiagonal();
  model.accel.covariance = known;
  const ErrorPriors accel = ErrorsLeft(model, before);
  // In g as the channels read; their sensitivities are one to a per cent.
  EXPECT_NEAR(accel.accel_bias_sigma, 1e-5 * kG, 3e-7 * kG);
  EXPECT_NEAR(accel.accel_scale_sigma, 2e-5, 6e-7);
  EXPECT_NEAR(accel.accel_misalignment_sigma, 3e-5, 9e-7);
  EXPECT_EQ(accel.gyro_bias_sigma, 1);
  EXPECT_EQ(accel.gyro_scale_sigma, 1);
  EXPECT_EQ(accel.accel_noise, 1);
  model.accel.covariance.reset();
  EXPECT_EQ(ErrorsLeft(model, before).accel_bias_sigma, before.accel_bias_sigma);
  known.names = {"gyro.bias.p0[1]", "gyro.bias.p1[1]"};
  known.cov = Eigen::Vector2d(9e-4, 16e-4).asDiagonal();
  model.gyro.covariance = known;
  // At the ends of the range, where tau is one.
  EXPECT_NEAR(ErrorsLeft(model, before).gyro_bias_sigma, 0.05 * per_h, 1e-3 * per_h);
}

TEST(ToolUse, NamesOfMembersComeBack) {
  Random random(42);
  for (const std::string& name : AnyCovariance(random).names)
    EXPECT_EQ(NameOf(MemberOf(name)), name);
  for (const char* wrong : {"gyro.bias[0]", "gyro.bias.p4[0]", "accel.sensitivity.p0[0,3]", "x",
                            "gyro.heating[0", "gyro.heating[-1]", "accel.second_order[1,6]"}) {
    EXPECT_THROW(MemberOf(wrong), std::invalid_argument) << wrong;
  }
}

// A bench of 24 positions as found, after a shift.
BenchTable AsFound(const ThermalTool& tool, const Eigen::Vector4d& shift, Random& random) {
  ThermalBench bench = ThermalBench::Any(random);
  bench.latitude_error = 0;
  bench.drift[0].setZero();
  ThermalTool shifted = tool;
  shifted.bg[0] += shift;
  return ThermalPositions(shifted, bench, 0, 24, 87.4, 87.5, random);
}

// What AsFound()'s bench is known by.
VerifySetup AsTheBenchIs() {
  VerifySetup setup;
  setup.bench.reference.latitude = 60 * kRad;
  setup.bench.sigma_accel = 2e-5;
  setup.bench.sigma_gyro = 0.02;
  setup.bench.sigma_wobble = 20 * kRad / 3600;
  setup.bench.sigma_level = 0.3 * kRad;
  setup.bench.sigma_north = 0.5 * kRad;
  return setup;
}

/// A tool that does not heat itself, and its model, without errors.
struct ColdTool {
  explicit ColdTool(Random& random) : tool(ThermalTool::Any(random)), model(ModelOf(tool)) {
    model.gyro.heating.setZero();
    tool.heating.setZero();
  }
  ThermalTool tool;
  ToolCalibration model;
};

TEST(ToolUse, AShiftOfThreeSigmasIsFound) {
  Random random(43);
  auto [tool, model] = ColdTool(random);
  VerifySetup setup = AsTheBenchIs();
  // The calibration's own errors, of an ordinary bench.
  ParameterCovariance known;
  for (int c = 0; c < 4; ++c) {
    known.names.push_back(NameOf({true, CalibrationMember::Kind::kBias, 0, c, 0}));
  }
  known.cov = 1e-4 * Eigen::Matrix4d::Identity();
  model.gyro.covariance = known;
  const double budget = 0.05;  // deg/h, one sigma
  setup.budget_gyro_bias = budget;
  const int tools = WELLGYRO_LONG ? 1000 : 60;
  int alarms = 0, found = 0;
  for (int i = 0; i < tools; ++i) {
    const ToolCalibration drawn = Drawn(model, known, random);
    for (const double size : {0.0, 3 * budget}) {
      const int channel = i % 4;
      Eigen::Vector4d shift = Eigen::Vector4d::Zero();
      shift[channel] = i % 8 < 4 ? size : -size;
      const auto verified = VerifyTool(AsFound(tool, shift, random), drawn, setup);
      ASSERT_TRUE(verified.has_value()) << verified.fault().text;
      int shifted = 0;
      bool the_one = false;
      for (const ToolShift& s : verified->shifts) {
        shifted += s.shifted ? 1 : 0;
        the_one = the_one || (s.shifted && s.name == "gyro_b[" + std::to_string(channel) + "]");
      }
      if (size == 0) alarms += shifted > 0 ? 1 : 0;
      if (size > 0) found += the_one ? 1 : 0;
    }
  }
  std::printf("%d tools: a shift of three sigmas found in %.1f %%, false alarms in %.1f %%\n",
              tools, 100.0 * found / tools, 100.0 * alarms / tools);
  EXPECT_GE(found, 0.95 * tools);
  // 1 %, and what chance makes of it.
  EXPECT_LE(alarms, 0.01 * tools + 3 * std::sqrt(0.01 * tools));
}

// By its own printed sigma a shift of n sigmas is found where its estimate, n + N(0, 1), passes the
// reach of chance r: in Phi(n - r) of tools. Three sigmas are found in 31 % at r = 3.5, for 1 % of
// false alarms over 19 shifts (in 66 % of one shift alone, r = 2.58); 95 % need r + 1.64 sigmas.
TEST(ToolUse, AShiftIsFoundAsOftenAsItsSigmaSays) {
  Random random(47);
  auto [tool, model] = ColdTool(random);
  const VerifySetup setup = AsTheBenchIs();
  const Eigen::Vector4d none = Eigen::Vector4d::Zero();
  const auto first = VerifyTool(AsFound(tool, none, random), model, setup);
  ASSERT_TRUE(first.has_value()) << first.fault().text;
  const int tools = WELLGYRO_LONG ? 1000 : 100;
  constexpr double k95 = 1.645;
  for (const double size : {3.0, first->reach + k95}) {
    int found = 0;
    double expected = 0;
    for (int i = 0; i < tools; ++i) {
      // Attitudes are drawn anew each time, and the sigma with them: it is taken of the same ones.
      Random same = random;
      const auto sound = VerifyTool(AsFound(tool, none, same), model, setup);
      ASSERT_TRUE(sound.has_value()) << sound.fault().text;
      const std::string name = "gyro_b[" + std::to_string(i % 4) + "]";
      const auto sigma =
          std::find_if(sound->shifts.begin(), sound->shifts.end(), [&](const ToolShift& s) {
            return s.name == name;
          })->sigma;
      const auto shifted = VerifyTool(
          AsFound(tool, size * sigma * Eigen::Vector4d::Unit(i % 4), random), model, setup);
      ASSERT_TRUE(shifted.has_value()) << shifted.fault().text;
      found += std::any_of(shifted->shifts.begin(), shifted->shifts.end(),
                           [&](const ToolShift& s) { return s.name == name && s.shifted; });
      expected += NormalCdf(size - shifted->reach);
    }
    std::printf("%d tools: a shift of %.2f of its own sigmas found in %.1f %%, expected %.1f %%\n",
                tools, size, 100.0 * found / tools, 100.0 * expected / tools);
    const double p = expected / tools;
    EXPECT_NEAR(found, expected, 4 * std::sqrt(tools * p * (1 - p)));
  }
}

// Rows of a table with these settings.
BenchTable Only(const BenchTable& data, const std::function<bool(double inc, double tf)>& keeps) {
  BenchTable only{data.source, data.columns, {}, {}};
  std::vector<Eigen::Index> rows;
  for (int i = 0; i < data.rows(); ++i) {
    if (!keeps(data.values(i, *data.Find("inc")), data.values(i, *data.Find("tf")))) continue;
    rows.push_back(i);
    only.lines.push_back(data.lines[static_cast<std::size_t>(i)]);
  }
  only.values = data.values(rows, Eigen::all);
  return only;
}

BenchTable AllPositions(const ThermalTool& tool, Random& random) {
  ThermalBench bench = ThermalBench::Any(random);
  bench.latitude_error = 0;
  bench.drift[0].setZero();
  return ThermalPositions(tool, bench, 0, 120, 87.4, 87.5, random);
}

const ToolShift& ShiftNamed(const Verification& found, const std::string& name) {
  return *std::find_if(found.shifts.begin(), found.shifts.end(),
                       [&](const ToolShift& shift) { return shift.name == name; });
}

// At one toolface of a horizontal tool bias and mass unbalance are one: shifts of both that cancel
// there passed, and the force term was not on the list.
TEST(ToolUse, WhatThePositionsDoNotTellIsNotVerified) {
  Random random(48);
  auto [tool, model] = ColdTool(random);
  const VerifySetup setup = AsTheBenchIs();
  ThermalTool moved = tool;
  moved.bg[0][0] += 0.5;
  moved.MQ[0][0] -= 0.5;
  const auto at_one = [](double inc, double tf) { return inc == 90 && tf == 0; };
  const auto along = [](double inc, double) { return inc == 0; };
  for (const auto& keeps :
       {std::function<bool(double, double)>(at_one), std::function<bool(double, double)>(along)}) {
    const auto found = VerifyTool(Only(AllPositions(moved, random), keeps), model, setup);
    ASSERT_TRUE(found.has_value()) << found.fault().text;
    EXPECT_NE(found->outcome, VerifyOutcome::kPass);
    EXPECT_EQ(found->shifts.size(), 3u + 4u + 12u);
    EXPECT_FALSE(ShiftNamed(*found, "gyro_G[0,0]").told);
  }
  // Positions all round tell both.
  const auto whole = VerifyTool(AllPositions(moved, random), model, setup);
  ASSERT_TRUE(whole.has_value()) << whole.fault().text;
  EXPECT_TRUE(ShiftNamed(*whole, "gyro_G[0,0]").told);
  EXPECT_TRUE(ShiftNamed(*whole, "gyro_b[0]").shifted);
  EXPECT_EQ(whole->outcome, VerifyOutcome::kFail);
  const auto sound = VerifyTool(AllPositions(tool, random), model, setup);
  ASSERT_TRUE(sound.has_value()) << sound.fault().text;
  EXPECT_EQ(sound->outcome, VerifyOutcome::kPass);
  // A budget finer than the readings cannot be kept, nor broken, by what they say.
  VerifySetup fine = setup;
  fine.budget_gyro_bias = 1e-4;
  const auto coarse = VerifyTool(AllPositions(tool, random), model, fine);
  ASSERT_TRUE(coarse.has_value()) << coarse.fault().text;
  EXPECT_EQ(coarse->outcome, VerifyOutcome::kNotVerified);
}

// They passed for sensitivities ten times too large, or for noise.
TEST(ToolUse, ReadingsInAnotherUnitAreNoShift) {
  Random random(49);
  auto [tool, model] = ColdTool(random);
  BenchTable data = AllPositions(tool, random);
  data.values.middleCols(*data.Find("Gx"), 3) *= 9.80665;
  const auto found = VerifyTool(data, model, AsTheBenchIs());
  ASSERT_FALSE(found.has_value());
  EXPECT_THAT(found.fault().text, testing::HasSubstr("as g and not m/s2"));
}

// A dial set by 0.1 deg, which the bias of z had taken for a shift of 1.5 mg.
TEST(ToolUse, AStandsZeroOfInclinationIsNoShift) {
  Random random(46);
  auto [tool, model] = ColdTool(random);
  VerifySetup setup = AsTheBenchIs();
  BenchTable data = AsFound(tool, Eigen::Vector4d::Zero(), random);
  data.values.col(*data.Find("inc")).array() += 0.1;
  const auto verified = VerifyTool(data, model, setup);
  ASSERT_TRUE(verified.has_value()) << verified.fault().text;
  EXPECT_EQ(verified->outcome, VerifyOutcome::kPass);
  // As exact as a dial that is known to a thousandth of that, it is something else.
  setup.bench.sigma_inclination = 1e-4 * kRad;
  EXPECT_EQ(VerifyTool(data, model, setup)->outcome, VerifyOutcome::kFail);
}

// Neither a bias nor a force term: the shifts may stay within their limits, but nothing fits.
TEST(ToolUse, WhatNoShiftExplainsFails) {
  Random random(45);
  auto [tool, model] = ColdTool(random);
  VerifySetup setup = AsTheBenchIs();
  setup.budget_accel_bias = 1e-2;
  setup.budget_gyro_bias = 1;
  setup.budget_gyro_force = 1;
  const auto sound = VerifyTool(AsFound(tool, Eigen::Vector4d::Zero(), random), model, setup);
  ASSERT_TRUE(sound.has_value()) << sound.fault().text;
  EXPECT_TRUE(sound->fits);
  EXPECT_EQ(sound->outcome, VerifyOutcome::kPass);
  EXPECT_GT(sound->left_dof, 100);
  tool.Sa[0] *= 1.005;
  const auto scaled = VerifyTool(AsFound(tool, Eigen::Vector4d::Zero(), random), model, setup);
  ASSERT_TRUE(scaled.has_value()) << scaled.fault().text;
  EXPECT_TRUE(std::all_of(scaled->shifts.begin(), scaled->shifts.end(),
                          [](const ToolShift& shift) { return shift.within; }));
  EXPECT_FALSE(scaled->fits);
  EXPECT_EQ(scaled->outcome, VerifyOutcome::kFail);
}

TEST(ToolUse, HistoriesTellWalksAndToolsOutOfFamily) {
  Random random(44);
  std::vector<ToolCalibration> all;
  const ParameterCovariance known = AnyCovariance(random);
  for (int t = 0; t < 12; ++t) {
    ToolCalibration model = ModelOf(ThermalTool::Any(random));
    model.asset_serial = "T" + std::to_string(100 + t);
    for (int k = 0; k < 6; ++k) {
      // A walk of 0.01 deg/h a root day; the last tool's is thirty times as large.
      model.gyro.bias[0][1] += (t == 11 ? 0.3 : 0.01) * std::sqrt(60.0) * random.Normal();
      ToolCalibration seen = Drawn(model, known, random);
      seen.gyro.covariance = known;
      seen.calibrated = UtcTime{86'400'000'000'000LL * (20'000 + 60 * k)};
      all.push_back(seen);
    }
  }
  const auto histories = HistoriesOf(all, {.temperature = 87.5, .days_ahead = 60});
  all.back().rests_on_prior = true;
  EXPECT_THROW(HistoriesOf(all, {}), std::invalid_argument);
  ASSERT_EQ(histories.size(), 12u);
  double walk = 0;
  for (const ToolHistory& history : histories) {
    ASSERT_EQ(history.days.size(), 5u);
    EXPECT_NEAR(history.days[0], 60, 1e-9);
    for (const SourceHistory& source : history.sources) {
      // Channel 1 alone senses the bench's y, which is the tool's x.
      const bool is_it = source.name == "gyro_bias_x";
      if (source.out_of_family) {
        EXPECT_EQ(history.asset_serial, "T111") << source.name;
      }
      if (!is_it) continue;
      EXPECT_EQ(source.out_of_family, history.asset_serial == "T111");
      if (history.asset_serial != "T111") walk += std::pow(source.walk_per_sqrt_day, 2) / 11;
      EXPECT_GT(source.prior_sigma.value(), source.walk_per_sqrt_day * std::sqrt(60));
    }
  }
  EXPECT_NEAR(std::sqrt(walk) / (kRad / 3600), 0.01, 0.004);
}

// A walk of which one change is known, or two, is hardly known at all.
/// How many tools' biases of gyro x come to be off by more than so many sigmas of their priors.
int Beyond(double sigmas, const std::vector<ToolHistory>& histories,
           const std::map<std::string, double>& off) {
  int beyond = 0;
  for (const ToolHistory& history : histories) {
    for (const SourceHistory& source : history.sources) {
      if (source.name != "gyro_bias_x") continue;
      beyond +=
          std::abs(off.at(history.asset_serial)) > sigmas * source.prior_sigma.value() ? 1 : 0;
    }
  }
  return beyond;
}

TEST(ToolUse, PriorsForTheNextJobHoldWhatToolsComeTo) {
  Random random(46);
  const ParameterCovariance known = AnyCovariance(random);
  constexpr int kTools = 400;
  for (const int calibrations : {2, 3, 5}) {
    std::vector<ToolCalibration> all;
    std::map<std::string, double> off;
    for (int t = 0; t < kTools; ++t) {
      ToolCalibration model = ModelOf(ThermalTool::Any(random));
      model.asset_serial = "T" + std::to_string(1000 + t);
      const auto walk = [&](double days) {
        model.gyro.bias[0][1] += 0.05 * std::sqrt(days) * random.Normal();
      };
      for (int k = 0; k < calibrations; ++k) {
        if (k > 0) walk(180);
        ToolCalibration seen = Drawn(model, known, random);
        seen.gyro.covariance = known;
        seen.calibrated = UtcTime{86'400'000'000'000LL * (20'000 + 180 * k)};
        all.push_back(seen);
      }
      const double last = all.back().gyro.bias[0][1];
      walk(30);
      off[model.asset_serial] = (model.gyro.bias[0][1] - last) * kRad / 3600;
    }
    const auto histories = HistoriesOf(all, {.temperature = 87.5, .days_ahead = 30});
    const int beyond = Beyond(2, histories, off), far = Beyond(4, histories, off);
    std::printf("%d calibrations: %.1f %% beyond two sigmas, %.1f %% beyond four\n", calibrations,
                100.0 * beyond / kTools, 100.0 * far / kTools);
    // Of Student's distribution with one degree of freedom 6 and 3 %.
    EXPECT_LT(beyond, 0.1 * kTools);
    EXPECT_GT(beyond, 0);
    EXPECT_LT(far, 0.05 * kTools);
  }
}

}  // namespace
}  // namespace wellgyro::test

#include "wellgyro/survey/verdict/checks.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/math/random.h"
#include "wellgyro/record/run_fit.h"
#include "wellgyro/survey/verdict/verdict.h"

namespace wellgyro {
namespace {

Station PassAt(double md, Pass pass, double azimuth_deg, double sigma_deg) {
  Station s;
  s.run = 1;
  s.md = md;
  s.pass = pass;
  s.inclination = FromDegrees(40);
  s.azimuth = FromDegrees(azimuth_deg);
  s.cov_md_inc_azi(1, 1) = std::pow(FromDegrees(0.01), 2);
  s.cov_md_inc_azi(2, 2) = std::pow(FromDegrees(sigma_deg), 2);
  const Eigen::Vector3d across_L(-std::sin(s.azimuth), std::cos(s.azimuth), 0);
  const double sigma_across = FromDegrees(sigma_deg) * std::sin(s.inclination);
  s.cov_tangent_L = sigma_across * sigma_across * across_L * across_L.transpose();
  return s;
}

std::vector<Check> Checks(const Job& job, const std::vector<Station>& passes,
                          const std::vector<NorthFix>& fixes = {}) {
  RunSummary run;
  run.run = 1;
  run.fixes = fixes;
  const std::vector<RunSummary> runs = {run};
  return MakeChecks(job, {runs, passes, {}, {}});
}

const Check& Find(const std::vector<Check>& checks, const std::string& code) {
  for (const Check& check : checks) {
    if (check.code == code) return check;
  }
  static const Check kNone;
  ADD_FAILURE() << code << " is missing";
  return kNone;
}

TEST(Checks, VerdictsFollowTheLimit) {
  EXPECT_EQ(Judge(-1.9, 3), Verdict::kPass);
  EXPECT_EQ(Judge(-2.1, 3), Verdict::kWarn);
  EXPECT_EQ(Judge(3.1, 3), Verdict::kFail);
  EXPECT_EQ(Judge(0, 0), Verdict::kPass);
  EXPECT_EQ(Judge(std::nan(""), 3), Verdict::kFail);
}

/// A station whose tangent has this horizontal part, with the same sigma in all directions.
Station LeaningAt(Pass pass, const Eigen::Vector2d& lean, double sigma) {
  Station s;
  s.run = 1;
  s.md = 120;
  s.pass = pass;
  s.inclination = std::asin(lean.norm());
  s.azimuth = std::atan2(lean.y(), lean.x());
  s.cov_tangent_L.topLeftCorner<2, 2>() = sigma * sigma * Eigen::Matrix2d::Identity();
  s.cov_md_inc_azi(1, 1) = sigma * sigma;
  s.cov_md_inc_azi(2, 2) = std::pow(sigma / lean.norm(), 2);
  return s;
}

// A hole that leans by three to six sigmas of the lean: azimuths are 10 to 20 deg unsure, and their
// errors far from normal. Two passes differ by no more sigmas than their tangents.
TEST(Checks, AzimuthsOfTwoPassesNearVerticalDifferAsTheirTangentsDo) {
  constexpr double kSigma = 5e-4;
  constexpr int kPairs = 4000;
  Random random(31);
  int beyond_2 = 0, beyond_4 = 0;
  for (int i = 0; i < kPairs; ++i) {
    const auto noise = [&] {
      const double north = random.Normal(), east = random.Normal();
      return Eigen::Vector2d(kSigma * north, kSigma * east);
    };
    const Eigen::Vector2d lean(kSigma * (3 + 3.0 * i / kPairs), 0), in = lean + noise(),
                                                                    out = lean + noise();
    const std::vector<Check> checks =
        Checks({}, {LeaningAt(Pass::kIn, in, kSigma), LeaningAt(Pass::kOut, out, kSigma)});
    const Check& check = Find(checks, "azimuth_in_out");
    const double sigmas = std::abs(*check.value / *check.sigma);
    EXPECT_LE(sigmas, (out - in).norm() / (kSigma * std::sqrt(2)) * (1 + 1e-9));
    beyond_2 += sigmas > 2 ? 1 : 0;
    beyond_4 += sigmas > 4 ? 1 : 0;
  }
  // Their bisector goes along with the lengths of both, so that normal errors have 4.55 % beyond
  // two sigmas and these 5.21 %, and 9.7e-5 beyond four: of 4e6 draws of two vectors in a plane.
  // Binomial, 3 sigma.
  EXPECT_NEAR(beyond_2, 208, 3 * 14.1);
  EXPECT_LE(beyond_4, 2);
}

TEST(Checks, TakesTheWorstPairOfPassesForItsSigma) {
  const std::vector<Station> passes = {
      PassAt(100, Pass::kIn, 359.9, 0.1), PassAt(200, Pass::kIn, 10, 1),
      PassAt(200.05, Pass::kOut, 10.5, 1), PassAt(100, Pass::kOut, 0.3, 0.1),
      PassAt(900, Pass::kOut, 0, 0.1)};
  const Check& check = Find(Checks({}, passes), "azimuth_in_out");
  ASSERT_TRUE(check.value && check.sigma && check.md);
  EXPECT_NEAR(*check.value, 0.4, 1e-9) << "across north, the short way";
  // To second order in half of the difference: errors are across each azimuth, not the middle's.
  EXPECT_NEAR(*check.sigma, 0.1 * std::sqrt(2), 1e-5 * 0.1);
  EXPECT_EQ(*check.md, 100);
  EXPECT_EQ(check.limit_source, "3 sigma");
  EXPECT_EQ(check.verdict, Verdict::kWarn);
}

TEST(Checks, TheJobsLimitWins) {
  Job job;
  job.acceptance.azimuth_difference = FromDegrees(0.2);
  const std::vector<Station> passes = {PassAt(100, Pass::kIn, 0, 1),
                                       PassAt(100, Pass::kOut, 0.3, 1)};
  const Check& check = Find(Checks(job, passes), "azimuth_in_out");
  EXPECT_EQ(check.verdict, Verdict::kFail);
  EXPECT_EQ(check.limit_source, "acceptance");
  EXPECT_NEAR(check.limit.value_or(0), 0.2, 1e-12);
}

TEST(Checks, WhatCouldNotBeDoneIsListed) {
  const std::vector<Check> checks = Checks({}, {});
  for (const char* code : {"gravity", "earth_rate", "azimuth_in_out", "inclination_repeat",
                           "foresight", "depth_closure", "grid_convergence"}) {
    const Check& check = Find(checks, code);
    EXPECT_EQ(check.verdict, Verdict::kNotDone) << code;
    EXPECT_FALSE(check.value) << code;
    EXPECT_NE(check.limit_source, "") << code << " says why";
  }
}

TEST(Checks, AStopIsHeldToGravityAndEarthRate) {
  NorthFix fix;
  fix.md = 750;
  fix.gravity = 9.82;
  fix.gravity_ref = 9.81;
  fix.sigma_gravity = 0.002;
  fix.earth_rate = 8 * units::kDegPerHour;
  fix.earth_rate_ref = 7.9 * units::kDegPerHour;
  fix.sigma_earth_rate = 0.1 * units::kDegPerHour;
  const std::vector<Check> checks = Checks({}, {}, {fix});
  EXPECT_EQ(Find(checks, "gravity").verdict, Verdict::kFail);
  EXPECT_NEAR(Find(checks, "gravity").value.value_or(0), 0.01, 1e-12);
  EXPECT_EQ(Find(checks, "earth_rate").verdict, Verdict::kPass);
  EXPECT_NEAR(Find(checks, "earth_rate").value.value_or(0), 0.1, 1e-9);
  EXPECT_EQ(Find(checks, "earth_rate").md.value_or(0), 750);
}

// Dated 2026-11-22: "no stop long enough" stood beside a fix of 298 s.
TEST(Checks, AStopThatTellsNoEarthRateIsNotCalledTooShort) {
  NorthFix fix;
  fix.end.ns = 298'000'000'000;
  const auto why = [](const std::vector<NorthFix>& fixes) {
    return Find(Checks({}, {}, fixes), "earth_rate").limit_source;
  };
  EXPECT_EQ(why({}), "no stop long enough");
  EXPECT_NE(why({fix}).find("hide the Earth's rate at every stop"), std::string::npos);
  fix.external = true;
  EXPECT_EQ(why({fix}), "no stop long enough");
}

TEST(Checks, AStopThatRollsFails) {
  NorthFix fix;
  fix.md = 750;
  fix.roll_rate = -0.15 * units::kDegPerHour;
  fix.sigma_roll_rate = 0.1 * units::kDegPerHour;
  EXPECT_EQ(Find(Checks({}, {}, {fix}), "roll_at_rest").verdict, Verdict::kPass);
  fix.roll_rate = 0.31 * units::kDegPerHour;
  const std::vector<Check> checks = Checks({}, {}, {fix});
  EXPECT_EQ(Find(checks, "roll_at_rest").verdict, Verdict::kFail);
  EXPECT_NEAR(Find(checks, "roll_at_rest").value.value_or(0), 0.31, 1e-9);
  EXPECT_EQ(Find(checks, "roll_at_rest").md.value_or(0), 750);
  EXPECT_EQ(Find(checks, "roll_at_rest").looks, 1);
}

TEST(Checks, OfIndexPositionsTheMostRollIsOneOfMany) {
  NorthFix fix;
  fix.roll_rate = 0.2 * units::kDegPerHour;
  fix.sigma_roll_rate = 0.1 * units::kDegPerHour;
  fix.roll_windows = 4;
  EXPECT_EQ(Find(Checks({}, {}, {fix}), "roll_at_rest").looks, 4);
}

// 2026-11-25: runs of coarsely calibrated tools that warmed at their stops failed by it.
TEST(Checks, AToolThatWarmsSeemsToRollByWhatItsCalibrationLeaves) {
  constexpr double kSigmaPerTau = 2e-3, kHalfRange = 50, kWarmer = 3, kSeconds = 100;
  Job job;
  job.tool.emplace();
  SensorGroup& accel = job.tool->accel;
  accel.n_channels = 3;
  accel.sensitivity[0].topRows<3>() = 2 * Eigen::Matrix3d::Identity();
  accel.thermometer = 0;
  accel.reference = 80;
  accel.half_range = kHalfRange;
  accel.min = 20;
  accel.max = 140;
  job.tool->thermometers.emplace_back();
  accel.covariance = {{"accel.bias.p1[0]"},
                      Eigen::MatrixXd::Constant(1, 1, kSigmaPerTau * kSigmaPerTau)};
  RunSummary run;
  run.run = 1;
  auto fit = std::make_shared<RunFit>();
  for (int k = 0; k < 30; ++k) {
    RunStretch& stretch = fit->stretches.emplace_back();
    stretch.begin = UtcTime{} + Duration::Seconds(20 * k);
    stretch.end = stretch.begin + Duration::Seconds(20);
    stretch.temperature = 60 + kWarmer / kSeconds * (20 * k + 10);
  }
  run.fit = fit;
  NorthFix fix;
  fix.utc_begin = UtcTime{} + Duration::Seconds(200);
  fix.utc_end = fix.utc_begin + Duration::Seconds(kSeconds);
  fix.gravity_ref = 9.8;
  fix.inclination = FromDegrees(30);
  fix.toolface = FromDegrees(-90);
  fix.roll_rate = 0.05 * units::kDegPerHour;
  fix.sigma_roll_rate = 0.01 * units::kDegPerHour;
  run.fixes = {fix};
  // The force across the hole, 4.9, lies along y: what x reads more turns it by that over 4.9.
  const double by_warming = kSigmaPerTau / 2 * (kWarmer / kHalfRange) / 4.9 / kSeconds;
  const double sigma = std::hypot(by_warming, fix.sigma_roll_rate, 1e-3 * units::kDegPerHour);
  const auto checked = [&] {
    const std::vector<RunSummary> runs = {run};
    return Find(MakeChecks(job, {runs, {}, {}, {}}), "roll_at_rest");
  };
  EXPECT_NEAR(checked().sigma.value_or(0), sigma / units::kDegPerHour, 1e-6);
  EXPECT_GT(by_warming, 2 * fix.sigma_roll_rate);
  EXPECT_NE(checked().verdict, Verdict::kFail);
  accel.covariance.reset();
  EXPECT_EQ(checked().verdict, Verdict::kFail);
}

TEST(Checks, BiasesOfLaterStopsAreHeldToTheFirstByWhatTheToolMayDrift) {
  NorthFix first, last;
  first.gyro_bias = Eigen::Vector2d(0.1, 0.2) * units::kDegPerHour;
  first.sigma_gyro_bias.setConstant(0.03 * units::kDegPerHour);
  last = first;
  last.md = 900;
  last.utc_end = UtcTime{3'600'000'000'000};
  last.gyro_bias->y() = 0.4 * units::kDegPerHour;
  Job job;
  const std::vector<Check> constant = Checks(job, {}, {first, last});
  const Check& check = Find(constant, "bias_repeatability");
  EXPECT_EQ(check.verdict, Verdict::kFail);
  EXPECT_NEAR(check.value.value_or(0), 0.2, 1e-9);
  EXPECT_NEAR(check.sigma.value_or(0), 0.03 * std::sqrt(2), 1e-9);
  EXPECT_EQ(check.md.value_or(0), 900);
  job.noise.rate_random_walk = 0.1 * units::kDegPerHourSqrtHour;
  EXPECT_EQ(Find(Checks(job, {}, {first, last}), "bias_repeatability").verdict, Verdict::kPass);
  EXPECT_EQ(Find(Checks(job, {}, {last}), "bias_repeatability").verdict, Verdict::kNotDone);
  // Where UTC goes back between them, too.
  const std::vector<Check> back = Checks(job, {}, {last, first});
  EXPECT_EQ(Find(back, "bias_repeatability").verdict, Verdict::kPass);
  EXPECT_EQ(Find(back, "bias_repeatability").sigma,
            Find(Checks(job, {}, {first, last}), "bias_repeatability").sigma);
  // The worst of two axes at each stop behind the first: 3 of 200 clean runs with six comparisons
  // failed while it counted as one.
  EXPECT_EQ(check.looks, 2);
  EXPECT_EQ(Find(Checks(job, {}, {first, first, last}), "bias_repeatability").looks, 4);
}

TEST(Checks, FaultySamplesAreCounted) {
  RunSummary run;
  run.run = 1;
  run.samples = 1000;
  Job job;
  job.tool.emplace();
  const char* const codes[] = {"gyro_saturated", "accel_saturated", "samples_aliased",
                               "clock_unsynced", "temperature_outside"};
  const auto verdict = [&](const char* code) {
    const std::vector<RunSummary> runs = {run};
    return Find(MakeChecks(job, {runs, {}, {}, {}}), code).verdict;
  };
  for (const char* code : codes) EXPECT_EQ(verdict(code), Verdict::kPass) << code;
  run.samples_gyro_saturated = run.samples_accel_saturated = run.samples_aliased =
      run.samples_unsynced = run.samples_temperature_outside = 1;
  for (const char* code : codes) EXPECT_EQ(verdict(code), Verdict::kWarn) << code;
  run.samples_gyro_saturated = run.samples_accel_saturated = run.samples_aliased = 11;
  for (const char* code : {codes[0], codes[1], codes[2]}) {
    EXPECT_EQ(verdict(code), Verdict::kFail) << code << " of more than one sample in a hundred";
  }
}

TEST(Checks, ACalibrationThatHasExpiredIsTold) {
  Job job;
  const std::vector<Check> without = Checks(job, {});
  EXPECT_TRUE(std::none_of(without.begin(), without.end(),
                           [](const Check& check) { return check.code == "calibration_date"; }));
  constexpr std::int64_t kDay = 86'400'000'000'000;
  job.tool.emplace();
  job.tool->expires = UtcTime{10 * kDay};
  // The run begins at the epoch.
  const std::vector<Check> valid = Checks(job, {});
  EXPECT_EQ(Find(valid, "calibration_date").verdict, Verdict::kPass);
  EXPECT_NEAR(Find(valid, "calibration_date").value.value_or(0), 10, 1e-9);
  EXPECT_EQ(Find(valid, "calibration_date").run, 1);
  job.tool->expires = UtcTime{-3 * kDay};
  const std::vector<Check> expired = Checks(job, {});
  EXPECT_EQ(Find(expired, "calibration_date").verdict, Verdict::kFail);
  EXPECT_NEAR(Find(expired, "calibration_date").value.value_or(0), -3, 1e-9);
}

TEST(Checks, InAndOutRunAreHeldToFieldPracticeFromTenPairsOn) {
  std::vector<Station> passes;
  for (int i = 1; i <= 9; ++i) {
    passes.push_back(PassAt(100.0 * i, Pass::kIn, 50, 1));
    passes.push_back(PassAt(100.0 * i, Pass::kOut, 50.9, 1));
  }
  EXPECT_EQ(Find(Checks({}, passes), "azimuth_in_out_practice").verdict, Verdict::kNotDone);
  passes.push_back(PassAt(1000, Pass::kIn, 50, 1));
  passes.push_back(PassAt(1000, Pass::kOut, 51.2, 1));
  const std::vector<Check> at_40 = Checks({}, passes);
  const Check& steep = Find(at_40, "azimuth_in_out_practice");
  EXPECT_EQ(steep.verdict, Verdict::kFail);
  EXPECT_NEAR(steep.value.value_or(0), 1.2, 1e-9);
  EXPECT_NEAR(steep.limit.value_or(0), 1.0, 1e-12);
  EXPECT_EQ(steep.md.value_or(0), 1000);
  for (Station& s : passes) s.inclination = FromDegrees(9);
  passes.back().inclination = FromDegrees(9.24);
  const std::vector<Check> at_9 = Checks({}, passes);
  EXPECT_NEAR(Find(at_9, "azimuth_in_out_practice").limit.value_or(0), 5.0, 1e-12);
  EXPECT_EQ(Find(at_9, "azimuth_in_out_practice").verdict, Verdict::kPass);
  EXPECT_EQ(Find(at_9, "inclination_in_out_practice").verdict, Verdict::kFail);
}

TEST(Checks, FieldPracticeAsksNoAzimuthThatIsUnsureNearVertical) {
  std::vector<Station> passes;
  const auto fly = [&](int i, double inclination_deg, double sigma_deg, double apart_deg) {
    passes.push_back(PassAt(100.0 * i, Pass::kIn, 50, sigma_deg));
    passes.push_back(PassAt(100.0 * i, Pass::kOut, 50 + apart_deg, sigma_deg));
    for (Station& s : std::span(passes).last(2)) s.inclination = FromDegrees(inclination_deg);
  };
  for (int i = 1; i <= 10; ++i) fly(i, 0.4, 8, 12);
  const auto azimuth = [&] { return Find(Checks({}, passes), "azimuth_in_out_practice"); };
  EXPECT_EQ(azimuth().verdict, Verdict::kNotDone);
  EXPECT_EQ(Find(Checks({}, passes), "inclination_in_out_practice").verdict, Verdict::kPass);
  for (int i = 11; i <= 20; ++i) fly(i, 4, 0.5, 2);
  EXPECT_EQ(azimuth().verdict, Verdict::kPass);
  EXPECT_NEAR(azimuth().value.value_or(0), 2, 1e-9);
  // A sure one that is off is told.
  fly(21, 4, 0.5, 6);
  EXPECT_EQ(azimuth().verdict, Verdict::kFail);
  EXPECT_EQ(azimuth().md.value_or(0), 2100);
  // Above 10 deg practice allows 1 deg to whatever tool.
  passes.resize(40);
  fly(21, 12, 8, 1.5);
  EXPECT_EQ(azimuth().verdict, Verdict::kFail);
}

TEST(Checks, SlippageIsPerKilometreThereAndBack) {
  const std::vector<Station> passes = {PassAt(2000, Pass::kIn, 50, 1)};
  RunSummary run;
  run.run = 1;
  const std::vector<RunSummary> runs = {run};
  const auto check = [&](double read) {
    const std::vector<ReturnToZero> returns = {{1, read, 0, 0.1}};
    const std::vector<Check> checks = MakeChecks({}, {runs, passes, {}, returns});
    return Find(checks, "depth_slippage");
  };
  EXPECT_NEAR(check(2).value.value_or(0), 0.5, 1e-12) << "2 m in 4 km";
  EXPECT_EQ(check(2).verdict, Verdict::kPass);
  EXPECT_EQ(check(-4.1).verdict, Verdict::kFail);
}

TEST(Checks, AskedDepthsWithoutAStationAreCounted) {
  Job job;
  job.stations.at = {0, 100, 200, 300};
  const std::vector<Station> chosen = {PassAt(100.05, Pass::kIn, 0, 1)};
  const Check check = CheckAsked(job, chosen);
  EXPECT_EQ(check.value.value_or(0), 2) << "200 and 300; the tie-in is the station of 0";
  EXPECT_EQ(check.md.value_or(0), 200);
  EXPECT_EQ(check.verdict, Verdict::kWarn);
}

TEST(Checks, AStatedConvergenceIsComparedWithTheProjections) {
  Job job;
  job.well.latitude = FromDegrees(60);
  job.well.longitude = FromDegrees(5);
  job.grid = UtmGrid("31N");
  // Two degrees east of the central meridian: 2 sin 60 deg to first order.
  job.grid->convergence = FromDegrees(2 * std::sin(FromDegrees(60)));
  EXPECT_EQ(Find(Checks(job, {}), "grid_convergence").verdict, Verdict::kPass);
  job.grid->convergence = -*job.grid->convergence;
  EXPECT_EQ(Find(Checks(job, {}), "grid_convergence").verdict, Verdict::kFail);
}

TEST(Checks, AnAdjustmentThatGaveUpFailsItsRun) {
  CheckInputs inputs;
  RunSummary run;
  run.run = 1;
  run.fit = std::make_shared<const RunFit>();
  const std::vector<RunSummary> runs{run};
  inputs.runs = runs;
  const std::vector<Check> checks = MakeChecks(Job{}, inputs);
  const auto fit = std::find_if(checks.begin(), checks.end(),
                                [](const Check& check) { return check.code == "fit"; });
  ASSERT_NE(fit, checks.end());
  EXPECT_EQ(fit->verdict, Verdict::kFail);
  EXPECT_EQ(VerdictOfRun(checks, 1).verdict, Verdict::kFail);
}

}  // namespace
}  // namespace wellgyro

// Which fault explains a simulated run.
#include "wellgyro/survey/verdict/run_diagnosis.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include <Eigen/LU>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/earth/earth.h"
#include "wellgyro/io/result/diagnosis_csv.h"
#include "wellgyro/record/run_fit.h"
#include "wellgyro/simulate/tool_errors.h"

#include "support/simulated_survey.h"

namespace wellgyro {
namespace {

using testing::CollectingSink;
using testing::Find;
using ::testing::HasSubstr;
using testing::SurveyOf;
using Cause = SimulatedFault::Cause;

constexpr double kHalf = 600;  // [s]

/// Twenty minutes down a hole that builds and turns, with four stops.
struct DiagnosedFlight {
  explicit DiagnosedFlight(std::uint64_t seed) {
    simulation.well.end_md = 900;
    simulation.well.inclination.start = FromDegrees(30);
    simulation.well.inclination.terms.push_back({.rate = 1.5 * units::kDegPer30m});
    simulation.well.azimuth.start = FromDegrees(40);
    simulation.well.azimuth.terms.push_back({.rate = units::kDegPer30m});
    simulation.earth.latitude = FromDegrees(60);
    simulation.run.roll_reference = RollReference::kHighSide;
    RunMove down;
    down.speed = 1;
    down.roll.rate = kTwoPi / 60;
    for (const double to : {200., 400., 600.}) {
      simulation.run.steps.push_back(RunStop{.seconds = 150});
      down.to_md = to;
      simulation.run.steps.push_back(down);
      down.roll.rate = -down.roll.rate;
    }
    simulation.run.steps.push_back(RunStop{.seconds = 150});
    simulation.streams.imu_hz = 10;
    simulation.streams.depth_hz = 2;
    job.well.latitude = FromDegrees(60);
    job.noise.angle_random_walk = 0.005 * units::kDegPerSqrtHour;
    job.noise.rate_random_walk = 0.01 * units::kDegPerHourSqrtHour;
    job.errors.gyro_bias_sigma = 0.1 * units::kDegPerHour;
    job.errors.mass_unbalance_sigma = 0.02 * units::kDegPerHourPerG;
    job.errors.gyro_scale_sigma = job.errors.gyro_misalignment_sigma = 1e-4;
    job.errors.roll_offset_sigma = FromDegrees(0.02);
    job.errors.time_skew_sigma = 1e-3;
    job.errors.accel_bias_sigma = 5e-4;
    job.errors.accel_noise = 2e-4;
    job.errors.depth_sigma = 0.3;
    simulation.tool.errors = DrawToolErrors(job.errors, job.noise, seed);
    simulation.tool.errors.depth_resolution = 0.01;
    simulation.seed = seed;
  }
  Survey Surveyed() const {
    CollectingSink sink;
    return SurveyOf(simulation, job, sink);
  }

  Simulation simulation;
  Job job;
};

double Sum(const std::vector<RunCause>& causes) {
  double sum = 0;
  for (const RunCause& cause : causes) sum += cause.posterior;
  return sum;
}

TEST(RunDiagnosis, OfARunWithoutFaultIsNone) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Survey survey = DiagnosedFlight(seed).Surveyed();
    ASSERT_EQ(survey.unusable, "");
    ASSERT_TRUE(survey.runs[0].fit && survey.runs[0].fit->diagnosis);
    const Check* check = Find(survey, "diagnosis");
    ASSERT_NE(check, nullptr);
    EXPECT_EQ(check->verdict, Verdict::kPass) << check->value.value_or(0) << check->limit_source;
    // Some 3500 rows, so that chance makes 2.4 % of it. With the depth's it was .70.
    EXPECT_NEAR(survey.runs[0].fit->chi_square / survey.runs[0].fit->degrees_of_freedom, 1, 0.08);
    const std::vector<RunCause> causes = CausesOf(survey.runs[0], survey.checks);
    EXPECT_GE(causes.size(), 26u);
    EXPECT_EQ(causes.front().code, "none");
    EXPECT_NEAR(Sum(causes), 1, 1e-9);
  }
}

struct PlantedCause {
  std::string code;
  Cause cause;
  double size;
  double unit;
  double begin;
  int axis = 0;
};
void PrintTo(const PlantedCause& wrong, std::ostream* out) { *out << wrong.code; }

class FaultIsNamed : public ::testing::TestWithParam<PlantedCause> {};

// The code itself or one that this run hardly tells from it comes first. The job takes the latitude
// as exact, so that it is no unknown of the run.
TEST_P(FaultIsNamed, WithItsSize) {
  const PlantedCause& wrong = GetParam();
  DiagnosedFlight flight(3);
  flight.simulation.faults.push_back({.cause = wrong.cause,
                                      .axis = wrong.axis,
                                      .begin = wrong.begin,
                                      .size = wrong.size * wrong.unit});
  const Survey survey = flight.Surveyed();
  ASSERT_EQ(survey.unusable, "");
  EXPECT_NE(survey.verdict.verdict, Verdict::kPass);
  const std::vector<RunCause> causes = CausesOf(survey.runs[0], survey.checks);
  const auto found = std::find_if(causes.begin(), causes.end(),
                                  [&](const RunCause& c) { return c.code == wrong.code; });
  ASSERT_NE(found, causes.end());
  const RunCause& first = causes.front();
  const bool alike =
      std::find(first.alike.begin(), first.alike.end(), wrong.code) != first.alike.end();
  EXPECT_TRUE(first.code == wrong.code || alike) << first.code << " " << first.posterior;
  EXPECT_FALSE(found->remedy.empty());
  ASSERT_TRUE(found->size && found->sigma);
  EXPECT_NEAR(std::abs(*found->size), wrong.size, 5 * *found->sigma + 0.05 * wrong.size);
  if (wrong.begin > 0) {
    ASSERT_TRUE(found->begin_md);
    EXPECT_NEAR(*found->begin_md, 285, 60);
  }
  const auto& words = survey.verdict.causes;
  const auto told = std::find_if(words.begin(), words.end(), [](const std::string& cause) {
    return cause.starts_with("the run shows a fault");
  });
  ASSERT_NE(told, words.end());
  EXPECT_NE(told->find(first.code), std::string::npos) << *told;
}

// At 600 s the tool is at 285 m or so.
INSTANTIATE_TEST_SUITE_P(
    Of, FaultIsNamed,
    ::testing::Values(
        PlantedCause{"toolface_slip", Cause::kToolfaceSlip, 0.6, units::kDeg, kHalf},
        PlantedCause{"toolface_offset", Cause::kToolfaceSlip, 0.6, units::kDeg, 0},
        PlantedCause{"gyro_step_x", Cause::kGyroStep, 1.5, units::kDegPerHour, kHalf, 0},
        PlantedCause{"gyro_step_y", Cause::kGyroStep, 1.5, units::kDegPerHour, kHalf, 1},
        PlantedCause{"accel_bias_z", Cause::kAccelBias, 9e-3, 1, 0, 2},
        PlantedCause{"time_skew", Cause::kTimeSkew, 0.03, 1, 0},
        PlantedCause{"depth_scale", Cause::kDepthScale, 9e-3, 1, 0},
        PlantedCause{"latitude", Cause::kLatitude, 2, units::kDeg, 0}));

// 40 K up and down as sine squared over 1000 s: the mean over the run is 20 K by the share of that
// time, and the bias is told by the largest difference from it.
TEST(RunDiagnosis, ABiasThatFollowsTheTemperatureIsNoStep) {
  DiagnosedFlight flight(5);
  const double size = 1.5 * units::kDegPerHour;
  flight.simulation.faults.push_back(
      {.cause = Cause::kGyroTemperature, .axis = 1, .begin = 200, .end = 1200, .size = size});
  const Survey survey = flight.Surveyed();
  ASSERT_EQ(survey.unusable, "");
  EXPECT_EQ(survey.verdict.verdict, Verdict::kFail);
  const std::vector<RunCause> causes = CausesOf(survey.runs[0], survey.checks);
  EXPECT_EQ(causes.front().code, "gyro_temperature_y");
  ASSERT_TRUE(causes.front().size && causes.front().sigma);
  const auto& run = survey.runs[0];
  const double seconds = 1e-9 * static_cast<double>(run.end.ns - run.begin.ns);
  const double share = 1 - 20 * 1000 / seconds / 40;
  EXPECT_NEAR(*causes.front().size, share * 1.5, 4 * *causes.front().sigma);
  EXPECT_LT(*causes.front().sigma, 0.1);
  EXPECT_THAT(std::string(causes.front().remedy), HasSubstr("over temperature"));
}

TEST(RunDiagnosis, AStepOfTheThirdAxisIsFound) {
  DiagnosedFlight flight(6);
  flight.simulation.tool.has_gz = true;
  flight.simulation.faults.push_back(
      {.cause = Cause::kGyroStep, .axis = 2, .begin = kHalf, .size = 3 * units::kDegPerHour});
  const Survey survey = flight.Surveyed();
  ASSERT_EQ(survey.unusable, "");
  const std::vector<RunCause> causes = CausesOf(survey.runs[0], survey.checks);
  EXPECT_EQ(causes.front().code, "gyro_step_z");
  ASSERT_TRUE(causes.front().size && causes.front().sigma);
  EXPECT_NEAR(std::abs(*causes.front().size), 3, 4 * *causes.front().sigma);
  EXPECT_LT(*causes.front().sigma, 0.75);
}

// A tool that hardly rolls shows a skew of 30 ms by what gravity says in a build, from stop to
// motion: told by its roll alone, it was called a spike of the gyros at a start.
TEST(RunDiagnosis, ASkewIsToldByABend) {
  DiagnosedFlight flight(3);
  for (auto& step : flight.simulation.run.steps) {
    if (auto* move = std::get_if<RunMove>(&step)) move->roll.rate *= 0.2;
  }
  flight.simulation.well.inclination.terms[0].rate = 3 * units::kDegPer30m;
  flight.simulation.faults.push_back({.cause = Cause::kTimeSkew, .size = 0.03});
  const Survey survey = flight.Surveyed();
  ASSERT_EQ(survey.unusable, "");
  const std::vector<RunCause> causes = CausesOf(survey.runs[0], survey.checks);
  const auto skew = std::find_if(causes.begin(), causes.end(),
                                 [](const RunCause& c) { return c.code == "time_skew"; });
  ASSERT_TRUE(skew != causes.end() && skew->size && skew->sigma && skew->ln_bayes);
  EXPECT_TRUE(causes[0].code == "time_skew" || causes[0].code == "samples_lost") << causes[0].code;
  EXPECT_NEAR(*skew->size, 0.03, 5 * *skew->sigma);
  EXPECT_LT(*skew->sigma, 0.003);
  EXPECT_GT(*skew->ln_bayes, 20);
}

// The vertical part of the Earth's rate acts as an unbalance of 26 deg/h/g, which no gyro has.
TEST(RunDiagnosis, TheSignOfTheLatitudeIsNoMassUnbalance) {
  DiagnosedFlight flight(3);
  flight.job.well.latitude *= -1;
  const Survey survey = flight.Surveyed();
  ASSERT_EQ(survey.unusable, "");
  const std::vector<RunCause> causes = CausesOf(survey.runs[0], survey.checks);
  EXPECT_EQ(causes[0].code, "latitude_sign");
  EXPECT_GT(causes[0].posterior, 0.9);
}

TEST(RunDiagnosis, AnAzimuthFromOutsideIsHeldAgainstTheGyrosOwn) {
  DiagnosedFlight flight(3);
  flight.job.alignment.method = AlignmentSpec::Method::kExternal;
  flight.job.alignment.sigma_azimuth = FromDegrees(0.5);
  const auto first = [&](double azimuth_deg) {
    flight.job.alignment.azimuth = FromDegrees(azimuth_deg);
    const Survey survey = flight.Surveyed();
    return CausesOf(survey.runs[0], survey.checks)[0].code;
  };
  EXPECT_EQ(first(40), "none");
  EXPECT_EQ(first(220), "azimuth_tie");
}

/// Of all causes, each told and none of it.
Diagnosis NothingFound() {
  Diagnosis tests;
  tests.done = true;
  tests.tests.resize(CausesLookedFor(SiteAt(FromDegrees(60), 0)).size());
  const auto n = static_cast<Eigen::Index>(tests.tests.size());
  tests.alike = Eigen::MatrixXd::Zero(n, n);
  for (CauseTest& test : tests.tests) test.tested = test.told = true;
  return tests;
}

/// Of tests of which the first, a gyro bias, has the odds e^40 and explains all but odds of
/// e^`beside`.
RunDiagnosis Explained(double beside) {
  Diagnosis tests = NothingFound();
  tests.tests[0].ln_bayes = tests.ln_odds = 40;
  tests.first = 0;
  tests.second = 1;
  tests.ln_odds_without_first = beside;
  return DiagnosisOf(tests, {});
}

// Of one run in ten with a fault one in ten has a second.
TEST(RunDiagnosis, WhatTheLikeliestLeavesSpeaksForNoneOfThese) {
  const RunDiagnosis alone = Explained(-1), both = Explained(9);
  EXPECT_EQ(alone.causes[0].code, "gyro_bias_x");
  EXPECT_GT(alone.causes[0].posterior, 0.9);
  EXPECT_EQ(both.causes[0].code, "other");
  EXPECT_GT(both.causes[0].posterior, 0.99);
  EXPECT_NEAR(Sum(both.causes), 1, 1e-9);
  // ln 10, and a hundredth of the likeliest's odds that its column may miss.
  const RunDiagnosis even = Explained(std::log(10.0) + 0.4);
  EXPECT_NEAR(even.causes[0].posterior, 0.5, 1e-6);
  EXPECT_NEAR(even.causes[1].posterior, 0.5, 1e-6);
}

// Of odds of e^9000 all others' posteriors are zero as doubles are.
TEST(RunDiagnosis, CausesBehindOneThatIsCertainKeepTheirOrder) {
  Diagnosis tests = NothingFound();
  tests.tests[6].ln_bayes = 800;
  tests.tests.back().ln_bayes = 9000;
  const std::vector<RunCause> causes = DiagnosisOf(tests, {}).causes;
  EXPECT_EQ(causes[0].code, "other");
  EXPECT_EQ(causes[1].code, "mass_unbalance");
  EXPECT_EQ(causes[1].posterior, 0);
}

/// Odds, and what is found of the depth's scale beside a prior of 1e-3 that leaves a sigma of 6e-4.
double FoundOfDepthScale(double ln_odds, double found) {
  Job job;
  job.errors.depth_scale_sigma = 1e-3;
  RunDiagnosis diagnosis;
  diagnosis.ln_odds = ln_odds;
  RunCause& cause = diagnosis.causes.emplace_back();
  cause.code = "depth_scale";
  cause.posterior = 0.9;
  cause.size = found / 0.64;  // 1 - .6^2, of the prior's variance
  cause.sigma = 1e-3 / 0.8;
  return DepthScaleFound(job, diagnosis);
}

TEST(RunDiagnosis, WhatIsFoundOfTheDepthsScaleCountsUntilItIsAFault) {
  EXPECT_NEAR(FoundOfDepthScale(2, 0), 6e-4, 1e-12);
  EXPECT_NEAR(FoundOfDepthScale(2, 8e-4), 1e-3, 1e-12);
  EXPECT_EQ(FoundOfDepthScale(7, 8e-4), 0);
}

// A creep of a stop and its way back are, to the gyros' rows, one turn that is wrong.
TEST(RunDiagnosis, MotionAtTheStopWhereAFaultBeginsIsTheFault) {
  RunSummary run;
  run.run = 1;
  const auto fit = std::make_shared<RunFit>();
  run.fit = fit;
  RunDiagnosis& found = fit->diagnosis.emplace();
  found.ln_odds = 50;
  RunCause& spike = found.causes.emplace_back();
  spike.code = "gyro_spike";
  spike.posterior = 1;
  spike.begin_md = 899.9;
  Check moved{.code = "rest_motion", .run = 1, .md = 900, .value = 101, .unit = "s"};
  moved.verdict = Verdict::kWarn;
  const auto first = [&](const Check& check) {
    return CausesOf(run, std::vector<Check>{check}).front().code;
  };
  EXPECT_EQ(first(moved), "rest_motion");
  EXPECT_EQ(CausesOf(run, std::vector<Check>{moved}).back().posterior, 0);
  Check elsewhere = moved;
  elsewhere.md = 600;
  EXPECT_EQ(first(elsewhere), "gyro_spike");
  Check still = moved;
  still.verdict = Verdict::kPass;
  EXPECT_EQ(first(still), "gyro_spike");
}

// A swing of the rope, spikes that were replaced: no row of the run need show them.
TEST(RunDiagnosis, WhatIsSeenInSamplesIsListedThoughItOnlyWarns) {
  RunSummary run;
  run.run = 1;
  const auto fit = std::make_shared<RunFit>();
  run.fit = fit;
  RunDiagnosis& found = fit->diagnosis.emplace();
  found.ln_odds = 2;
  found.causes.emplace_back().code = "none";
  found.causes.back().posterior = 0.9;
  found.causes.emplace_back().code = "latitude";
  found.causes.back().posterior = 0.1;
  Check spikes{.code = "accel_spikes", .run = 1, .value = 3, .unit = "1"};
  spikes.verdict = Verdict::kWarn;
  const auto causes = [&](const Check& check) { return CausesOf(run, std::vector<Check>{check}); };
  ASSERT_EQ(causes(spikes).size(), 3U);
  EXPECT_EQ(causes(spikes)[0].code, "accel_spikes");
  EXPECT_EQ(causes(spikes)[0].posterior, 1);
  EXPECT_EQ(causes(spikes)[0].size, 3);
  EXPECT_FALSE(causes(spikes)[0].remedy.empty());
  EXPECT_EQ(causes(spikes)[1].posterior, 0);

  found.ln_odds = 50;  // where the rows show another fault, that stays the first
  ASSERT_EQ(causes(spikes).size(), 3U);
  EXPECT_EQ(causes(spikes)[0].posterior, 0.9);
  EXPECT_EQ(causes(spikes)[2].code, "accel_spikes");
  EXPECT_EQ(causes(spikes)[2].posterior, 0);

  found.ln_odds = 2;
  spikes.looks = 7;  // what warns by chance is not seen to be there
  EXPECT_EQ(causes(spikes).size(), 2U);
  spikes.looks = 0;
  spikes.verdict = Verdict::kPass;
  EXPECT_EQ(causes(spikes).size(), 2U);
}

/// Of a run whose odds of a fault are `ln_odds`, a latitude that moves its end by `shift_W`. The
/// end has sigmas of 1, 2 and 2 m; a station further up and the end of another run have others.
Verdict VerdictOf(double ln_odds, const Eigen::Vector3d& shift_W, double ln_odds_without = 0) {
  RunSummary run;
  run.run = 1;
  const auto fit = std::make_shared<RunFit>();
  run.fit = fit;
  RunDiagnosis& found = fit->diagnosis.emplace();
  found.ln_odds = ln_odds;
  found.ln_odds_without_first = ln_odds_without;
  RunCause& cause = found.causes.emplace_back();
  cause.code = "latitude";
  cause.posterior = 0.99;
  cause.shift_W = shift_W;
  RunCause& none = found.causes.emplace_back();
  none.code = "none";
  none.posterior = 0.01;
  std::vector<Station> passes(3);
  passes[0].md = 1000;
  passes[0].cov_p_WT_W = Eigen::Vector3d(1, 4, 4).asDiagonal();
  passes[1].md = 500;
  passes[1].cov_p_WT_W = 1e-4 * Eigen::Matrix3d::Identity();
  passes[2].md = 2000;
  passes[2].cov_p_WT_W = 1e4 * Eigen::Matrix3d::Identity();
  passes[0].run = passes[1].run = 1;
  passes[2].run = 2;
  std::vector<Check> checks;
  CheckDiagnosis(run, passes, checks);
  return checks.at(0).verdict;
}

TEST(RunDiagnosis, WhatMovesTheEndByMoreThanItsSigmaFails) {
  constexpr double kFound = 7;  // odds of 1100, where 1000 are the limit
  EXPECT_EQ(VerdictOf(kFound, {1.1, 0, 0}), Verdict::kFail);
  EXPECT_EQ(VerdictOf(kFound, {0.9, 0, 0}), Verdict::kWarn);
  EXPECT_EQ(VerdictOf(kFound, {0, 1.9, 0}), Verdict::kWarn);
  EXPECT_EQ(VerdictOf(kFound, {0, 0, -2.1}), Verdict::kFail);
  EXPECT_EQ(VerdictOf(kFound, {NAN, 0, 0}), Verdict::kFail);
  EXPECT_EQ(VerdictOf(6.9, {100, 0, 0}), Verdict::kPass);
}

// A wheel that slips by 5 m within 20 m of hole passes for a spike of the accelerometers, which
// moves nothing, and leaves most of what it did to the residuals.
TEST(RunDiagnosis, WhatNoNamedCauseExplainsFails) {
  EXPECT_EQ(VerdictOf(200, {1e-3, 0, 0}, 6.8), Verdict::kWarn);
  EXPECT_EQ(VerdictOf(200, {1e-3, 0, 0}, 7), Verdict::kFail);
}

TEST(RunDiagnosis, FilesHaveTheirColumns) {
  const Survey survey = DiagnosedFlight(1).Surveyed();
  const std::string diagnosis = DiagnosisCsv(survey), reliability = ReliabilityCsv(survey);
  EXPECT_TRUE(diagnosis.starts_with(
      "RUN,CODE,BEGIN_UTC,BEGIN_MD[m],SIZE,SIGMA,UNIT,LN_BAYES,POSTERIOR,DN[m],DE[m],DV[m],ALIKE,"
      "REMEDY\n1,none,,,,,,0,"))
      << diagnosis.substr(0, 200);
  EXPECT_TRUE(reliability.starts_with("RUN,CODE,SMALLEST,UNIT,AT_MD[m],DN[m],DE[m],DV[m]\n1,"));
  for (const std::string& text : {diagnosis, reliability}) {
    EXPECT_EQ(text.find("nan"), std::string::npos);
    EXPECT_EQ(text.find("inf"), std::string::npos);
  }
}

TEST(RunDiagnosis, ARunWhoseAdjustmentGaveUpHasAFaultWithoutAName) {
  RunSummary run;
  run.run = 1;
  EXPECT_TRUE(CausesOf(run, {}).empty());
  auto fit = std::make_shared<RunFit>();
  fit->converged = false;
  run.fit = fit;
  const std::vector<RunCause> causes = CausesOf(run, {});
  ASSERT_EQ(causes.size(), 1u);
  EXPECT_EQ(causes[0].code, "other");
  EXPECT_EQ(causes[0].posterior, 1);
  EXPECT_FALSE(causes[0].remedy.empty());
  fit->converged = true;
  EXPECT_TRUE(CausesOf(run, {}).empty());
}

}  // namespace
}  // namespace wellgyro

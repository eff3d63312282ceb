#include "wellgyro/survey/verdict/verdict.h"

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/math/random.h"
#include "wellgyro/survey/verdict/tie_in_check.h"

namespace wellgyro {
namespace {

using ::testing::HasSubstr;

Check Normal(std::string code, double value, double looks = 1, std::int32_t run = 1) {
  Check check;
  check.code = std::move(code);
  check.run = run;
  check.value = value;
  check.sigma = 1;
  check.limit = 3;
  check.unit = "deg";
  check.looks = looks;
  check.verdict = Verdict::kPass;
  return check;
}

// Of 20 000 runs of 8 comparisons that are true 1 % fail: 0.8 to 1.2 % are 3 sigmas of the count.
TEST(ShareFalseAlarms, OneCleanRunInAHundredFails) {
  Random random(1);
  constexpr int kRuns = 20'000;
  int failed = 0, warned = 0;
  for (int k = 0; k < kRuns; ++k) {
    std::vector<Check> checks;
    for (int i = 0; i < 5; ++i) checks.push_back(Normal("a", random.Normal()));
    double worst = 0;
    for (int i = 0; i < 2; ++i) worst = std::max(worst, std::abs(random.Normal()));
    checks.push_back(Normal("worst of two", worst, 2));
    double squares = 0;
    for (int i = 0; i < 12; ++i) squares += std::pow(random.Normal(), 2);
    checks.push_back(Normal("squares", squares / 12));
    checks.back().freedom = 12;
    ShareFalseAlarms(checks);
    const Verdict verdict = VerdictOfRun(checks, 1).verdict;
    failed += verdict == Verdict::kFail;
    warned += verdict == Verdict::kWarn;
  }
  EXPECT_NEAR(failed, 0.01 * kRuns, 45);
  EXPECT_NEAR(warned, 0.085 * kRuns, 200) << "ten times as many, less those that fail";
}

TEST(ShareFalseAlarms, MoreComparisonsHaveWiderLimits) {
  std::vector<Check> few{Normal("a", 2.9)};
  std::vector<Check> many(40, Normal("a", 2.9));
  ShareFalseAlarms(few);
  ShareFalseAlarms(many);
  EXPECT_EQ(few[0].verdict, Verdict::kFail);
  EXPECT_NEAR(*few[0].limit, 2.5758, 1e-4) << "two-sided 1 %";
  EXPECT_EQ(many[0].verdict, Verdict::kPass);
  EXPECT_NEAR(*many[0].limit, 3.6623, 1e-4) << "two-sided 0.025 %";
  EXPECT_THAT(many[0].limit_source, HasSubstr("shared by 1 kind of comparison, 40 of this"));
}

// As in and out, each at 36 depths: they held six tenths of the rate of a run.
TEST(ShareFalseAlarms, WhatIsLookedAtInManyPlacesTakesNothingFromWhatIsLookedAtOnce) {
  std::vector<Check> checks{Normal("once", 2.9), Normal("in_out", 2.9, 36)};
  ShareFalseAlarms(checks);
  EXPECT_EQ(checks[0].verdict, Verdict::kFail);
  EXPECT_NEAR(*checks[0].limit, 2.8070, 1e-4) << "two-sided 0.5 %";
  EXPECT_EQ(checks[1].verdict, Verdict::kPass);
  EXPECT_NEAR(*checks[1].limit, 3.8101, 1e-4) << "two-sided 0.5 % / 36";
  EXPECT_THAT(checks[1].limit_source, HasSubstr("shared by 2 kinds of comparison, 36 of this"));
}

// Of 10 000 rows chance brings the squares beyond 1.05 once in 4000, and never beyond 1.15.
TEST(ShareFalseAlarms, SquaresThatChanceKeepsLowHoldNoShare) {
  std::vector<Check> checks{Normal("once", 2.57), Normal("fit", 1.05)};
  checks[1].freedom = 10'000;
  ShareFalseAlarms(checks);
  EXPECT_NEAR(*checks[0].limit, 2.5758, 1e-4) << "two-sided 1 %";
  EXPECT_EQ(*checks[1].limit, 1.15);
  EXPECT_EQ(checks[1].verdict, Verdict::kWarn);
  checks[1].value = 1.16;
  ShareFalseAlarms(checks);
  EXPECT_EQ(checks[1].verdict, Verdict::kFail);
}

TEST(ShareFalseAlarms, LeavesOtherLimitsAndOtherRunsAlone) {
  std::vector<Check> checks{Normal("acceptance", 2.9, 0), Normal("a", 2.9), Normal("b", 2.9, 1, 2)};
  checks[0].limit_source = "acceptance";
  checks[0].verdict = Verdict::kWarn;
  ShareFalseAlarms(checks);
  EXPECT_EQ(checks[0].verdict, Verdict::kWarn);
  EXPECT_EQ(checks[0].limit_source, "acceptance");
  EXPECT_NEAR(*checks[1].limit, *checks[2].limit, 0) << "each run has its own 1 %";
}

Station StationAtMd(std::int32_t run, double md, StationKind kind = StationKind::kContinuous) {
  Station s;
  s.run = run;
  s.md = md;
  s.kind = kind;
  return s;
}

Survey TwoRuns() {
  Survey survey;
  survey.runs.resize(2);
  survey.runs[0].run = 1;
  survey.runs[1].run = 2;
  survey.passes = {StationAtMd(1, 10), StationAtMd(2, 10), StationAtMd(2, 20)};
  survey.chosen = {StationAtMd(0, 0, StationKind::kTieIn), StationAtMd(1, 10), StationAtMd(2, 20)};
  return survey;
}

TEST(GiveVerdict, AFailingRunTakesItsStationsWithIt) {
  Survey survey = TwoRuns();
  Check failed = Normal("earth_rate", 9);
  failed.run = 2;
  failed.md = 20;
  failed.verdict = Verdict::kFail;
  Check warned = Normal("samples_lost", 1);
  warned.verdict = Verdict::kWarn;
  survey.checks = {warned, failed};
  GiveVerdict(survey);
  EXPECT_EQ(survey.runs[0].verdict.verdict, Verdict::kWarn);
  EXPECT_EQ(survey.runs[1].verdict.verdict, Verdict::kFail);
  EXPECT_EQ(survey.verdict.verdict, Verdict::kFail);
  ASSERT_EQ(survey.verdict.causes.size(), 2u);
  EXPECT_THAT(survey.verdict.causes[0], HasSubstr("do not read the Earth's rate"));
  EXPECT_THAT(survey.verdict.causes[0], HasSubstr("MD 20.00 m: 9 deg, limit 3"));
  EXPECT_THAT(survey.verdict.causes[1], HasSubstr("samples are missing"));
  EXPECT_FALSE(Has(survey.chosen[0].quality, Quality::kUnfit)) << "the tie-in is nobody's";
  EXPECT_FALSE(Has(survey.chosen[1].quality, Quality::kUnfit));
  EXPECT_TRUE(Has(survey.chosen[2].quality, Quality::kUnfit));
  EXPECT_TRUE(Has(survey.passes[1].quality, Quality::kUnfit));
  // Nowhere in the hole can the tool be further than two sigmas from where the survey has it.
  EXPECT_EQ(survey.chosen[2].cov_p_WT_W, 20 * 20 * Eigen::Matrix3d::Identity());
  EXPECT_EQ(survey.passes[0].cov_p_WT_W, Eigen::Matrix3d::Zero()) << "of the run that is good";
}

TEST(GiveVerdict, ARunThatGaveNoStationDoesNotFailTheSurvey) {
  Survey survey = TwoRuns();
  survey.chosen.pop_back();
  Check failed = Normal("fit", 9);
  failed.run = 2;
  failed.verdict = Verdict::kFail;
  survey.checks = {failed};
  GiveVerdict(survey);
  EXPECT_EQ(survey.runs[1].verdict.verdict, Verdict::kFail);
  EXPECT_EQ(survey.verdict.verdict, Verdict::kPass);
  failed.run = 0;
  survey.checks = {failed};
  GiveVerdict(survey);
  EXPECT_EQ(survey.verdict.verdict, Verdict::kFail) << "what concerns all of it";
}

TEST(CheckTieIn, ATieInThatIsNotTheRunsFails) {
  Job job;
  job.tie_in.md = 100;
  EXPECT_EQ(CheckTieIn(job, {}, {}).verdict, Verdict::kNotDone);
  job.tie_in.inclination = 5 * kPi / 180;
  job.tie_in.azimuth = 0;
  Station near = StationAtMd(1, 105);
  near.inclination = 0.01 * kPi / 180;
  near.cov_md_inc_azi(1, 1) = std::pow(0.01 * kPi / 180, 2);
  near.cov_md_inc_azi(2, 2) = 1;
  const std::vector<Station> stations{StationAtMd(1, 160), near};
  const Check check = CheckTieIn(job, stations, {});
  EXPECT_EQ(check.verdict, Verdict::kFail);
  EXPECT_NEAR(check.value.value_or(0), 5, 0.02);
  EXPECT_EQ(check.md.value_or(0), 105);
  job.tie_in.inclination = 0.2 * kPi / 180;
  EXPECT_EQ(CheckTieIn(job, stations, {}).verdict, Verdict::kPass)
      << "the azimuth of a vertical hole";
}

// A station 10 m off allows for 4 deg of hole between; a stop at the tie-in's own depth for none.
TEST(CheckTieIn, AStopAtItsDepthTellsTwoDegrees) {
  Job job;
  job.tie_in = {.md = 500, .tvd = 490, .inclination = FromDegrees(12), .azimuth = FromDegrees(30)};
  Station near = StationAtMd(1, 510);
  near.inclination = FromDegrees(10);
  near.azimuth = FromDegrees(30);
  NorthFix stop{.md = 500, .azimuth = near.azimuth, .inclination = near.inclination};
  stop.cov_attitude.diagonal().setConstant(std::pow(FromDegrees(0.1), 2));
  RunSummary run{.run = 1};
  EXPECT_EQ(CheckTieIn(job, {&near, 1}, {&run, 1}).verdict, Verdict::kPass);
  run.fixes = {stop};
  const Check check = CheckTieIn(job, {&near, 1}, {&run, 1});
  EXPECT_EQ(check.verdict, Verdict::kFail);
  EXPECT_NEAR(check.value.value_or(0), 2, 1e-6);
  EXPECT_EQ(check.run, 1);
  run.fixes[0].external = true;
  EXPECT_EQ(CheckTieIn(job, {&near, 1}, {&run, 1}).verdict, Verdict::kPass)
      << "an azimuth from outside is no word of the run";
}

TEST(ShortNumber, HasNoPowersOfTenWhereAReaderWantsNone) {
  EXPECT_EQ(ShortNumber(16'412.3, 3), "16412");
  EXPECT_EQ(ShortNumber(-204.6, 2), "-205");
  EXPECT_EQ(ShortNumber(0.0123456, 3), "0.0123");
  EXPECT_EQ(ShortNumber(99.4, 2), "99");
  EXPECT_EQ(ShortNumber(2, 3), "2");
  EXPECT_EQ(ShortNumber(3e12, 3), "3e+12");
  EXPECT_EQ(ShortNumber(1e-7, 3), "1e-07");
}

TEST(CheckTieIn, ItsPlaceIsOneThatTheHoleReaches) {
  TieIn tie_in{.md = 1000, .north = 300, .east = -400, .tvd = 800};
  const Check reached = CheckTieInPlace(tie_in);
  EXPECT_EQ(reached.verdict, Verdict::kPass);
  EXPECT_EQ(reached.value, 0);
  EXPECT_EQ(CheckTieInPlace({.md = 1000, .tvd = 1000}).verdict, Verdict::kPass) << "straight down";
  tie_in.tvd = 800 / 0.3048;  // in feet
  const Check feet = CheckTieInPlace(tie_in);
  EXPECT_EQ(feet.verdict, Verdict::kFail);
  EXPECT_NEAR(feet.value.value_or(0), 800 / 0.3048 - 1000, 1e-9);
  tie_in.cov_p_WT_W.diagonal().fill(1e6);
  EXPECT_EQ(CheckTieInPlace(tie_in).verdict, Verdict::kPass) << "known as badly";
}

// A run from the well head, vertical to 200 m and at 45 deg from there, in and out, tied at 500 m.
TEST(CheckTieIn, ItsPlaceIsWhereTheRunsOwnWayLeads) {
  std::vector<PathStation> seen;
  for (int k = -160; k <= 160; ++k) {
    const double md = 5.0 * (160 - std::abs(k));
    seen.push_back({md, md > 200 ? FromDegrees(45) : 0, FromDegrees(30)});
  }
  const double aside = 300 * std::sqrt(0.5);
  const TieIn tie_in{
      .md = 500, .north = aside * std::cos(FromDegrees(30)), .east = aside / 2, .tvd = 200 + aside};
  EXPECT_EQ(CheckTieInWay(tie_in, seen).verdict, Verdict::kPass);
  const TieIn straight_down{.md = 500, .tvd = 500};
  const Check off = CheckTieInWay(straight_down, seen);
  EXPECT_EQ(off.verdict, Verdict::kFail);
  EXPECT_NEAR(off.value.value_or(0), 300 - aside, 12) << "of TVD, which no north turns";
  TieIn turned = tie_in;
  std::swap(turned.north, turned.east);
  EXPECT_NEAR(CheckTieInWay(turned, seen).value.value_or(0), 2 * aside * std::sin(FromDegrees(15)),
              12);
  TieIn shallow = tie_in;
  shallow.tvd = *shallow.tvd - 15;
  EXPECT_EQ(CheckTieInWay(shallow, seen).verdict, Verdict::kFail);
  // What lies above the run may go anywhere.
  std::erase_if(seen, [](const PathStation& s) { return s.md < 300; });
  EXPECT_EQ(CheckTieInWay(straight_down, seen).verdict, Verdict::kNotDone);
}

TEST(CheckTieIn, APlaceThatNobodyStatedWarnsWhereItIsNotTheHeads) {
  TieIn tie_in{.md = 1000, .tvd = 800};
  tie_in.place_stated = false;
  const Check aside = CheckTieInPlace(tie_in);
  EXPECT_EQ(aside.verdict, Verdict::kWarn);
  EXPECT_NEAR(aside.value.value_or(0), 600, 1e-9);
  tie_in.tvd = 1000 - 1e-4;  // not half a metre aside: the hole is straight down
  EXPECT_EQ(CheckTieInPlace(tie_in).verdict, Verdict::kPass);
  tie_in.tvd = 1010;  // deeper than long, by less than a slot is aside
  EXPECT_EQ(CheckTieInPlace(tie_in).verdict, Verdict::kFail);
}

}  // namespace
}  // namespace wellgyro

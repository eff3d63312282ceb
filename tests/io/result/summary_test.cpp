#include "wellgyro/io/result/summary.h"

#include <cmath>

#include <gmock/gmock.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/record/run_fit.h"

namespace wellgyro {
namespace {

using testing::HasSubstr;

TEST(SummaryText, GivesTheEndAndItsEllipse) {
  Survey survey;
  Station end;
  end.md = 3012;
  end.inclination = FromDegrees(45);
  end.azimuth = FromDegrees(359.999);
  end.p_WT_W = {100.123, -250.5, 2800};
  // Half axes 3 m and 1 m, the long one 30 deg east of north.
  const double c = std::cos(FromDegrees(30)), s = std::sin(FromDegrees(30));
  end.cov_p_WT_W(0, 0) = 9 * c * c + s * s;
  end.cov_p_WT_W(1, 1) = 9 * s * s + c * c;
  end.cov_p_WT_W(0, 1) = end.cov_p_WT_W(1, 0) = 8 * s * c;
  end.cov_p_WT_W(2, 2) = 4;
  survey.chosen = {Station{}, end};
  survey.chosen[1].quality = Quality::kGap;
  Check failed;
  failed.code = "foresight";
  failed.run = 1;
  failed.value = 0.8;
  failed.limit = 0.5;
  failed.unit = "deg";
  failed.limit_source = "acceptance";
  failed.verdict = Verdict::kFail;
  Check passed = failed;
  passed.code = "gravity";
  passed.verdict = Verdict::kPass;
  Check counted = failed;
  counted.code = "samples_lost";
  counted.unit = "1";
  survey.checks = {failed, passed, counted};
  const std::string text = SummaryText(survey);
  EXPECT_THAT(text, HasSubstr("MD 3012.00 m, inclination 45.00 deg, azimuth 0.00 deg true"));
  EXPECT_THAT(text, HasSubstr("north 100.12 m, east -250.50 m, TVD 2800.00 m"));
  // 95 % of a plane normal distribution lie within 2.4477 sigma, of a line within 1.9600.
  EXPECT_THAT(text, HasSubstr("7.34 m by 2.45 m (half axes), the long one towards 30 deg"));
  EXPECT_THAT(text, HasSubstr("TVD +- 3.92 m"));
  EXPECT_THAT(text, HasSubstr("2, of which 1 good"));
  EXPECT_THAT(text, HasSubstr("check fail     foresight, run 1: 0.8 against 0.5 deg (acceptance)"));
  EXPECT_THAT(text, HasSubstr("samples_lost, run 1: 0.8 against 0.5 (acceptance)"));
  EXPECT_THAT(text, testing::Not(HasSubstr("gravity")));
  survey.chosen[1].quality |= Quality::kUnfit;
  EXPECT_THAT(SummaryText(survey), HasSubstr("95 % ellipse   none: the end is unfit\n"));
}

TEST(VerdictText, IsOneLineWithItsCauses) {
  EXPECT_EQ(VerdictText({}), "verdict pass");
  EXPECT_EQ(VerdictText({Verdict::kFail, {"a gyro is dead", "depth is missing"}}),
            "verdict fail: a gyro is dead; depth is missing");
}

Survey EndWithUnseenFaults(Quality quality) {
  Survey survey;
  Station end;
  end.run = 1;
  end.quality = quality;
  end.cov_p_WT_W.diagonal() << 1, 4, 1;
  survey.chosen = {Station{}, end};
  RunSummary run;
  run.run = 1;
  const auto fit = std::make_shared<RunFit>();
  fit->diagnosis.emplace();
  fit->diagnosis->reliability.resize(2);
  fit->diagnosis->reliability[0].shift_W << 2, 0, 9;
  fit->diagnosis->reliability[1].shift_W << 0, -4, 0;
  fit->diagnosis->reliability[1].code = "gyro_bias_step_x";
  run.fit = fit;
  survey.runs = {run};
  return survey;
}

TEST(SummaryJson, SaysOfAnUnfitEndNoEllipse) {
  const Survey survey = EndWithUnseenFaults(Quality::kUnfit);
  const ToolSummary tool{.tool = 3, .folder = "re\"sult", .files = {"a.csv"}, .survey = &survey};
  const std::string text = SummaryJson({&tool, 1}, {Verdict::kFail, {"gyro is dead"}}, 4);
  EXPECT_THAT(text, HasSubstr("\"verdict\": \"fail\""));
  EXPECT_THAT(text, HasSubstr("\"exit_code\": 4"));
  EXPECT_THAT(text, HasSubstr("\"folder\": \"re\\\"sult\""));
  EXPECT_THAT(text, HasSubstr("\"ellipse_95\": null"));
  EXPECT_THAT(text, HasSubstr("\"tvd_95_m\": null"));
  EXPECT_THAT(text, HasSubstr("\"unseen_faults\": null"));
  EXPECT_THAT(SummaryText(survey), testing::Not(HasSubstr("unseen faults")));
}

// Faults of 2 and 4 m, and the 95 % of sigmas of 1 and 2 m: alike but for a factor, so that their
// half axes add up.
TEST(Summary, WithAnUnseenFaultTheEndIsWithinItsShiftAndChanceTogether) {
  const Survey survey = EndWithUnseenFaults(Quality::kGood);
  EXPECT_THAT(SummaryText(survey),
              HasSubstr("unseen faults  with one the end is within 8.90 m by 4.45 m (half axes), "
                        "the long one towards 90 deg; TVD +- 10.96 m; most by gyro_bias_step_x, "
                        "4.00 m\n"));
  const ToolSummary tool{.tool = 3, .folder = "a", .files = {}, .survey = &survey};
  const std::string text = SummaryJson({&tool, 1}, {}, 0);
  EXPECT_THAT(text, HasSubstr("\"semi_major_m\": 8.895"));
  EXPECT_THAT(text, HasSubstr("\"semi_minor_m\": 4.447"));
  EXPECT_THAT(text, HasSubstr("\"azimuth_major_deg\": 90.0"));
  EXPECT_THAT(text, HasSubstr("\"cause\": \"gyro_bias_step_x\""));
  EXPECT_THAT(text, HasSubstr("\"cause_shift_m\": 4.0"));
  EXPECT_THAT(text, HasSubstr("\"tvd_m\": 10.95"));
  EXPECT_THAT(text, HasSubstr("\"not_shown\": []"));
}

// Where nothing tells the axes the hole may be its image across the meridian.
TEST(Summary, AxesThatNothingTellsCountAsTheHolesImage) {
  Survey survey = EndWithUnseenFaults(Quality::kGood);
  survey.chosen[0].run = 1;
  survey.chosen[0].p_WT_W.y() = 10;
  survey.chosen[1].p_WT_W.y() = 110;
  survey.checks = {{.code = "axes", .run = 1, .verdict = Verdict::kNotDone}};
  const ToolSummary tool{.tool = 3, .folder = "a", .files = {}, .survey = &survey};
  const std::string text = SummaryJson({&tool, 1}, {}, 0);
  EXPECT_THAT(text, HasSubstr("\"cause\": \"axes\""));
  EXPECT_THAT(text, HasSubstr("\"cause_shift_m\": 200.0"));
  EXPECT_THAT(text, HasSubstr("\"not_shown\": [\n          \"axes\"\n"));
  survey.checks[0].verdict = Verdict::kPass;
  EXPECT_THAT(SummaryJson({&tool, 1}, {}, 0), HasSubstr("\"cause\": \"gyro_bias_step_x\""));
}

TEST(Summary, ATieInThatNoRunLeadsToIsOnTrust) {
  Survey survey = EndWithUnseenFaults(Quality::kGood);
  survey.chosen[0].kind = StationKind::kTieIn;
  survey.chosen[0].md = 500;
  survey.checks = {{.code = "tie_in_way", .verdict = Verdict::kNotDone}};
  EXPECT_THAT(SummaryText(survey), HasSubstr("\non trust       tie_in: this run would not"));
  survey.chosen[0].cov_p_WT_W.diagonal().setConstant(4);
  EXPECT_THAT(SummaryText(survey), testing::Not(HasSubstr("on trust")));
}

// Of 9 and 1 m where chance has 4.9: only what the run does not show at any size, and what counts.
TEST(Summary, WhatTheRunWouldNotShowIsNamed) {
  Survey survey = EndWithUnseenFaults(Quality::kGood);
  const auto fit = std::make_shared<RunFit>(*survey.runs[0].fit);
  auto& faults = fit->diagnosis->reliability;
  faults.resize(4);
  faults[0] = {.code = "accel_bias_x", .shift_W = {0, 9, 0}};
  faults[1] = {.code = "accel_bias_y", .shift_W = {9, 0, 0}};
  faults[2] = {.code = "accel_scale_x", .shift_W = {0, 1, 0}};
  faults[3] = {.code = "latitude", .smallest = 0.01, .shift_W = {0, 9, 0}};
  survey.runs[0].fit = fit;
  EXPECT_THAT(SummaryText(survey),
              HasSubstr("\non trust       accel_bias_x, accel_bias_y: this run "
                        "would not show them at any size\n"));
}

// Chance has 4.9 m. The smallest that shows is one more fault, 12 m across and 12 m down.
TEST(Summary, ASlipOfDepthIsAmongTheUnseenFaults) {
  Survey survey = EndWithUnseenFaults(Quality::kGood);
  const auto slip = std::make_shared<RunSlip>();
  slip->reliability = {.code = "depth_slip", .smallest = 2, .shift_W = {0, 12, 12}};
  survey.runs[0].slip = slip;
  EXPECT_THAT(SummaryText(survey), HasSubstr("TVD +- 13.96 m; most by depth_slip, 12.00 m\n"));
  EXPECT_THAT(SummaryText(survey), testing::Not(HasSubstr("on trust")));
  // On a straight part nothing shows it.
  slip->unseen_W << 0, 30, 30;
  EXPECT_THAT(SummaryText(survey), HasSubstr("\non trust       depth_slip: this run would not"));
}

TEST(SummaryText, NothingIsSaidToBeNothing) { EXPECT_EQ(SummaryText({}), "no station\n"); }

}  // namespace
}  // namespace wellgyro

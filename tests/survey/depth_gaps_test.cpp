// Stretches of the hole that one way did not see for want of depth marks, ways in that are drawn
// back, and runs of one job that overlap or do not meet.
#include <algorithm>
#include <cmath>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/math/statistics.h"
#include "wellgyro/simulate/truth.h"

#include "support/simulated_survey.h"
#include "support/small_hole.h"

namespace wellgyro {
namespace {

using testing::Find;

constexpr testing::SmallHole kBendBelow{
    .inclination_deg = 10, .to_md = 400, .rpm = 1, .accel_noise_g = 2e-5, .stations_every = 20};

/// Straight to 150 m, 20 deg more at 250 m, straight on.
Simulation Bent() {
  Simulation simulation = SimulationOf(kBendBelow);
  simulation.well.inclination.terms.push_back(
      {.begin_md = 145, .end_md = 255, .ramp = 10, .rate = FromDegrees(0.2)});
  return simulation;
}

Job BentJob() {
  Job job = JobOf(kBendBelow);
  job.errors.depth_sigma = 0.1;
  job.errors.gyro_bias_sigma = 0.1 * units::kDegPerHour;
  job.errors.accel_bias_sigma = 5e-4;
  return job;
}

/// Without the marks of [from, to) in time.
testing::Arrives Without(UtcTime from, UtcTime to) {
  return [from, to](const SimulatedStep& step) {
    const auto* mark = std::get_if<DepthMark>(&step);
    return mark == nullptr || mark->utc < from || mark->utc >= to;
  };
}

/// When the tool first is at `md`.
UtcTime TimeAt(const Simulation& simulation, double md) {
  const Truth truth(simulation);
  double t = 0;
  while (truth.At(t).md < md) t += 0.1;
  return simulation.streams.begin_utc + Duration::Seconds(t);
}

struct EndOff {
  double metres = 0;  ///< in the horizontal plane
  double sigma = 0;   ///< root of the larger variance there [m]
  double square = 0;  ///< normalised, of two
};

/// The deepest station's place against the hole there.
EndOff EndOf(const Survey& survey, const Simulation& simulation) {
  const Station& s = survey.chosen.back();
  const Eigen::Vector2d off = (s.p_WT_W - Truth(simulation).well().PlaceAt(s.md).p_WT_W).head<2>();
  const Eigen::Matrix2d cov = s.cov_p_WT_W.topLeftCorner<2, 2>();
  return {off.norm(), std::sqrt(cov.diagonal().maxCoeff()), off.dot(cov.inverse() * off)};
}

const double kMost = ChiSquareQuantile(0.95, 2);

/// A run, and the same without the marks on the first way from 130 to 230 m.
struct Pair {
  EndOff whole, gap;
  Survey survey;  ///< of the second
};

Pair WithAndWithoutMarks(const Simulation& simulation) {
  Sink sink;
  const Survey whole = testing::SurveyOf(simulation, BentJob(), sink);
  Pair pair;
  pair.survey = testing::SurveyOf(simulation, BentJob(), sink,
                                  Without(TimeAt(simulation, 130), TimeAt(simulation, 230)));
  if (whole.chosen.empty() || pair.survey.chosen.empty()) return pair;
  pair.whole = EndOf(whole, simulation);
  pair.gap = EndOf(pair.survey, simulation);
  return pair;
}

TEST(DepthGaps, ABendThatNobodySawHasASigma) {
  const auto [whole, gap, survey] = WithAndWithoutMarks(Bent());
  ASSERT_EQ(survey.unusable, "");
  EXPECT_GT(gap.metres, 1) << "the bend begins late in the gap";
  EXPECT_LT(gap.square, kMost) << gap.metres << " m, sigma " << gap.sigma;
  EXPECT_GT(gap.sigma, 3 * whole.sigma);
  const Check* unknown = Find(survey, "depth_unknown");
  ASSERT_NE(unknown, nullptr);
  EXPECT_EQ(unknown->verdict, Verdict::kWarn);
}

TEST(DepthGaps, AnotherWayThatSawTheBendGivesIt) {
  Simulation simulation = Bent();
  simulation.run.steps.push_back(RunMove{.to_md = 0.5});
  simulation.run.steps.push_back(RunStop{.seconds = 90});
  const auto [whole, gap, survey] = WithAndWithoutMarks(simulation);
  ASSERT_EQ(survey.unusable, "");
  ASSERT_GT(whole.sigma, 0);
  EXPECT_LT(gap.metres, 0.3);
  EXPECT_LT(gap.square, kMost);
  EXPECT_LT(gap.sigma, 1.5 * whole.sigma);
}

// Kept as it was where depth ended, gravity would be 3e-4 m/s^2 off at the end of 330 m.
TEST(DepthGaps, GravityGoesWithThePathWhereDepthIsMissing) {
  testing::SmallHole hole = kBendBelow;
  hole.to_md = 500;
  const Simulation simulation = SimulationOf(hole);
  Sink sink;
  const Survey survey = testing::SurveyOf(
      simulation, BentJob(), sink, Without(TimeAt(simulation, 110), TimeAt(simulation, 440)));
  const Check* diagnosis = Find(survey, "diagnosis");
  ASSERT_NE(diagnosis, nullptr);
  ASSERT_TRUE(diagnosis->value.has_value());
  EXPECT_EQ(diagnosis->verdict, Verdict::kPass) << diagnosis->limit_source;
}

// A job may allow marks to be far apart; where the tool rests between them, depth is wrong by tens
// of metres.
TEST(DepthGaps, DepthsGuessedBetweenMarksMoveTheWayBelow) {
  Simulation simulation = Bent();
  simulation.run.steps = {RunStop{.seconds = 90}, RunMove{.to_md = 190}, RunStop{.seconds = 90},
                          RunMove{.to_md = 400}, RunStop{.seconds = 90}};
  Job job = BentJob();
  job.depth.max_gap = 600;
  Sink sink;
  const Survey survey = testing::SurveyOf(
      simulation, job, sink, Without(TimeAt(simulation, 140), TimeAt(simulation, 260)));
  ASSERT_EQ(survey.unusable, "");
  const EndOff end = EndOf(survey, simulation);
  EXPECT_GT(end.metres, 1);
  EXPECT_LT(end.square, kMost) << end.metres << " m, sigma " << end.sigma;
  const Check* unsure = Find(survey, "depth_unsure");
  ASSERT_NE(unsure, nullptr);
  EXPECT_EQ(unsure->verdict, Verdict::kWarn);
  EXPECT_GT(unsure->md.value_or(0), 140);
  EXPECT_LT(unsure->md.value_or(0), 260);
  const Survey whole = testing::SurveyOf(simulation, job, sink);
  ASSERT_NE(Find(whole, "depth_unsure"), nullptr);
  EXPECT_EQ(Find(whole, "depth_unsure")->verdict, Verdict::kPass);
}

/// On the way in the tool is drawn back at some depths, and the log ends below.
struct DrawnBack {
  const char* name;
  std::vector<double> at;  ///< [m]
  double by;               ///< [m]
};

class PullBack : public testing::TestWithParam<DrawnBack> {};

// Each begins another pass in the hole, which hangs on the way that reached it and not on the well
// head.
TEST_P(PullBack, MovesNoStationBelowIt) {
  Simulation simulation = Bent();
  Sink sink;
  const Survey straight_in = testing::SurveyOf(simulation, BentJob(), sink);
  simulation.run.steps = {RunStop{.seconds = 90}};
  const auto move_to = [&](double md) {
    simulation.run.steps.push_back(RunMove{.to_md = md, .roll = {.rate = kTwoPi / 60}});
  };
  for (const double md : GetParam().at) {
    move_to(md);
    move_to(md - GetParam().by);
    simulation.run.steps.push_back(RunStop{.seconds = 60});
  }
  move_to(400);
  simulation.run.steps.push_back(RunStop{.seconds = 90});
  const Survey survey = testing::SurveyOf(simulation, BentJob(), sink);
  ASSERT_EQ(survey.unusable, "");
  ASSERT_GE(survey.chosen.size(), straight_in.chosen.size());
  const EndOff whole = EndOf(straight_in, simulation), end = EndOf(survey, simulation);
  ASSERT_GT(whole.sigma, 0);
  EXPECT_LT(end.metres, 0.3);
  EXPECT_LT(end.square, kMost) << end.metres << " m, sigma " << end.sigma;
  EXPECT_LT(end.sigma, 1.3 * whole.sigma) << whole.sigma;
  EXPECT_GT(end.sigma, 0.5 * whole.sigma) << whole.sigma << ", with more norths on the way";
  for (const Station& s : survey.passes) {
    EXPECT_LT(s.dogleg_severity, 1.3 * FromDegrees(0.2))
        << s.md << " m in pass " << s.pass_number << ", the hole has 0.2 deg/m";
  }
}

INSTANTIATE_TEST_SUITE_P(Ways, PullBack,
                         testing::Values(DrawnBack{"Once", {230}, 3},
                                         DrawnBack{"Often", {100, 160, 190, 220, 250, 320}, 20},
                                         DrawnBack{"Far", {230, 300}, 130}),
                         [](const auto& c) { return std::string(c.param.name); });

/// From the well head to 230 m, then from `from` on, with `shift` in the second run's depths.
Survey OfTwoRuns(double from, double shift) {
  Simulation first = Bent(), second = Bent();
  first.run.steps[1] = RunMove{.to_md = 230};
  second.run.start_md = from;
  second.streams.session = 2;
  second.streams.run = 2;
  second.seed = 5;
  const Truth truth(first);
  second.streams.begin_utc = first.streams.begin_utc + Duration::Seconds(truth.seconds() + 600);
  Event begin;
  begin.kind = Event::Kind::kRunBegin;
  begin.utc = second.streams.begin_utc - Duration::Seconds(1);
  Sink sink;
  Surveyor surveyor(BentJob(), sink);
  testing::Play(first, surveyor);
  surveyor.Push(begin);
  testing::Play(second, surveyor, [shift](SimulatedStep& step) {
    if (auto* mark = std::get_if<DepthMark>(&step)) mark->md += shift;
    return true;
  });
  surveyor.Finish();
  return surveyor.Current(first.streams.tool);
}

TEST(DepthGaps, RunsThatOverlapAreCompared) {
  for (const double shift : {0.0, 4.0}) {
    const Survey survey = OfTwoRuns(160, shift);
    ASSERT_EQ(survey.unusable, "");
    const Check* check = Find(survey, "inclination_runs", 2);
    ASSERT_NE(check, nullptr);
    EXPECT_EQ(check->verdict, shift > 0 ? Verdict::kFail : Verdict::kPass)
        << check->value.value_or(NAN) << " of " << check->limit.value_or(NAN);
    EXPECT_NEAR(std::abs(check->value.value_or(NAN)), 0.2 * shift, 0.1) << "deg, by the build";
    EXPECT_EQ(Find(survey, "inclination_runs", 1), nullptr);
  }
}

TEST(DepthGaps, ARunThatBeginsBelowTheOthersBeginsWhereTheyEnd) {
  const Survey survey = OfTwoRuns(280, 0);
  ASSERT_EQ(survey.unusable, "");
  ASSERT_GT(survey.chosen.back().md, 390);
  for (std::size_t i = 1; i < survey.chosen.size(); ++i) {
    const Station &a = survey.chosen[i - 1], &b = survey.chosen[i];
    EXPECT_LT((b.p_WT_W - a.p_WT_W).norm(), b.md - a.md + 0.01)
        << "no chord is longer than its arc";
  }
  const EndOff end = EndOf(survey, Bent());
  EXPECT_LT(end.square, kMost) << end.metres << " m, sigma " << end.sigma;
  EXPECT_LT(end.metres, 3);
}

}  // namespace
}  // namespace wellgyro

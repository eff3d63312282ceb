// Cases that once ended a survey, each from a report: 2026-11-21.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <variant>

#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/simulate/truth.h"

#include "support/simulated_survey.h"
#include "support/small_hole.h"

namespace wellgyro {
namespace {

using testing::CollectingSink;

/// A survey in which `damage` may change each depth mark, given its number.
template <class Damage>
Survey Damaged(Sink& sink, Damage damage) {
  int marks = 0;
  return testing::SurveyOf(testing::Slant(), testing::SlantJob(), sink, [&](SimulatedStep& step) {
    if (auto* mark = std::get_if<DepthMark>(&step)) damage(*mark, marks++);
    return true;
  });
}

TEST(Damage, OneWrongDepthMarkIsLeftOutAndTold) {
  for (double off : {0.5, 1.0, -20.0, 1000.0, 1e9}) {
    CollectingSink sink;
    const Survey survey = Damaged(sink, [off](DepthMark& mark, int k) {
      if (k == 200 || k == 700) mark.md += off;
    });
    EXPECT_EQ(survey.unusable, "") << off;
    EXPECT_EQ(survey.chosen.size(), 16u) << off;
    // Half a metre may pass for a move while the tool is under way.
    ASSERT_GE(sink.faults.size(), std::abs(off) < 1 ? 1u : 2u) << off;
    EXPECT_NE(sink.faults[0].text.find("depth mark"), std::string::npos);
  }
}

TEST(Damage, ADepthMarkFarAheadInTimeDoesNotMakeTheOthersLate) {
  CollectingSink sink;
  const Survey survey = Damaged(sink, [](DepthMark& mark, int k) {
    if (k == 500) mark.utc = mark.utc + Duration::Seconds(10'000);
  });
  EXPECT_EQ(survey.unusable, "");
  EXPECT_EQ(survey.chosen.size(), 16u);
  EXPECT_EQ(sink.faults.size(), 1u);
}

// Marks off by up to 15 cm, from one to the next, once made an inclination wrong by 38 deg of an
// early rate of theirs that the observer then held. 2026-11-21.
TEST(Damage, RestlessDepthIsNoInclination) {
  for (const double off : {0.05, 0.1, 0.15}) {
    Sink sink;
    const Survey survey = Damaged(
        sink, [off](DepthMark& mark, int k) { mark.md += off * std::sin(12.9898 * k * k); });
    ASSERT_EQ(survey.unusable, "") << off;
    // The deepest that is read may stand beside the last whole depth.
    ASSERT_NEAR(static_cast<double>(survey.chosen.size()), 16.5, 0.5) << off;
    // The first stands on the first samples alone.
    for (std::size_t i = 1; i < survey.chosen.size(); ++i) {
      EXPECT_GT(survey.chosen[i].md, survey.chosen[i - 1].md);
      EXPECT_NEAR(ToDegrees(survey.chosen[i].inclination), 30, 0.05) << off << " i " << i;
    }
  }
}

// Found by fuzz.survey_long: the site beneath the Earth's centre ended the program. 2026-11-21.
TEST(Damage, DepthsThatNoHoleHasEndNothing) {
  for (const double off : {1e7, 1e15, -1e7}) {
    Sink sink;
    EXPECT_NO_THROW(Damaged(sink, [off](DepthMark& mark, int) { mark.md += off; })) << off;
  }
}

TEST(Damage, ImpossibleSamplesAreRefused) {
  CollectingSink sink;
  int k = 0;
  const Survey survey =
      testing::SurveyOf(testing::Slant(), testing::SlantJob(), sink, [&k](SimulatedStep& step) {
        if (auto* sample = std::get_if<ImuSample>(&step)) {
          if (++k == 3000) sample->w_IT_T.x() = 1e300;
          if (k == 4000) sample->f_T.z() = -1e300;
        }
        return true;
      });
  ASSERT_EQ(survey.unusable, "");
  EXPECT_EQ(survey.runs[0].samples_lost, 2);
  for (const Station& s : survey.chosen) {
    EXPECT_TRUE(s.cov_p_WT_W.allFinite());
    EXPECT_NEAR(s.inclination, FromDegrees(30), FromDegrees(0.1));
  }
}

// Two recordings under one session and its numbers. Until 2026-11-21 the second was taken for a
// repetition of the first.
TEST(Damage, AnotherRunUnderTheSameNumbersIsTold) {
  Simulation turned = testing::Slant();
  turned.run.steps[1] = RunMove{.to_md = 300, .roll = {.rate = 0.3}};
  for (const bool other : {false, true}) {
    CollectingSink sink;
    Surveyor surveyor(testing::SlantJob(), sink);
    testing::Play(testing::Slant(), surveyor);
    testing::Play(other ? turned : testing::Slant(), surveyor, [](const SimulatedStep& step) {
      return std::holds_alternative<ImuSample>(step);
    });
    surveyor.Finish();
    const Survey survey = surveyor.Current(0);
    const Check* refused = testing::Find(survey, "samples_refused");
    ASSERT_NE(refused, nullptr);
    EXPECT_EQ(refused->verdict, other ? Verdict::kFail : Verdict::kPass);
    const auto told = std::count_if(sink.faults.begin(), sink.faults.end(), [](const Fault& f) {
      return f.code == FaultCode::kConflict && f.text.find("another content") != std::string::npos;
    });
    EXPECT_EQ(told > 0, other);
    EXPECT_LT(told, 20);
    const RunSummary& run = survey.runs[0];
    EXPECT_EQ(run.samples_refused > 1000, other);
    EXPECT_GT(run.duplicates, 1000);
  }
}

Simulation WithoutStops() {
  Simulation quick = testing::Slant();
  std::get<RunStop>(quick.run.steps[0]).seconds = 10;
  std::get<RunStop>(quick.run.steps[2]).seconds = 10;
  return quick;
}

// Gyros without bias that are carried through a hole see the Earth's rate as well as held ones.
// Accelerometers that are not yet powered: the first stop has none, the second gives the north.
TEST(Damage, WhatFeelsNoForceAtAllIsNoStop) {
  const Simulation simulation = testing::Slant();
  CollectingSink sink;
  const Survey survey =
      testing::SurveyOf(simulation, testing::SlantJob(), sink, [&](SimulatedStep& step) {
        auto* sample = std::get_if<ImuSample>(&step);
        const double t = sample == nullptr ? 0 : (sample->stamp.tool_time - ToolTime{}).seconds();
        if (sample != nullptr && t - simulation.tool.errors.clock_offset < 80) {
          sample->f_T.setZero();
        }
        return true;
      });
  ASSERT_EQ(survey.runs.size(), 1u);
  EXPECT_EQ(survey.runs[0].fixes.size(), 1u);
  EXPECT_NE(survey.runs[0].verdict.verdict, Verdict::kPass);
}

TEST(Damage, WithoutAStopTheMotionShowsNorth) {
  const Simulation quick = WithoutStops();
  const Truth truth(quick);
  Sink sink;
  const Survey survey = testing::SurveyOf(quick, testing::SlantJob(), sink);
  ASSERT_EQ(survey.unusable, "");
  for (const Station& s : survey.chosen) {
    const double sigma = std::sqrt(s.cov_md_inc_azi(2, 2));
    EXPECT_LT(sigma, FromDegrees(0.3)) << s.md;
    EXPECT_LT(std::abs(WrapPi(s.azimuth - truth.well().PointAt(s.md).azimuth)), 4 * sigma) << s.md;
  }
}

// A bias that may be as large as the Earth's rate and a tool that does not roll.
TEST(Damage, WithoutNorthThereIsNoSurvey) {
  CollectingSink sink;
  Job job = testing::SlantJob();
  job.errors.gyro_bias_sigma = 15 * units::kDegPerHour;
  const Survey survey = testing::SurveyOf(WithoutStops(), job, sink);
  EXPECT_NE(survey.unusable.find("no north"), std::string::npos);
  EXPECT_TRUE(survey.chosen.empty());
}

TEST(Damage, FloodsAreBounded) {
  CollectingSink sink;
  Surveyor surveyor(testing::SlantJob(), sink);
  std::vector<ImuSample> batch(1);
  ImuSample& sample = batch[0];
  sample.stamp.period_ns = 10'000'000;
  sample.f_T = {4.9, 0, -8.5};
  // Twelve hundred runs, tools and sessions, of which nobody has so many.
  static_assert(Surveyor::kRunsMax < 1200);
  for (std::int32_t i = 0; i < 1200; ++i) {
    sample.stamp.seq = i;
    sample.stamp.session = i;
    sample.stamp.run = i + 1;
    sample.stamp.tool_time = ToolTime{10'000'000LL * i};
    sample.stamp.utc = UtcTime{1'700'000'000'000'000'000 + 10'000'000LL * i};
    sample.stamp.tool = 0;
    surveyor.Push(std::span<const ImuSample>(batch));
    sample.stamp.tool = i;
    surveyor.Push(std::span<const ImuSample>(batch));
    Event event;
    event.kind = Event::Kind::kRunBegin;
    event.utc = sample.stamp.utc;
    event.run = i;
    surveyor.Push(event);
  }
  Command command;
  command.kind = Command::Kind::kStartContinuous;
  for (std::int64_t i = 0; i < 3000; ++i) {
    command.utc = UtcTime{1'800'000'000'000'000'000 - i};
    surveyor.Push(command);
  }
  EXPECT_EQ(surveyor.tools().size(), Surveyor::kToolsMax);
  surveyor.Finish();
  EXPECT_LE(surveyor.Current(0).runs.size(), Surveyor::kRunsMax);
  EXPECT_NE(surveyor.Current(0).unusable, "");
  EXPECT_GT(sink.faults.size(), 100u);
}

}  // namespace
}  // namespace wellgyro

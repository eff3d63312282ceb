// Cases that once ended a survey, each from a report: 2026-11-21.
#include <cmath>
#include <cstdint>
#include <string>
#include <variant>

#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"

#include "support/simulated_survey.h"

namespace wellgyro {
namespace {

using testing::CollectingSink;

Simulation Slant() {
  Simulation simulation;
  simulation.well.end_md = 400;
  simulation.well.inclination.start = FromDegrees(30);
  simulation.well.azimuth.start = FromDegrees(45);
  simulation.earth.latitude = FromDegrees(55);
  simulation.tool.errors.gyro_noise.angle_random_walk = 0.005 * units::kDegPerSqrtHour;
  RunStop stop;
  stop.seconds = 90;
  RunMove move;
  move.to_md = 300;
  simulation.run.steps = {stop, move, stop};
  simulation.streams.imu_hz = 20;
  simulation.streams.depth_hz = 4;
  return simulation;
}

Job SlantJob() {
  Job job;
  job.well.latitude = FromDegrees(55);
  job.noise.angle_random_walk = 0.005 * units::kDegPerSqrtHour;
  job.stations.every = 20;
  return job;
}

/// A survey in which `damage` may change each depth mark, given its number.
template <class Damage>
Survey Damaged(Sink& sink, Damage damage) {
  Simulator simulator(Slant());
  Surveyor surveyor(SlantJob(), sink);
  SimulatedStep step;
  int marks = 0;
  while (simulator.Next(step)) {
    if (auto* mark = std::get_if<DepthMark>(&step)) damage(*mark, marks++);
    std::visit([&](const auto& record) { surveyor.Push(record); }, step);
  }
  surveyor.Finish();
  return surveyor.Current(0);
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

TEST(Damage, RestlessDepthStillMakesASurveyOrASentence) {
  CollectingSink sink;
  const Survey survey =
      Damaged(sink, [](DepthMark& mark, int k) { mark.md += 0.15 * std::sin(12.9898 * k * k); });
  if (survey.unusable.empty()) {
    for (std::size_t i = 1; i < survey.chosen.size(); ++i) {
      EXPECT_GT(survey.chosen[i].md, survey.chosen[i - 1].md);
    }
  }
}

TEST(Damage, ImpossibleSamplesAreRefused) {
  CollectingSink sink;
  Simulator simulator(Slant());
  Surveyor surveyor(SlantJob(), sink);
  SimulatedStep step;
  int k = 0;
  while (simulator.Next(step)) {
    if (auto* sample = std::get_if<ImuSample>(&step)) {
      if (++k == 3000) sample->w_IT_T.x() = 1e300;
      if (k == 4000) sample->f_T.z() = -1e300;
    }
    std::visit([&](const auto& record) { surveyor.Push(record); }, step);
  }
  surveyor.Finish();
  const Survey survey = surveyor.Current(0);
  ASSERT_EQ(survey.unusable, "");
  EXPECT_EQ(survey.runs[0].samples_lost, 2);
  for (const Station& s : survey.chosen) {
    EXPECT_TRUE(s.cov_p_WT_W.allFinite());
    EXPECT_NEAR(s.inclination, FromDegrees(30), FromDegrees(0.1));
  }
}

TEST(Damage, WithoutNorthThereIsNoSurvey) {
  CollectingSink sink;
  Simulation quick = Slant();
  std::get<RunStop>(quick.run.steps[0]).seconds = 10;
  std::get<RunStop>(quick.run.steps[2]).seconds = 10;
  const Survey survey = testing::SurveyOf(quick, SlantJob(), sink);
  EXPECT_NE(survey.unusable.find("no north"), std::string::npos);
  EXPECT_TRUE(survey.chosen.empty());
}

TEST(Damage, FloodsAreBounded) {
  CollectingSink sink;
  Surveyor surveyor(SlantJob(), sink);
  std::vector<ImuSample> batch(1);
  ImuSample& sample = batch[0];
  sample.stamp.period_ns = 10'000'000;
  sample.f_T = {4.9, 0, -8.5};
  // Three thousand runs, tools and sessions, of which nobody has so many.
  for (std::int32_t i = 0; i < 3000; ++i) {
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

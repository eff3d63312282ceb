// Several tools on one network: two in a string told apart, forty in one process.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/simulate/truth.h"

#include "support/simulated_survey.h"
#include "support/small_hole.h"

namespace wellgyro {
namespace {

using testing::CollectingSink;

testing::SmallHole SlantHole(double imu_hz) {
  return {.azimuth_deg = 75,
          .to_md = 150,
          .rpm = 1,
          .imu_hz = imu_hz,
          .depth_hz = 2,
          .accel_noise_g = 2e-5,
          .stations_every = 25};
}

Simulation Slant(double imu_hz) { return SimulationOf(SlantHole(imu_hz)); }
Job SlantJob() { return JobOf(SlantHole(20)); }

/// Steps of one tool's run in the order of time.
std::vector<SimulatedStep> StepsOf(const Simulation& simulation) {
  Simulator simulator(simulation);
  std::vector<SimulatedStep> steps;
  SimulatedStep step;
  while (simulator.Next(step)) steps.push_back(step);
  return steps;
}

ToolInfo InfoOf(std::int32_t tool, double below) {
  ToolInfo info;
  info.tool = tool;
  info.sensor_below_reference = below;
  return info;
}

TEST(ManyTools, TwoInOneStringAreToldApartAndEachIsSurveyed) {
  Simulation lower = Slant(20), upper = Slant(20);
  upper.streams.tool = 1;
  upper.streams.session = 2;
  upper.seed = 99;
  const std::vector<SimulatedStep> a = StepsOf(lower), b = StepsOf(upper);
  ASSERT_EQ(a.size(), b.size());
  const auto samples = std::count_if(a.begin(), a.end(), [](const SimulatedStep& step) {
    return std::holds_alternative<ImuSample>(step);
  });
  CollectingSink sink;
  Surveyor surveyor(SlantJob(), sink);
  surveyor.Push(InfoOf(0, 0));
  surveyor.Push(InfoOf(1, -4));
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::visit([&](const auto& record) { surveyor.Push(record); }, a[i]);
    if (const auto* sample = std::get_if<ImuSample>(&b[i])) surveyor.Push(*sample);
  }
  surveyor.Finish();
  EXPECT_EQ(surveyor.tools(), (std::vector<std::int32_t>{0, 1}));
  for (const Fault& fault : sink.faults) ADD_FAILURE() << fault.text;
  for (const std::int32_t tool : {0, 1}) {
    const Survey survey = surveyor.Current(tool);
    ASSERT_EQ(survey.unusable, "");
    ASSERT_EQ(survey.runs.size(), 1u);
    EXPECT_EQ(survey.runs[0].tool, tool);
    EXPECT_EQ(survey.runs[0].samples, samples);
    EXPECT_EQ(survey.runs[0].samples_lost, 0);
    EXPECT_GE(survey.chosen.size(), 6u);
    for (std::size_t i = 1; i < survey.chosen.size(); ++i) {
      const Station& s = survey.chosen[i];
      EXPECT_EQ(s.tool, tool);
      EXPECT_NEAR(ToDegrees(s.inclination), 30, 0.02);
      const double sigma = std::sqrt(s.cov_md_inc_azi(2, 2));
      EXPECT_LT(sigma, FromDegrees(1));
      EXPECT_LT(std::abs(WrapPi(s.azimuth - FromDegrees(75))), 5 * sigma);
    }
    EXPECT_NEAR(survey.chosen.back().md, tool == 0 ? 150 : 146, 0.3);
  }
}

TEST(ManyTools, FortyAtOnceGiveWhatEachGivesAlone) {
  constexpr std::int32_t kTools = 40;
  constexpr std::size_t kBatch = 10;
  const std::vector<SimulatedStep> steps = StepsOf(Slant(10));
  const auto of_tool = [&](std::int32_t tool, const ImuSample& sample) {
    ImuSample copy = sample;
    copy.stamp.tool = tool;
    copy.stamp.session = 1000 + tool;
    // No two tools see the same.
    copy.w_IT_T.x() += 1e-9 * tool;
    return copy;
  };
  const auto play = [&](Surveyor& surveyor, std::int32_t first, std::int32_t last) {
    std::vector<ImuSample> held, batch;
    const auto send = [&] {
      for (std::int32_t tool = first; tool < last && !held.empty(); ++tool) {
        batch.clear();
        for (const ImuSample& sample : held) batch.push_back(of_tool(tool, sample));
        surveyor.Push(std::span<const ImuSample>(batch));
      }
      held.clear();
    };
    for (const SimulatedStep& step : steps) {
      if (const auto* sample = std::get_if<ImuSample>(&step)) {
        held.push_back(*sample);
        if (held.size() == kBatch) send();
      } else {
        std::visit([&](const auto& record) { surveyor.Push(record); }, step);
      }
    }
    send();
    surveyor.Finish();
  };
  CollectingSink sink, alone_sink;
  Surveyor surveyor(SlantJob(), sink);
  play(surveyor, 0, kTools);
  ASSERT_EQ(surveyor.tools().size(), std::size_t{kTools});
  for (const Fault& fault : sink.faults) ADD_FAILURE() << fault.text;
  EXPECT_EQ(surveyor.tally().lost, 0);
  for (const std::int32_t tool : {0, 17, 39}) {
    Surveyor alone(SlantJob(), alone_sink);
    play(alone, tool, tool + 1);
    const Survey one = alone.Current(tool), among = surveyor.Current(tool);
    ASSERT_EQ(one.unusable, "");
    ASSERT_EQ(one.chosen.size(), among.chosen.size());
    for (std::size_t i = 0; i < one.chosen.size(); ++i) {
      EXPECT_EQ(one.chosen[i].azimuth, among.chosen[i].azimuth);
      EXPECT_EQ(one.chosen[i].p_WT_W, among.chosen[i].p_WT_W);
      EXPECT_EQ(one.chosen[i].cov_p_WT_W, among.chosen[i].cov_p_WT_W);
    }
  }
}

TEST(ManyTools, MoreThanAreAllowedAreFaultsAndNoMemory) {
  CollectingSink sink;
  Surveyor surveyor(SlantJob(), sink);
  ImuSample sample;
  sample.stamp.period_ns = 100'000'000;
  sample.f_T.z() = -9.8;
  for (std::int32_t tool = 0; tool < 300; ++tool) {
    sample.stamp.tool = tool;
    surveyor.Push(sample);
  }
  EXPECT_EQ(surveyor.tools().size(), Surveyor::kToolsMax);
  EXPECT_EQ(sink.faults.size(), 300 - Surveyor::kToolsMax);
}

TEST(ManyTools, OneTooManyLeavesTheOthersOfItsBatch) {
  // Each of kToolsMax tools has been heard for long: none of them gives way.
  constexpr std::int32_t kLong = 1000, kTools = Surveyor::kToolsMax;
  CollectingSink sink;
  Surveyor surveyor(SlantJob(), sink);
  const auto sample_of = [](std::int32_t tool, std::int64_t number) {
    ImuSample sample;
    sample.stamp.tool = tool;
    sample.stamp.seq = number;
    sample.stamp.period_ns = 100'000'000;
    sample.stamp.tool_time.ns = number * sample.stamp.period_ns;
    sample.stamp.utc.ns = sample.stamp.tool_time.ns;
    sample.f_T.z() = -9.8;
    return sample;
  };
  std::vector<ImuSample> batch;
  for (std::int32_t tool = 0; tool < kTools; ++tool) {
    batch.clear();
    for (std::int64_t i = 0; i < kLong; ++i) batch.push_back(sample_of(tool, i));
    surveyor.Push(std::span<const ImuSample>(batch));
  }
  ASSERT_TRUE(sink.faults.empty());
  const std::int64_t before = surveyor.tally().received;
  batch = {sample_of(0, kLong), sample_of(kTools, 0), sample_of(1, kLong), sample_of(kTools, 1),
           sample_of(2, kLong)};
  surveyor.Push(std::span<const ImuSample>(batch));
  EXPECT_EQ(surveyor.tally().received, before + 3);
  EXPECT_EQ(sink.faults.size(), 1u);
}

TEST(ManyTools, FinishInTheMiddleEndsAllAndWhatFollowsIsNotUsed) {
  const std::vector<SimulatedStep> steps = StepsOf(Slant(10));
  CollectingSink sink;
  Surveyor surveyor(SlantJob(), sink);
  Command finish;
  finish.command_id = 5;
  finish.kind = Command::Kind::kFinish;
  finish.utc = Simulation{}.streams.begin_utc + Duration::Seconds(200);
  surveyor.Push(finish);
  surveyor.Push(finish);
  std::size_t used = 0;
  for (const SimulatedStep& step : steps) {
    if (surveyor.finished()) break;
    std::visit([&](const auto& record) { surveyor.Push(record); }, step);
    ++used;
  }
  EXPECT_TRUE(surveyor.finished());
  EXPECT_LT(used, steps.size());
  EXPECT_EQ(sink.acknowledged, std::vector<std::int32_t>{5});
  const Survey survey = surveyor.Current(0);
  EXPECT_EQ(survey.unusable, "");
  EXPECT_LE(survey.runs[0].end, finish.utc + Duration::Seconds(0.1));
  EXPECT_EQ(survey.chosen.back().status, StationStatus::kField);
}

}  // namespace
}  // namespace wellgyro

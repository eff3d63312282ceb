// Records that are whole but wrong, of a broken sender or of one that means harm: what must not end
// a survey, keep the true stream out of it, or take memory. Each case from a report: 2026-11-22.
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "support/simulated_survey.h"
#include "support/small_hole.h"

namespace wellgyro {
namespace {

using testing::CollectingSink;

Survey Straight() {
  Sink sink;
  return testing::SurveyOf(testing::Slant(), testing::SlantJob(), sink);
}

/// The survey of the true stream, into which `also` pushes before each step what it likes.
template <class Also>
Survey With(CollectingSink& sink, Also also) {
  Surveyor surveyor(testing::SlantJob(), sink);
  int k = 0;
  testing::Play(testing::Slant(), surveyor, [&](SimulatedStep& step) {
    also(surveyor, step, k++);
    return true;
  });
  surveyor.Finish();
  return surveyor.Current(0);
}

void ExpectSame(const Survey& one, const Survey& other) {
  ASSERT_EQ(other.unusable, "");
  ASSERT_EQ(one.chosen.size(), other.chosen.size());
  for (std::size_t i = 0; i < one.chosen.size(); ++i) {
    EXPECT_EQ(one.chosen[i].md, other.chosen[i].md);
    EXPECT_EQ(one.chosen[i].azimuth, other.chosen[i].azimuth);
    EXPECT_EQ(one.chosen[i].p_WT_W, other.chosen[i].p_WT_W);
    EXPECT_EQ(one.chosen[i].cov_p_WT_W, other.chosen[i].cov_p_WT_W);
  }
}

/// As the same, but for what the depth of the first second may be off.
void ExpectNear(const Survey& one, const Survey& other) {
  ASSERT_EQ(other.unusable, "");
  ASSERT_EQ(one.chosen.size(), other.chosen.size());
  for (std::size_t i = 0; i < one.chosen.size(); ++i) {
    EXPECT_NEAR(one.chosen[i].azimuth, other.chosen[i].azimuth, 1e-6);
    EXPECT_LT((one.chosen[i].p_WT_W - other.chosen[i].p_WT_W).norm(), 1e-3);
  }
}

/// How many faults speak of `words`.
int Told(const CollectingSink& sink, const std::string& words) {
  int count = 0;
  for (const Fault& fault : sink.faults) {
    count += fault.text.find(words) != std::string::npos ? 1 : 0;
  }
  return count;
}

UtcTime TimeOf(const SimulatedStep& step) {
  if (const auto* mark = std::get_if<DepthMark>(&step)) return mark->utc;
  const auto* sample = std::get_if<ImuSample>(&step);
  return sample != nullptr ? sample->stamp.utc : Simulation{}.streams.begin_utc;
}

DepthMark MarkAt(UtcTime utc, double md) {
  DepthMark mark;
  mark.utc = utc;
  mark.session = 77;
  mark.md = md;
  return mark;
}

TEST(HostileInput, ADepthMarkOfAnotherTimeChangesNothingAndIsTold) {
  const Survey straight = Straight();
  for (const double off : {126e6, 590.0, 30.0, -3600.0}) {
    for (const int at : {0, 1, 3000}) {
      CollectingSink sink;
      const Survey survey = With(sink, [&](Surveyor& surveyor, const SimulatedStep& step, int k) {
        if (k == at) surveyor.Push(MarkAt(TimeOf(step) + Duration::Seconds(off), 50));
      });
      // One before the first sample that is of the past contradicts nothing. It is believed: the
      // first depth of the stream then has a gap before it.
      const bool believed = off < 0 && at < 3000;
      if (believed) {
        ExpectNear(straight, survey);
      } else {
        ExpectSame(straight, survey);
        EXPECT_EQ(sink.faults.size(), 1u) << off << " " << at;
      }
    }
  }
}

TEST(HostileInput, MarksThatAreMerelyAheadOfTheSamplesAreAllUsed) {
  const Survey straight = Straight();
  // Every mark comes a minute early, with a latency of five seconds.
  CollectingSink sink;
  Surveyor surveyor(testing::SlantJob(), sink);
  std::vector<SimulatedStep> samples;
  Simulator simulator(testing::Slant());
  surveyor.Push(simulator.tool_info());
  std::size_t next = 0;
  SimulatedStep step;
  while (simulator.Next(step)) {
    if (std::holds_alternative<ImuSample>(step)) {
      samples.push_back(step);
    } else {
      std::visit([&](const auto& record) { surveyor.Push(record); }, step);
    }
    while (next < samples.size() && TimeOf(step) - TimeOf(samples[next]) > Duration::Seconds(60)) {
      surveyor.Push(std::get<ImuSample>(samples[next++]));
    }
  }
  while (next < samples.size()) surveyor.Push(std::get<ImuSample>(samples[next++]));
  surveyor.Finish();
  EXPECT_TRUE(sink.faults.empty());
  ExpectSame(straight, surveyor.Current(0));
}

TEST(HostileInput, InventedToolsDoNotKeepTheRealOneOut) {
  const Survey straight = Straight();
  for (const bool before : {true, false}) {
    CollectingSink sink;
    const Survey survey = With(sink, [&](Surveyor& surveyor, const SimulatedStep& step, int k) {
      if (before ? k != 0 : (k < 500 || k >= 1500)) return;
      ImuSample invented;
      invented.stamp.utc = TimeOf(step);
      invented.stamp.period_ns = 50'000'000;
      invented.f_T.z() = -9.8;
      for (int i = 0; i < (before ? 1000 : 1); ++i) {
        invented.stamp.tool = 1000 + k + i;
        surveyor.Push(invented);
      }
    });
    ExpectSame(straight, survey);
    EXPECT_GT(Told(sink, "is one more than 256"), 0);
  }
}

TEST(HostileInput, AfterAHundredThousandModesACommandIsObeyed) {
  const Survey straight = Straight();
  CollectingSink sink;
  int modes = 0;
  const Survey survey = With(sink, [&](Surveyor& surveyor, const SimulatedStep& step, int) {
    ToolMode mode;
    mode.utc = TimeOf(step);
    mode.mode = ToolMode::Mode::kContinuous;
    for (int i = 0; i < 17; ++i, ++modes) surveyor.Push(mode);
  });
  EXPECT_GT(modes, 120'000);
  EXPECT_EQ(survey.unusable, "");
  EXPECT_EQ(survey.chosen.size(), straight.chosen.size());

  CollectingSink obeyed;
  Surveyor surveyor(testing::SlantJob(), obeyed);
  ToolMode mode;
  mode.utc = testing::Slant().streams.begin_utc;
  for (int i = 0; i < 120'000; ++i) surveyor.Push(mode);
  Command command;
  command.utc = mode.utc + Duration::Seconds(100);
  command.command_id = 5;
  command.kind = Command::Kind::kAdjust;
  surveyor.Push(command);
  testing::Play(testing::Slant(), surveyor);
  EXPECT_EQ(obeyed.acknowledged, std::vector<std::int32_t>{5});
}

TEST(HostileInput, TwoConsolesMayCountTheSameNumbers) {
  CollectingSink sink;
  With(sink, [&](Surveyor& surveyor, const SimulatedStep& step, int k) {
    if (k != 3000) return;
    Command command;
    command.utc = TimeOf(step);
    command.command_id = 7;
    command.kind = Command::Kind::kAdjust;
    for (const std::int32_t session : {1, 2, 1, 2}) {
      command.session = session;
      surveyor.Push(command);
    }
  });
  EXPECT_EQ(sink.acknowledged, (std::vector<std::int32_t>{7, 7}));
}

TEST(HostileInput, WhatNoJobMayHoldIsRefusedOnTheWireToo) {
  const Survey straight = Straight();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double absurd : {1e300, -1e300, 1e6, nan}) {
    CollectingSink sink;
    const Survey survey = With(sink, [&](Surveyor& surveyor, const SimulatedStep& step, int k) {
      if (k != 3000) return;
      ToolInfo info;
      info.sensor_below_reference = absurd;
      surveyor.Push(info);
      DepthMark mark = MarkAt(TimeOf(step), absurd);
      surveyor.Push(mark);
      mark.md = 0;
      mark.sigma = absurd;
      surveyor.Push(mark);
      Event event;
      event.utc = TimeOf(step);
      event.kind = Event::Kind::kDepthRezero;
      event.has_value = true;
      event.value_m = absurd;
      surveyor.Push(event);
      Command command;
      command.utc = TimeOf(step);
      command.kind = Command::Kind::kTakeStation;
      command.md = absurd;
      surveyor.Push(command);
    });
    ExpectSame(straight, survey);
    EXPECT_EQ(sink.faults.size(), 5u) << absurd;
    EXPECT_EQ(Told(sink, "was left out"), 5) << absurd;
  }
}

TEST(HostileInput, ATextOfMegabytesIsRefused) {
  CollectingSink sink;
  Surveyor surveyor(testing::SlantJob(), sink);
  Event event;
  event.text.assign(1 << 20, 'x');
  surveyor.Push(event);
  EXPECT_EQ(Told(sink, "4096"), 1);
}

}  // namespace
}  // namespace wellgyro

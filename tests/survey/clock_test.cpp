// Clocks that jump, step and start anew, from a report in which each ended a survey early or bent
// it without a word: 2026-11-21.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <variant>

#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"

#include "support/simulated_survey.h"
#include "support/small_hole.h"

namespace wellgyro {
namespace {

using testing::CollectingSink;
using testing::Find;

// Turns of the tool and a building hole, so that a wrong time shows as a wrong angle.
testing::SmallHole Hole() {
  testing::SmallHole hole;
  hole.inclination_deg = 20;
  hole.build_deg = 0.05;
  hole.rpm = 3;
  return hole;
}

constexpr double kJumpAt = 200;  // [s] of the run; the tool is at 110 m of 300 m

Survey WithStamps(Sink& sink, const std::function<void(SampleStamp&)>& change, const Job& job) {
  std::optional<UtcTime> begin;
  return testing::SurveyOf(SimulationOf(Hole()), job, sink, [&](SimulatedStep& step) {
    if (auto* sample = std::get_if<ImuSample>(&step)) {
      if (!begin) begin = sample->stamp.utc;
      if ((sample->stamp.utc - *begin).seconds() >= kJumpAt) change(sample->stamp);
    }
    return true;
  });
}

Survey WithStamps(Sink& sink, const std::function<void(SampleStamp&)>& change) {
  return WithStamps(sink, change, JobOf(Hole()));
}

void Move(SampleStamp& stamp, double tool_s, double utc_s, std::int64_t seq = 0) {
  stamp.tool_time = stamp.tool_time + Duration::Seconds(tool_s);
  stamp.utc = stamp.utc + Duration::Seconds(utc_s);
  stamp.seq += seq;
}

const Station& Deepest(const Survey& survey) { return survey.chosen.back(); }

/// Inclination off what the hole has, at most [deg]. The first stands on the first samples alone.
double WorstInclination(const Survey& survey) {
  double worst = 0;
  for (std::size_t i = 1; i < survey.chosen.size(); ++i) {
    const Station& s = survey.chosen[i];
    worst = std::max(worst, std::abs(ToDegrees(s.inclination) - (20 + 0.05 * s.md)));
  }
  return worst;
}

bool IsTold(const CollectingSink& sink, const std::string& what) {
  return std::any_of(sink.faults.begin(), sink.faults.end(), [&](const Fault& fault) {
    return fault.code == FaultCode::kOrder && fault.text.find(what) != std::string::npos;
  });
}

int Flagged(const Survey& survey, double from_md, double to_md) {
  return static_cast<int>(
      std::count_if(survey.chosen.begin(), survey.chosen.end(), [&](const Station& s) {
        return s.md > from_md && s.md <= to_md && Has(s.quality, Quality::kClock);
      }));
}

struct Jump {
  const char* what;
  double tool_s;
  std::int64_t seq;
};

TEST(Clock, BehindAJumpOfTheToolsClockOrNumbersTheSurveyGoesOn) {
  CollectingSink quiet;
  const Survey undisturbed = WithStamps(quiet, [](SampleStamp&) {});
  ASSERT_EQ(undisturbed.unusable, "");
  ASSERT_EQ(Find(undisturbed, "clock_jumps")->verdict, Verdict::kPass);
  ASSERT_EQ(Find(undisturbed, "samples_refused")->verdict, Verdict::kPass);
  for (const Jump& jump : {Jump{"a second on", 1, 0}, Jump{"ten seconds back", -10, 0},
                           Jump{"numbers back", 0, -2500}, Jump{"numbers on", 0, 100'000},
                           Jump{"both anew", -kJumpAt, -static_cast<std::int64_t>(20 * kJumpAt)}}) {
    SCOPED_TRACE(jump.what);
    CollectingSink sink;
    const Survey survey =
        WithStamps(sink, [&](SampleStamp& stamp) { Move(stamp, jump.tool_s, 0, jump.seq); });
    ASSERT_EQ(survey.unusable, "");
    EXPECT_EQ(survey.chosen.size(), undisturbed.chosen.size());
    EXPECT_EQ(survey.runs[0].samples, undisturbed.runs[0].samples);
    EXPECT_NEAR(Deepest(survey).md, Deepest(undisturbed).md, 1e-6);
    EXPECT_LT(WorstInclination(survey), 0.05);
    EXPECT_LT((Deepest(survey).p_WT_W - Deepest(undisturbed).p_WT_W).norm(), 0.1);
    EXPECT_TRUE(IsTold(sink, "the clock jumps before sample"));
    EXPECT_EQ(survey.runs[0].clock_jumps, 1);
    EXPECT_EQ(Find(survey, "clock_jumps")->verdict, Verdict::kWarn);
    EXPECT_EQ(Flagged(survey, 0, 100), 0);
    EXPECT_EQ(Flagged(survey, 140, 300), 0);
  }
}

// Which of the two clocks was right cannot be seen: what follows is in doubt, and says so.
TEST(Clock, AUtcThatMovesAgainstTheNumbersMakesAllDepthsBehindItDoubtful) {
  for (const double tool : {0.0, 1.0}) {
    for (const double seconds : {5.0, -10.0}) {
      SCOPED_TRACE(std::to_string(seconds) + (tool > 0 ? " with the tool's clock" : ""));
      CollectingSink sink;
      const Survey survey =
          WithStamps(sink, [&](SampleStamp& stamp) { Move(stamp, tool * seconds, seconds); });
      ASSERT_EQ(survey.unusable, "");
      EXPECT_GT(Deepest(survey).md, 260);
      EXPECT_TRUE(IsTold(sink, tool > 0 ? "the clock jumps before sample" : "UTC steps by"));
      EXPECT_EQ(survey.runs[0].clock_jumps, 1);
      EXPECT_EQ(Find(survey, "clock_jumps")->verdict, Verdict::kWarn);
      EXPECT_EQ(Flagged(survey, 0, 90), 0);
      EXPECT_GE(Flagged(survey, 160, 300), 5);
      for (const Station& s : survey.chosen) {
        // A metre a second is logged.
        if (s.md < 160 || s.md > 259) continue;
        EXPECT_TRUE(Has(s.quality, Quality::kClock)) << s.md;
        EXPECT_GE(std::sqrt(s.cov_md_inc_azi(0, 0)), 0.9 * std::abs(seconds)) << s.md;
      }
    }
  }
}

// Depths leap where the step is taken; what is passed in that leap is no good station.
TEST(Clock, NoStationPassedInTheLeapOfAStepIsGood) {
  Job job = JobOf(Hole());
  job.stations.every = 1;
  Sink sink;
  const Survey survey = WithStamps(
      sink, [](SampleStamp& stamp) { Move(stamp, 0, 5); }, job);
  ASSERT_EQ(survey.unusable, "");
  EXPECT_EQ(Find(survey, "depth_lag")->verdict, Verdict::kFail) << "depths are those of 5 s later";
  int good = 0;
  for (const Station& s : survey.chosen) {
    // The run is unfit as a whole; what was passed in the leap says so by itself too.
    const bool itself_good = s.quality == Quality::kGood || s.quality == Quality::kUnfit;
    if (s.kind == StationKind::kTieIn || s.md < 2 || !itself_good) continue;
    ++good;
    EXPECT_NEAR(ToDegrees(s.inclination), 20 + 0.05 * s.md, 0.05) << s.md;
  }
  EXPECT_GT(good, 100);
}

struct MarkCase {
  const char* what;
  double seconds, metres;
  int from, to, late, impossible;
};

TEST(Clock, DepthMarksThatAreLeftOutFailACheck) {
  const double sentinel = -999.25;
  for (const MarkCase& c : {MarkCase{"one of another depth", 0, 500, 700, 701, 0, 1},
                            MarkCase{"one sentinel", 0, sentinel, 700, 701, 0, 1},
                            MarkCase{"one far ahead", 5000, 0, 700, 701, 0, 1},
                            MarkCase{"a clock that goes back", -20, 0, 800, 1 << 20, 60, 20},
                            MarkCase{"none", 0, 0, 0, 0, 0, 0}}) {
    SCOPED_TRACE(c.what);
    CollectingSink sink;
    int k = 0;
    const Survey survey =
        testing::SurveyOf(SimulationOf(Hole()), JobOf(Hole()), sink, [&](SimulatedStep& step) {
          auto* mark = std::get_if<DepthMark>(&step);
          if (mark == nullptr) return true;
          if (k >= c.from && k < c.to) {
            mark->utc = mark->utc + Duration::Seconds(c.seconds);
            mark->md += c.metres;
          }
          ++k;
          return true;
        });
    ASSERT_EQ(survey.unusable, "");
    // Four marks a second for twenty seconds, of which those in the five of the depth latency read
    // far off the marks that came before.
    EXPECT_NEAR(static_cast<double>(survey.marks_refused), c.late + c.impossible,
                c.late > 0 ? 2 : 0);
    const Check* refused = Find(survey, "depth_refused");
    const bool any = c.late + c.impossible > 0;
    EXPECT_EQ(refused->verdict, any ? Verdict::kWarn : Verdict::kPass);
    EXPECT_EQ(refused->limit_source.find("latency_s") != std::string::npos, c.late > 0);
    EXPECT_EQ(Find(survey, "depth_unknown")->verdict, c.late > 0 ? Verdict::kWarn : Verdict::kPass);
  }
}

TEST(Clock, RareDepthMarksSayWhichKeyWouldDo) {
  CollectingSink sink;
  int k = 0;
  const Survey survey =
      testing::SurveyOf(SimulationOf(Hole()), JobOf(Hole()), sink, [&](SimulatedStep& step) {
        return !std::holds_alternative<DepthMark>(step) || ++k % 40 == 1;  // every ten seconds
      });
  const Check* unknown = Find(survey, "depth_unknown");
  ASSERT_NE(unknown, nullptr);
  EXPECT_EQ(unknown->verdict, Verdict::kWarn);
  EXPECT_NE(unknown->limit_source.find("[depth] max_gap_s = 5"), std::string::npos);
}

// Samples so far ahead of the depth find none: the survey ends there, and hole that was passed has
// no station.
TEST(Clock, HoleWhoseDepthsComeTooLateHasNoStations) {
  for (const double tool : {0.0, 30.0}) {
    CollectingSink sink;
    const Survey survey = WithStamps(sink, [&](SampleStamp& stamp) { Move(stamp, tool, 30); });
    ASSERT_EQ(survey.unusable, "");
    EXPECT_EQ(survey.runs[0].clock_jumps, 1);
    EXPECT_EQ(Find(survey, "clock_jumps")->verdict, Verdict::kWarn);
    const Check* unknown = Find(survey, "depth_unknown");
    EXPECT_EQ(unknown->verdict, Verdict::kWarn);
    EXPECT_GT(*unknown->value, 200);
    const Check* passed = Find(survey, "depth_without_station");
    ASSERT_NE(passed, nullptr);
    EXPECT_EQ(passed->verdict, Verdict::kFail);
    EXPECT_GT(*passed->value, 60);
    EXPECT_EQ(survey.verdict.verdict, Verdict::kFail);
  }
  CollectingSink sink;
  const Survey quiet = WithStamps(sink, [](SampleStamp&) {});
  EXPECT_EQ(Find(quiet, "depth_unknown")->verdict, Verdict::kPass);
  EXPECT_EQ(Find(quiet, "depth_without_station"), nullptr);
}

TEST(Clock, AToolThatStartsAnewGoesOnBehindAGap) {
  CollectingSink sink;
  const Survey survey = WithStamps(sink, [](SampleStamp& stamp) {
    ++stamp.session;
    Move(stamp, -kJumpAt, 0, -static_cast<std::int64_t>(20 * kJumpAt));
  });
  ASSERT_EQ(survey.unusable, "");
  EXPECT_EQ(survey.runs[0].clock_jumps, 0);
  EXPECT_NEAR(Deepest(survey).md, 300, 1e-3);
  EXPECT_LT(WorstInclination(survey), 0.05);
  for (const Station& s : survey.chosen)
    EXPECT_LT(std::abs(ToDegrees(s.azimuth) - 45), 0.5) << s.md;
}

TEST(Clock, StraysAreToldAndWarnedOf) {
  CollectingSink sink;
  int k = 0;
  const Survey survey = WithStamps(sink, [&](SampleStamp& stamp) {
    if (++k <= 40) Move(stamp, 1e5, 1e5);
  });
  ASSERT_EQ(survey.unusable, "");
  EXPECT_NEAR(Deepest(survey).md, 300, 1e-3);
  EXPECT_EQ(survey.runs[0].samples_refused, 40);
  EXPECT_EQ(survey.runs[0].samples_lost, 40);
  EXPECT_EQ(survey.runs[0].clock_jumps, 0);
  EXPECT_EQ(Find(survey, "samples_refused")->verdict, Verdict::kWarn);
  EXPECT_TRUE(IsTold(sink, "40 samples were left out"));
}

}  // namespace
}  // namespace wellgyro

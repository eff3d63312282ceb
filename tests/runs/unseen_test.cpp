// Surveys of runs that did not see all of the hole: what they say of the stations there and behind.
// 2026-11-21.
#include "wellgyro/attitude/unseen.h"

#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <utility>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/base/units.h"
#include "wellgyro/math/random.h"
#include "wellgyro/math/statistics.h"
#include "wellgyro/survey/run/estimated_run.h"

#include "support/hour.h"

namespace wellgyro {
namespace {

constexpr int kUnseenSeeds = WELLGYRO_LONG ? 48 : 12;
// Of the 34 sums here, one in a hundred runs of all leaves its band.
constexpr double kTail = 0.01 / (2 * 34);
constexpr double kStop = 120;  // [s]

testing::Hour UnseenTool() {
  testing::Hour hour = testing::Tactical();
  hour.errors.gyro_scale_sigma = 1e-4;
  hour.errors.gyro_misalignment_sigma = 1e-4;
  hour.errors.roll_offset_sigma = FromDegrees(0.02);
  hour.errors.depth_sigma = 0;
  return hour;
}

/// From a stop at 0 m down at 1 m/s and 3 rpm, through a hole that bends, by as much
/// as is taken for one that nobody sees, between `bend_begin` and `bend_end`.
Simulation HoleOf(std::uint64_t seed, double bend_begin, double bend_end) {
  const testing::Hour hour = UnseenTool();
  Random random(500 + seed);
  Simulation s;
  s.well.end_md = 200;
  const auto bend = [&](double per) {
    return AngleTerm{.begin_md = bend_begin,
                     .end_md = bend_end,
                     .ramp = 2,
                     .rate = UnseenHole().dogleg * random.Normal() / per};
  };
  s.well.inclination = {FromDegrees(45), {bend(1)}};
  s.well.azimuth = {FromDegrees(40), {bend(std::sin(FromDegrees(45)))}};
  s.earth.latitude = FromDegrees(hour.latitude_deg);
  s.run.roll_reference = RollReference::kHighSide;
  s.run.steps.push_back(RunStop{.seconds = kStop});
  s.seed = seed;
  testing::DrawErrors(hour.errors, hour.noise, seed, s);
  return s;
}

RunMove Down(double to_md) {
  return {.to_md = to_md, .speed = 1, .roll = {3 * kTwoPi / 60, 0, 1, 0}};
}

Job ToolsJob() {
  Job job = testing::JobOf(UnseenTool());
  job.tie_in.md = 0;
  return job;
}

/// Squared errors over sigmas by depth.
struct Squares {
  std::map<double, double> inclination, azimuth;
  void Add(const std::vector<StationState>& states, const Simulation& simulation) {
    const Truth truth(simulation);
    for (const StationState& state : states) {
      const AttitudeSample& a = state.attitude;
      const double md = 10 * std::round(state.along.md / 10);
      if (!state.along.known || std::abs(state.along.md - md) > 1e-6) continue;
      const auto at = truth.well().PointAt(md);
      inclination[md] += std::pow(a.inclination - at.inclination, 2) / a.cov_attitude(0, 0);
      azimuth[md] += std::pow(WrapPi(a.azimuth - at.azimuth), 2) / a.cov_attitude(1, 1);
    }
  }
  void Add(const Survey& survey, const Simulation& simulation) {
    const Truth truth(simulation);
    for (const Station& s : survey.chosen) {
      const auto at = truth.well().PointAt(s.md);
      inclination[s.md] += std::pow(s.inclination - at.inclination, 2) / s.cov_md_inc_azi(1, 1);
      azimuth[s.md] += std::pow(WrapPi(s.azimuth - at.azimuth), 2) / s.cov_md_inc_azi(2, 2);
    }
  }
};

/// What a surveyor does by itself, kept: of a run whose verdict is fail no station claims it any
/// more.
class Keeper : public RunAdjuster {
 public:
  SmoothedRun Adjust(const RunHistory& history) const override {
    SmoothedRun run = EstimatedRun(job_, history);
    EXPECT_TRUE(run.fit && run.fit->converged);
    kept_ = run.stations;
    return run;
  }
  const std::vector<StationState>& kept() const { return kept_; }

 private:
  Job job_ = ToolsJob();
  mutable std::vector<StationState> kept_;
};

void ExpectHonest(double sum, const char* what, double md) {
  EXPECT_GT(sum, ChiSquareQuantile(kTail, kUnseenSeeds)) << what << " at " << md;
  EXPECT_LT(sum, ChiSquareQuantile(1 - kTail, kUnseenSeeds)) << what << " at " << md;
}

/// Changes the stamps of samples, by their time from the begin of the run [s]; false: lost.
testing::Arrives EachStamp(const Simulation& simulation,
                           std::function<bool(double, SampleStamp&)> change) {
  const ToolTime begin = ToolTime{} + Duration::Seconds(simulation.tool.errors.clock_offset);
  return [begin, change = std::move(change)](SimulatedStep& step) {
    auto* sample = std::get_if<ImuSample>(&step);
    if (sample == nullptr) return true;
    return change((sample->stamp.tool_time - begin).seconds(), sample->stamp);
  };
}

TEST(Unseen, StationsInAGapAndBehindItAreAsGoodAsTheySay) {
  Squares squares;
  for (std::uint64_t seed = 1; seed <= kUnseenSeeds; ++seed) {
    Simulation simulation = HoleOf(seed, 20, 80);
    simulation.run.steps.push_back(Down(100));
    testing::CollectingSink sink;
    const auto gap = EachStamp(simulation, [](double t, const SampleStamp&) {
      return t < kStop + 49 || t >= kStop + 61.5;  // from 44 m to 56.5 m
    });
    const Keeper keeper;
    const Survey survey = testing::SurveyOf(simulation, ToolsJob(), sink, gap, &keeper);
    ASSERT_EQ(survey.chosen.size(), 11u) << survey.unusable;
    squares.Add(survey, simulation);
    for (const Station& s : survey.chosen) {
      EXPECT_EQ(Has(s.quality, Quality::kGap), s.md == 50 || s.md == 60) << s.md;
    }
    // There it is not better known than by half of what the hole may bend.
    EXPECT_GT(std::sqrt(survey.chosen[5].cov_md_inc_azi(1, 1)), 0.4 * 12.5 * UnseenHole().dogleg);
  }
  EXPECT_LT(squares.inclination[50], ChiSquareQuantile(1 - kTail, kUnseenSeeds));
  EXPECT_LT(squares.azimuth[50], ChiSquareQuantile(1 - kTail, kUnseenSeeds));
  for (const double md : {40., 60., 70., 90.}) {
    ExpectHonest(squares.inclination[md], "inclination", md);
    ExpectHonest(squares.azimuth[md], "azimuth", md);
  }
}

// Beyond 60 deg/h the gyros see nothing; below it, a stop, and a straight hole.
TEST(Unseen, StationsBelowASaturatedStretchAreAsGoodAsTheySay) {
  Squares squares;
  int blind = 0;
  for (std::uint64_t seed = 1; seed <= kUnseenSeeds; ++seed) {
    Simulation simulation = HoleOf(seed, 20, 80);
    simulation.run.steps = {RunStop{.seconds = kStop}, Down(100), RunStop{.seconds = kStop},
                            Down(160)};
    simulation.tool.errors.gyro_full_scale = 60 * units::kDegPerHour;
    testing::CollectingSink sink;
    const Keeper keeper;
    const Survey survey = testing::SurveyOf(simulation, ToolsJob(), sink, {}, &keeper);
    ASSERT_EQ(survey.chosen.size(), 17u) << survey.unusable;
    squares.Add(keeper.kept(), simulation);
    // A hole that hardly bends turns the tool by less than that.
    if (!Has(survey.chosen[5].quality, Quality::kSaturated)) continue;
    ++blind;
    EXPECT_EQ(survey.verdict.verdict, Verdict::kFail) << seed;
    for (const Station& s : survey.chosen) {
      EXPECT_EQ(Has(s.quality, Quality::kSaturated), s.md >= 30 && s.md <= 80) << s.md;
    }
  }
  EXPECT_GE(blind, kUnseenSeeds * 9 / 10);
  for (const double md : {20., 30., 50., 80., 90.}) {
    EXPECT_LT(squares.inclination[md], ChiSquareQuantile(1 - kTail, kUnseenSeeds)) << md;
    EXPECT_LT(squares.azimuth[md], ChiSquareQuantile(1 - kTail, kUnseenSeeds)) << md;
  }
  for (const double md : {110., 130., 150.}) {
    ExpectHonest(squares.inclination[md], "inclination", md);
    ExpectHonest(squares.azimuth[md], "azimuth", md);
  }
}

// Both clocks of the samples step back by ten seconds: behind that each depth is another's, and no
// direction there is that of the same depth above. The log ends before the tool does: depth tells
// of its stopping ten seconds late.
TEST(Unseen, StationsAboveAClockThatStepsBackAreAsGoodAsTheySay) {
  Squares squares;
  const Duration back = Duration::Seconds(10);
  for (std::uint64_t seed = 1; seed <= kUnseenSeeds; ++seed) {
    Simulation simulation = HoleOf(seed, 20, 180);
    simulation.run.steps.push_back(Down(200));
    testing::CollectingSink sink;
    const auto steps = EachStamp(simulation, [back](double t, SampleStamp& stamp) {
      if (t < kStop + 120) return true;
      stamp.tool_time = stamp.tool_time - back;
      stamp.utc = stamp.utc - back;
      return t < kStop + 195;
    });
    const Keeper keeper;
    const Survey survey = testing::SurveyOf(simulation, ToolsJob(), sink, steps, &keeper);
    ASSERT_GT(survey.chosen.size(), 17u) << survey.unusable;
    squares.Add(keeper.kept(), simulation);
    for (const Station& s : survey.chosen) {
      if (s.md <= 90) {
        EXPECT_EQ(Without(s.quality, Quality::kUnfit), Quality::kGood) << s.md;
      } else if (s.md > 120) {
        EXPECT_TRUE(Has(s.quality, Quality::kClock)) << s.md;
      }
    }
  }
  for (const double md : {10., 30., 60., 90.}) {
    ExpectHonest(squares.inclination[md], "inclination", md);
    ExpectHonest(squares.azimuth[md], "azimuth", md);
  }
}

}  // namespace
}  // namespace wellgyro

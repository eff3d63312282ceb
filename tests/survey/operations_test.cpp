// What people do on a job: misruns, repeats, re-zeroed depth, foresights, accepting and rejecting.
#include <algorithm>
#include <cmath>
#include <cstdint>
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
using testing::Find;

// The hole is seen by the gyros all the way to surface.
const testing::SmallHole kSlant = {.inclination_deg = 20,
                                   .build_deg = 0.05,
                                   .azimuth_deg = 130,
                                   .latitude_deg = 58,
                                   .to_md = 600,
                                   .imu_hz = 50,
                                   .depth_hz = 5,
                                   .accel_noise_g = 2e-5,
                                   .stations_every = 25};

Simulation OperatedRun() {
  Simulation simulation = SimulationOf(kSlant);
  simulation.streams.run = 0;
  simulation.tool.errors.depth_resolution = 0.01;
  return simulation;
}

RunStop Stop(double seconds) { return {.seconds = seconds}; }

RunMove Move(double to_md) {
  return {.to_md = to_md, .speed = 1.5, .ramp = 5, .roll = {.rate = kTwoPi / 60}};
}

Job OperatedJob() {
  Job job = JobOf(kSlant);
  job.errors.depth_sigma = 0.02;
  return job;
}

UtcTime Later(UtcTime begin, double seconds) { return begin + Duration::Seconds(seconds); }

Event EventAt(UtcTime utc, Event::Kind kind) {
  Event event;
  event.utc = utc;
  event.kind = kind;
  return event;
}

/// Plays a run into a surveyor; from `shift_from` on the depth system reads `shift` too much.
double Play(const Simulation& simulation, Surveyor& surveyor, double shift_from = 1e9,
            double shift = 0) {
  const UtcTime from = Later(simulation.streams.begin_utc, shift_from);
  testing::Play(simulation, surveyor, [&](SimulatedStep& step) {
    auto* mark = std::get_if<DepthMark>(&step);
    if (mark != nullptr && mark->utc >= from) mark->md += shift;
    return true;
  });
  return Truth(simulation).seconds();
}

class Operations : public ::testing::Test {
 protected:
  /// A misrun; then in, a repeat section, in to the bottom, out, and a foresight on deck. Half way
  /// up the depth counter jumps by 3 m and is re-zeroed at once.
  void Run(Surveyor& surveyor) {
    Simulation first = OperatedRun();
    first.run.steps = {Stop(90), Move(200), Stop(5)};
    first.streams.session = 1;
    begin_ = first.streams.begin_utc;
    const double length = Play(first, surveyor);
    Event misrun = EventAt(Later(begin_, length), Event::Kind::kRunEnd);
    misrun.what = "misrun";
    surveyor.Push(misrun);

    Simulation second = OperatedRun();
    second.seed = 7;
    second.streams.session = 2;
    second.streams.begin_utc = Later(begin_, length + 600);
    second.run.steps = {Stop(90),  Move(400), Stop(5),   Move(300), Stop(5),
                        Move(600), Stop(120), Move(0.5), Stop(60)};
    surveyor.Push(EventAt(Later(second.streams.begin_utc, -1), Event::Kind::kRunBegin));
    const Truth truth(second);
    rezero_ = 0.6 * truth.seconds();
    Event rezero = EventAt(Later(second.streams.begin_utc, rezero_), Event::Kind::kDepthRezero);
    rezero.has_value = true;
    rezero.value_m = truth.At(rezero_).md;
    surveyor.Push(rezero);
    const double end = truth.seconds();
    const TruthState out = truth.At(end - 5);
    Event foresight = EventAt(Later(second.streams.begin_utc, end - 5), Event::Kind::kForesight);
    foresight.value_rad = std::atan2(out.R_LT(1, 0), out.R_LT(0, 0)) + FromDegrees(2);
    foresight.sigma_rad = FromDegrees(0.05);
    foresight.has_value = true;
    surveyor.Push(foresight);
    Event back = EventAt(Later(second.streams.begin_utc, end - 5), Event::Kind::kReturnToZero);
    back.has_value = true;
    back.value_m = 0.4;
    back.sigma_m = 0.1;
    surveyor.Push(back);
    Play(second, surveyor, rezero_, 3.0);
    truth_ = second;
  }

  UtcTime begin_;
  double rezero_ = 0;
  Simulation truth_;
};

/// Every station of every run and pass is there, and of each depth one at most is not superseded.
void ExpectEveryPass(const std::vector<Station>& passes) {
  int misrun = 0, repeat = 0, out = 0;
  for (const Station& s : passes) {
    misrun += s.run == 1;
    repeat += s.pass == Pass::kRepeat;
    out += s.pass == Pass::kOut;
    if (s.run == 1) {
      EXPECT_EQ(s.status, StationStatus::kSuperseded);
    }
  }
  EXPECT_GE(misrun, 7);
  EXPECT_GE(repeat, 3);
  EXPECT_GE(out, 23 + 3);
  for (double md = 25; md <= 600; md += 25) {
    const auto alive = std::count_if(passes.begin(), passes.end(), [md](const Station& s) {
      return std::abs(s.md - md) < 0.05 && s.status == StationStatus::kField;
    });
    EXPECT_EQ(alive, 1) << md;
  }
}

void ExpectChecksOfEvents(const Survey& survey) {
  for (const char* code : {"gravity", "earth_rate", "azimuth_in_out", "inclination_in_out",
                           "azimuth_repeat", "samples_lost"}) {
    const Check* check = Find(survey, code, 2);
    ASSERT_NE(check, nullptr) << code;
    EXPECT_TRUE(check->verdict == Verdict::kPass || check->verdict == Verdict::kWarn)
        << code << " " << check->value.value_or(NAN) << " of " << check->limit.value_or(NAN);
    EXPECT_TRUE(check->value.has_value()) << code;
  }
  const Check* motion = Find(survey, "rest_motion", 2);
  ASSERT_NE(motion, nullptr);
  EXPECT_EQ(motion->verdict, Verdict::kPass) << "the tool's clock began anew";
  const Check* foresight = Find(survey, "foresight", 2);
  ASSERT_NE(foresight, nullptr);
  ASSERT_TRUE(foresight->value.has_value());
  EXPECT_LT(*foresight->sigma, 0.5);
  EXPECT_NEAR(*foresight->value, -2, 3 * *foresight->sigma);
  EXPECT_EQ(foresight->verdict, Verdict::kFail) << "2 deg are too much";
  const Check* closure = Find(survey, "depth_closure", 2);
  ASSERT_NE(closure, nullptr);
  ASSERT_TRUE(closure->value.has_value());
  EXPECT_NEAR(*closure->value, 0.1, 0.05) << "the tool stands at 0.5 m, said to be 0.4";
  const Check* grid = Find(survey, "grid_convergence", 0);
  ASSERT_NE(grid, nullptr);
  EXPECT_EQ(grid->verdict, Verdict::kNotDone);
}

TEST_F(Operations, TheRightStationsAreChosenAndTheChecksSayWhatWasDone) {
  CollectingSink sink;
  Surveyor surveyor(OperatedJob(), sink);
  Run(surveyor);
  surveyor.Finish();
  const Survey survey = surveyor.Current(0);
  ASSERT_EQ(survey.unusable, "");
  ASSERT_EQ(survey.runs.size(), 2u);
  EXPECT_TRUE(survey.runs[0].misrun);
  EXPECT_FALSE(survey.runs[1].misrun);

  // Tie-in, every 25 m to 600 m; each true, whatever the counter did.
  ASSERT_EQ(survey.chosen.size(), 1u + 24u);
  const Truth truth(truth_);
  for (std::size_t i = 1; i < survey.chosen.size(); ++i) {
    const Station& s = survey.chosen[i];
    EXPECT_DOUBLE_EQ(s.md, 25.0 * static_cast<double>(i));
    EXPECT_EQ(s.run, 2) << "nothing comes from the misrun";
    EXPECT_EQ(s.status, StationStatus::kField);
    const WellPoint point = truth.well().PointAt(s.md);
    EXPECT_NEAR(s.inclination, point.inclination, FromDegrees(0.03)) << s.md;
    EXPECT_NEAR(WrapPi(s.azimuth - point.azimuth), 0, FromDegrees(0.3)) << s.md;
    EXPECT_TRUE(Has(s.quality, Quality::kUnfit)) << "the foresight is two degrees off";
  }

  ExpectEveryPass(survey.passes);
  ExpectChecksOfEvents(survey);
}

TEST_F(Operations, AcceptedStationsAreDefinitiveAndRejectedOnesAreNotChosen) {
  CollectingSink sink;
  Surveyor surveyor(OperatedJob(), sink);
  Run(surveyor);
  Event accept = EventAt(Later(begin_, 10'000), Event::Kind::kAccept);
  accept.run = 2;
  Event reject = accept;
  reject.kind = Event::Kind::kReject;
  reject.has_value = true;
  reject.value_m = 500;
  surveyor.Push(accept);
  surveyor.Push(reject);
  surveyor.Finish();
  const Survey survey = surveyor.Current(0);
  EXPECT_TRUE(survey.accepted);
  ASSERT_EQ(survey.chosen.size(), 24u);
  for (std::size_t i = 1; i < survey.chosen.size(); ++i) {
    EXPECT_EQ(survey.chosen[i].status, StationStatus::kDefinitive);
    EXPECT_GT(std::abs(survey.chosen[i].md - 500), 1);
  }
}

// 2026-11-24: an order of the samples' newest time waited for samples behind it, and a survey that
// was broken off then was written without it.
TEST_F(Operations, WhatWasSaidLastHoldsWhereASurveyIsBrokenOff) {
  CollectingSink sink;
  Surveyor surveyor(OperatedJob(), sink);
  Run(surveyor);
  Event reject = EventAt(*surveyor.tally().newest, Event::Kind::kReject);
  reject.run = 2;
  reject.has_value = true;
  reject.value_m = 500;
  surveyor.Push(reject);
  const auto rejected = [&] {
    const Survey survey = surveyor.Current(0);
    return std::count_if(survey.passes.begin(), survey.passes.end(), [](const Station& s) {
      return s.status == StationStatus::kRejected && s.md == 500;
    });
  };
  EXPECT_EQ(rejected(), 0) << "its time has not come";
  surveyor.Flush();
  EXPECT_GE(rejected(), 1);
}

TEST_F(Operations, EveryStationGoesOutProvisionalFirstAndRevisedAfter) {
  CollectingSink sink;
  Surveyor surveyor(OperatedJob(), sink);
  Run(surveyor);
  const std::size_t before = sink.stations.size();
  EXPECT_GT(before, 20u);
  for (const Station& s : sink.stations) EXPECT_EQ(s.status, StationStatus::kProvisional);
  surveyor.Finish();
  EXPECT_GT(sink.stations.size(), before);
  std::size_t revised = 0;
  for (std::size_t i = before; i < sink.stations.size(); ++i) {
    if (sink.stations[i].status == StationStatus::kProvisional) continue;
    EXPECT_GE(sink.stations[i].revision, 1);
    ++revised;
  }
  EXPECT_GE(revised, before) << "each again";
  surveyor.Push(DepthMark{});
  EXPECT_FALSE(sink.faults.empty()) << "a message after the end is told";
}

// 2026-11-25: a run that ended on its way down after that had its last station at the same depth.
TEST(Commands, ADepthGivenToOneStationIsNoOthers) {
  Simulation simulation = OperatedRun();
  simulation.run.steps = {Stop(90), Move(300)};
  const UtcTime begin = simulation.streams.begin_utc, end = Later(begin, 150);
  CollectingSink sink;
  Surveyor surveyor(OperatedJob(), sink);
  Command command;
  command.kind = Command::Kind::kTakeStation;
  command.utc = Later(begin, 120);
  command.md = 41.3;
  surveyor.Push(command);
  testing::Play(simulation, surveyor, [end](SimulatedStep& step) {
    const auto* sample = std::get_if<ImuSample>(&step);
    return sample == nullptr || sample->stamp.utc < end;
  });
  surveyor.Finish();
  const std::vector<Station> stations = surveyor.Current(0).passes;
  const auto at = [&stations](double md) {
    return std::count_if(stations.begin(), stations.end(),
                         [md](const Station& s) { return s.md == md; });
  };
  EXPECT_EQ(at(41.3), 1);
  const TruthState last = Truth(simulation).At(150);
  ASSERT_GT(last.md, 80);
  EXPECT_NEAR(stations.back().md, last.md, 0.1);
}

}  // namespace
}  // namespace wellgyro

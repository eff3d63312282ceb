// What is told on the way, and that asking for it changes nothing that follows.
#include <cmath>
#include <cstdint>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/simulate/truth.h"

#include "support/simulated_survey.h"
#include "support/small_hole.h"

namespace wellgyro {
namespace {

using testing::CollectingSink;

/// Samples that begin within so many seconds of this time on the tool's clock are lost.
testing::Arrives Gap(const Simulation& simulation, double from, double seconds) {
  const ToolTime begin = ToolTime{} + Duration::Seconds(simulation.tool.errors.clock_offset);
  return [=](SimulatedStep& step) {
    const auto* sample = std::get_if<ImuSample>(&step);
    if (sample == nullptr) return true;
    const double t = (sample->stamp.tool_time - begin).seconds();
    return t < from || t >= from + seconds;
  };
}

// Near vertical the heading is lost in ten seconds that nobody saw, and found again when the run is
// solved anew. Stations told before had other unknowns then.
TEST(OnTheWay, PositionsGoOnBehindAGapInWhichTheHeadingIsLost) {
  const testing::SmallHole hole{.inclination_deg = 0, .to_md = 260, .rpm = 1, .stations_every = 10};
  Simulation simulation = SimulationOf(hole);
  simulation.run.roll_reference = RollReference::kNorth;
  const Truth truth(simulation);
  int told = 0;
  for (double from = 95; from < 250; from += 7) {
    CollectingSink sink;
    testing::SurveyOf(simulation, JobOf(hole), sink, Gap(simulation, from, 10));
    for (const Station& s : sink.stations) {
      if (s.status != StationStatus::kProvisional) continue;
      ++told;
      const TruthState at = truth.At((s.utc - simulation.streams.begin_utc).seconds());
      const double off = (s.p_WT_W - at.p_WT_W).head<2>().norm();
      const double sigma = std::sqrt(s.cov_p_WT_W.topLeftCorner<2, 2>().trace());
      EXPECT_LT(sigma, 0.5) << "gap " << from << " s, MD " << s.md;
      EXPECT_LT(off, 0.01 + 5 * sigma) << "gap " << from << " s, MD " << s.md;
    }
  }
  EXPECT_GT(told, 300);
}

/// The survey where it is adjusted after so many steps of the run, or never.
Survey AdjustedAt(const Simulation& simulation, const Job& job, int steps) {
  CollectingSink sink;
  Surveyor surveyor(job, sink);
  int k = 0;
  testing::Play(simulation, surveyor, [&](SimulatedStep&) {
    if (++k == steps) surveyor.Adjust();
    return true;
  });
  surveyor.Finish();
  return surveyor.Current(0);
}

void ExpectSame(const std::vector<Station>& a, const std::vector<Station>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].md, b[i].md);
    EXPECT_EQ(a[i].kind, b[i].kind) << a[i].md;
    EXPECT_EQ(a[i].inclination, b[i].inclination) << a[i].md;
    EXPECT_EQ(a[i].azimuth, b[i].azimuth) << a[i].md;
    EXPECT_EQ(a[i].p_WT_W, b[i].p_WT_W) << a[i].md;
    EXPECT_EQ(a[i].cov_p_WT_W, b[i].cov_p_WT_W) << a[i].md;
  }
}

// An adjustment closes the survey at the deepest place so far, which is none of the stations that
// the job asks for: the run goes on below it.
TEST(OnTheWay, AnAdjustmentChangesNothingThatFollows) {
  testing::SmallHole hole{.to_md = 105, .rpm = 1};
  Simulation simulation = SimulationOf(hole);
  simulation.well.end_md = 400;
  simulation.run.steps.push_back(RunMove{.to_md = 250});
  simulation.run.steps.push_back(RunStop{.seconds = 90});
  Job job = JobOf(hole);
  job.stations.at_stops = false;
  const Survey never = AdjustedAt(simulation, job, 0);
  ASSERT_EQ(never.unusable, "");
  for (const int steps : {1'000, 5'800, 6'500, 9'000}) {
    const Survey once = AdjustedAt(simulation, job, steps);
    ExpectSame(never.chosen, once.chosen);
    ExpectSame(never.passes, once.passes);
  }
}

}  // namespace
}  // namespace wellgyro

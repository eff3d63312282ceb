// A run that begins far below the tie-in, where another one ended.
#include <cmath>
#include <variant>

#include <gtest/gtest.h>

#include "wellgyro/simulate/truth.h"

#include "support/simulated_survey.h"
#include "support/small_hole.h"

namespace wellgyro {
namespace {

/// Builds from 80 m on, so that no one arc leads to the stop in the middle, at which the second run
/// begins.
Simulation TwoRuns() {
  testing::SmallHole hole{.inclination_deg = 1, .to_md = 150, .rpm = 1};
  Simulation simulation = SimulationOf(hole);
  simulation.well.end_md = 400;
  simulation.well.inclination.terms.push_back(
      {.begin_md = 80, .end_md = 380, .ramp = 20, .rate = FromDegrees(0.2)});
  simulation.run.steps.push_back(RunMove{.to_md = 290, .roll = {.rate = 0.1}});
  simulation.run.steps.push_back(RunStop{.seconds = 90});
  return simulation;
}

TEST(DeepStart, ARunGoesOnFromTheLineOfTheOneAboveIt) {
  const Simulation simulation = TwoRuns();
  const Truth truth(simulation);
  for (const bool deeper_first : {false, true}) {
    testing::CollectingSink sink;
    Job job = JobOf(testing::SmallHole{});
    const Survey survey = testing::SurveyOf(simulation, job, sink, [&](SimulatedStep& step) {
      auto* sample = std::get_if<ImuSample>(&step);
      if (sample == nullptr) return true;
      const double t = (sample->stamp.utc - simulation.streams.begin_utc).seconds();
      const bool below = t > 90 + 150 + 10 + 45;
      sample->stamp.run = below != deeper_first ? 2 : 1;
      return true;
    });
    ASSERT_EQ(survey.runs.size(), 2u);
    ASSERT_EQ(survey.unusable, "");
    int below = 0;
    for (const Station& s : survey.chosen) {
      if (s.kind == StationKind::kTieIn) continue;
      below += s.md > 160;
      const TruthState at = truth.At((s.utc - simulation.streams.begin_utc).seconds());
      EXPECT_LT((s.p_WT_W - at.p_WT_W).norm(), 0.5) << s.md;
    }
    EXPECT_GT(below, 5);
  }
}

}  // namespace
}  // namespace wellgyro

// A run that begins far below the tie-in, where another one ended.
#include <cmath>
#include <variant>

#include <gtest/gtest.h>

#include "wellgyro/simulate/truth.h"
#include "wellgyro/survey/hole/path_site.h"

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

TEST(PathSite, ARunsFirstSiteIsWhereItBegins) {
  Job job;
  job.well.latitude = FromDegrees(60);
  job.tie_in.north = 5000;
  job.tie_in.md = 100;
  job.tie_in.tvd = 90;
  PathSite site(job);
  AlongHole along;
  along.known = true;
  along.md = 450;
  site.Begin(along);
  // A meridian's degree is 111.4 km there; gravity grows by .85e-6 a metre in the Earth's crust.
  EXPECT_NEAR(site.site().latitude - FromDegrees(60), FromDegrees(5 / 111.41), FromDegrees(1e-5));
  EXPECT_NEAR(site.site().height, -440, 1e-9);
  const Site begin = site.site();
  site.Move(along, AttitudeSample{});
  EXPECT_EQ(site.site().height, begin.height);
}

constexpr testing::SmallHole kNoisy{.to_md = 600, .rpm = 1, .accel_noise_g = 2e-5};

// From 450 m in a tangent down, and out to the surface, without a tie-in: the way out is above the
// place where the run began, and in the ground all the same.
TEST(DeepStart, ARunThatComesOutAboveItsBeginFitsTogether) {
  Simulation simulation = SimulationOf(kNoisy);
  simulation.run.start_md = 450;
  simulation.run.steps.push_back(RunMove{.to_md = 0, .roll = {.rate = -0.1}});
  simulation.run.steps.push_back(RunStop{.seconds = 90});
  testing::CollectingSink sink;
  const Survey survey = testing::SurveyOf(simulation, JobOf(kNoisy), sink);
  ASSERT_EQ(survey.runs.size(), 1u);
  for (const char* code : {"fit_force", "depth_scale_felt", "diagnosis"}) {
    EXPECT_EQ(testing::Find(survey, code)->verdict, Verdict::kPass) << code;
  }
}

// Starts and stops of 60 s: what moves by a millimetre in a second still looks at rest.
TEST(DeepStart, AGentleStartIsNoFault) {
  Simulation simulation = SimulationOf(kNoisy);
  std::get<RunMove>(simulation.run.steps[1]).ramp = 60;
  testing::CollectingSink sink;
  const Survey survey = testing::SurveyOf(simulation, JobOf(kNoisy), sink);
  ASSERT_EQ(survey.runs.size(), 1u);
  for (const char* code : {"fit_force", "depth_scale_felt", "diagnosis"}) {
    EXPECT_EQ(testing::Find(survey, code)->verdict, Verdict::kPass) << code;
  }
}

}  // namespace
}  // namespace wellgyro

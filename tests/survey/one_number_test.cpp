// Of one revision a station has one position and one covariance: what the sink was told is what the
// survey holds, at every moment.
#include <cstdint>
#include <map>
#include <utility>
#include <variant>

#include <gtest/gtest.h>

#include "support/simulated_survey.h"
#include "support/small_hole.h"

namespace wellgyro {
namespace {

struct LastTold : Sink {
  void OnStation(const Station& s) override {
    told.insert_or_assign(std::pair(s.run, s.utc.ns), s);
  }
  /// Whatever kind it was then: of the stop at the end, a continuous one (2026-11-24).
  std::map<std::pair<std::int32_t, std::int64_t>, Station> told;
};

/// How many stations of the survey the sink was told in the same revision; each must be the same.
int Compare(const Survey& survey, const LastTold& sink) {
  int compared = 0;
  for (const std::vector<Station>* stations : {&survey.passes, &survey.chosen}) {
    for (const Station& s : *stations) {
      const auto found = sink.told.find(std::pair(s.run, s.utc.ns));
      if (found == sink.told.end() || found->second.revision != s.revision) continue;
      ++compared;
      EXPECT_EQ(found->second.md, s.md);
      EXPECT_EQ(found->second.azimuth, s.azimuth);
      EXPECT_EQ(found->second.inclination, s.inclination);
      EXPECT_EQ(found->second.p_WT_W, s.p_WT_W) << "MD " << s.md;
      EXPECT_EQ(found->second.cov_p_WT_W, s.cov_p_WT_W) << "MD " << s.md;
      EXPECT_EQ(found->second.cov_md_inc_azi, s.cov_md_inc_azi) << "MD " << s.md;
    }
  }
  return compared;
}

TEST(OneNumber, WhatIsToldIsWhatTheSurveyHolds) {
  testing::SmallHole hole{.build_deg = 0.1, .to_md = 200, .rpm = 1};
  Simulation simulation = SimulationOf(hole);
  simulation.run.steps.push_back(RunMove{.to_md = 20});
  simulation.run.steps.push_back(RunStop{.seconds = 90});
  LastTold sink;
  Surveyor surveyor(JobOf(hole), sink);
  int k = 0, compared = 0;
  testing::Play(simulation, surveyor, [&](SimulatedStep&) {
    if (++k % 700 == 0) compared += Compare(surveyor.Current(0), sink);
    if (k == 6000) surveyor.Adjust();
    return true;
  });
  EXPECT_GT(compared, 50);
  surveyor.Finish();
  const Survey survey = surveyor.Current(0);
  ASSERT_EQ(survey.unusable, "");
  const int last = Compare(survey, sink);
  // All but the tie-in, which nobody is told.
  EXPECT_GE(last + 2, static_cast<int>(survey.passes.size() + survey.chosen.size()));
}

}  // namespace
}  // namespace wellgyro

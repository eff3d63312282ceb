#include "wellgyro/survey/stations/station_plan.h"

#include <vector>

#include <gtest/gtest.h>

namespace wellgyro {
namespace {

std::vector<double> Depths(const StationPlan& plan, double from, double to, bool inclusive) {
  std::vector<StationPlan::Target> targets;
  plan.Between(from, to, inclusive, targets);
  std::vector<double> depths;
  for (const auto& target : targets) depths.push_back(target.md);
  return depths;
}

Job EveryTen() {
  Job job;
  job.stations.every = 10;
  job.tie_in.inclination = job.tie_in.azimuth = 0;
  return job;
}

TEST(StationPlan, AdjoiningStretchesGiveEachMultipleOnce) {
  const StationPlan plan(EveryTen());
  EXPECT_EQ(Depths(plan, 3, 20, false), (std::vector<double>{10, 20}));
  EXPECT_EQ(Depths(plan, 20, 31, false), (std::vector<double>{30}));
  EXPECT_EQ(Depths(plan, 20, 31, true), (std::vector<double>{20, 30}));
}

TEST(StationPlan, GoesUpInTheOrderOfTheTool) {
  const StationPlan plan(EveryTen());
  EXPECT_EQ(Depths(plan, 31, 10, false), (std::vector<double>{30, 20, 10}));
  EXPECT_EQ(Depths(plan, 10, 5, false), (std::vector<double>{}));
}

TEST(StationPlan, AskedDepthsJoinTheMultiples) {
  Job job = EveryTen();
  job.stations.at = {12.5, 20.05};
  EXPECT_EQ(Depths(StationPlan(job), 3, 25, false), (std::vector<double>{10, 12.5, 20}));
}

TEST(StationPlan, ATieInWithoutAttitudeNeedsAStationThatIsNotListed) {
  Job job = EveryTen();
  job.tie_in.inclination.reset();
  job.tie_in.azimuth.reset();
  job.tie_in.md = 5;
  std::vector<StationPlan::Target> targets;
  StationPlan(job).Between(0, 11, false, targets);
  ASSERT_EQ(targets.size(), 2u);
  EXPECT_FALSE(targets[0].listed);
  EXPECT_TRUE(targets[1].listed);
}

}  // namespace
}  // namespace wellgyro

// Live advice followed by fifty runs whose hole is not quite the planned one.
#include <cstdio>

#include <gtest/gtest.h>

#include "wellgyro/plan/stop_plan.h"

#include "plan/cases.h"
#include "plan/followed_run.h"

namespace wellgyro {
namespace {

/// The hole as it was drilled: turned and leaning by this much [deg] against its plan.
PlanCase Drilled(const PlanCase& c, double inclination, double azimuth) {
  std::vector<double> md, inc, azi;
  for (std::size_t i = 0; i < c.well.size(); ++i) {
    const TrajectoryPoint p = c.well.station(i);
    md.push_back(p.md);
    inc.push_back(p.inclination + inclination * units::kDeg);
    azi.push_back(p.azimuth + azimuth * units::kDeg);
  }
  PlanCase truth = c;
  truth.well = Trajectory(md, inc, azi, {0, 0, md.front()});
  return truth;
}

struct Well {
  const char* name;
  PlanCase c;
  double ellipse;
  int runs;
};

TEST(Followed, FiftyRunsMeetTheirLimitInTheTimeOfAPlanThatKnowsTheTruth) {
  const std::vector<Well> wells = {{"slant", test::Slant(), 7.2, 17},
                                   {"S", test::SShape(), 6.0, 16},
                                   {"horizontal", test::Horizontal(), 5.9, 17}};
  int runs = 0, met = 0, failed = 0, in_time = 0;
  double worst_ms = 0;
  for (const Well& well : wells) {
    const PlanLimits limits{.ellipse = well.ellipse};
    double cost = 0, ellipse = 0;
    int told = 0;
    const PlanCase truth = Drilled(well.c, 1, -3);
    const StopPlan plan = PlanStops(truth, limits);
    ASSERT_TRUE(plan.feasible);
    for (int i = 0; i < well.runs; ++i) {
      const auto seed = static_cast<std::uint64_t>(runs + 11);
      const test::Followed run = test::FollowedRun(well.c, truth, limits, seed).Follow();
      ++runs;
      worst_ms = std::max(worst_ms, run.worst_ms);
      cost += run.cost / well.runs;
      in_time += run.cost <= 1.15 * plan.cost ? 1 : 0;
      if (run.failed) {
        ++failed;
        continue;
      }
      ++told;
      if (run.ellipse > 1.01 * limits.ellipse) {
        std::printf("seed %d: %.2f m after %.0f s\n", static_cast<int>(seed), run.ellipse,
                    run.cost);
      }
      ellipse += run.ellipse;
      met += run.ellipse <= 1.01 * limits.ellipse ? 1 : 0;
    }
    std::printf(
        "%s: plan with the truth known %.0f s, followed %.0f s; %.3f m of %.3f m, %d runs\n",
        well.name, plan.cost, cost, ellipse / told, limits.ellipse, told);
    std::fflush(stdout);
    EXPECT_LE(cost, 1.15 * plan.cost) << well.name;
  }
  std::printf(
      "met within 1 %% %d of %d, failed by verdict %d; in 1.15 of the time %d of %d; "
      "worst advice %.0f ms of a processor\n",
      met, runs - failed, failed, in_time, runs, worst_ms);
  EXPECT_GE(met, 0.95 * (runs - failed));
}

}  // namespace
}  // namespace wellgyro

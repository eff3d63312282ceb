#include "wellgyro/fit/run_adjustment.h"

#include <cmath>
#include <cstdint>
#include <cstdio>

#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"

#include "support/hour.h"

namespace wellgyro {
namespace {

using testing::Flown;
using testing::Fly;
using testing::Hour;
using testing::JobOf;
using testing::StrongDrift;

struct Tally {
  double squared = 0, sigma = 0, worst = 0;
  int runs = 0, unknown = 0;
};

/// The azimuth at the end of each of several hours, against its own sigma.
Tally EndOfHours(const Hour& hour, const Job& job, int seeds) {
  Tally tally;
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(seeds); ++seed) {
    const Flown flown = Fly(hour, job, seed);
    const Adjustment adjusted = AdjustRun(flown.history, 0);
    const AttitudeSample& end = adjusted.run.attitude.back();
    if (!adjusted.converged || adjusted.ambiguous || !end.azimuth_known) {
      ++tally.unknown;
      continue;
    }
    const double error = WrapPi(end.azimuth - flown.truth.back().azimuth);
    const double variance = end.cov_attitude(1, 1);
    tally.squared += error * error / variance;
    tally.sigma += std::sqrt(variance);
    tally.worst = std::max(tally.worst, std::abs(error));
    ++tally.runs;
  }
  tally.sigma /= std::max(1, tally.runs);
  std::printf("%d runs: mean squared normalised error %.2f, sigma %.3f deg, worst %.3f deg\n",
              tally.runs, tally.squared / tally.runs, ToDegrees(tally.sigma),
              ToDegrees(tally.worst));
  return tally;
}

// 24 degrees of freedom: the 0.0005 and 0.9995 quantiles of chi-square are 7.45 and 52.6.
TEST(RunAdjustment, NorthFromThreeStopsAndTheMotionIsAsGoodAsItSays) {
  const Hour hour = StrongDrift();
  const Tally tally = EndOfHours(hour, JobOf(hour), 24);
  EXPECT_EQ(tally.unknown, 0);
  EXPECT_GT(tally.squared, 7.45);
  EXPECT_LT(tally.squared, 52.6);
  EXPECT_LT(ToDegrees(tally.sigma), 0.35);
}

TEST(RunAdjustment, AnExternalAzimuthAtTheStartIsAsGoodAsItSays) {
  Hour hour = StrongDrift();
  hour.stops = 0;
  Job job = JobOf(hour);
  job.alignment.method = AlignmentSpec::Method::kExternal;
  job.alignment.azimuth = Truth(testing::SimulationOf(hour, 0)).well().PointAt(5).azimuth;
  job.alignment.sigma_azimuth = FromDegrees(1e-3);
  const Tally tally = EndOfHours(hour, job, 24);
  EXPECT_EQ(tally.unknown, 0);
  EXPECT_GT(tally.squared, 7.45);
  EXPECT_LT(tally.squared, 52.6);
  EXPECT_LT(ToDegrees(tally.sigma), 0.2);
}

TEST(RunAdjustment, ASurveyorTakesIt) {
  Hour hour = StrongDrift();
  hour.minutes = 20;
  const LeastSquaresAdjuster adjuster;
  Sink sink;
  Surveyor surveyor(JobOf(hour), sink, &adjuster);
  Simulator simulator(testing::SimulationOf(hour, 3));
  SimulatedStep step;
  while (simulator.Next(step)) {
    std::visit([&](const auto& record) { surveyor.Push(record); }, step);
  }
  surveyor.Finish();
  const Survey survey = surveyor.Current(0);
  ASSERT_EQ(survey.unusable, "");
  EXPECT_GT(survey.chosen.size(), 10u);
  for (const Station& s : survey.chosen) EXPECT_TRUE(s.cov_p_WT_W.allFinite());
}

}  // namespace
}  // namespace wellgyro

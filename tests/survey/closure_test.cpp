// Simulate, survey, compare with the truth.
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/simulate/truth.h"

#include "support/simulated_survey.h"

namespace wellgyro {
namespace {

using testing::CollectingSink;
using testing::SurveyOf;

/// An hour down a hole that swings in azimuth and undulates in inclination.
Simulation SwingingRun(double inclination_deg) {
  Simulation simulation;
  simulation.well.begin_md = 0;
  simulation.well.end_md = 2200;
  simulation.well.inclination.start = FromDegrees(inclination_deg);
  simulation.well.inclination.terms.push_back({.amplitude = FromDegrees(1.8), .period = 700});
  simulation.well.azimuth.start = FromDegrees(40);
  simulation.well.azimuth.terms.push_back({.amplitude = FromDegrees(50), .period = 2200});
  simulation.earth.latitude = FromDegrees(60);
  simulation.run.start_md = 0;
  simulation.run.roll_reference = RollReference::kHighSide;
  RunMove move;
  move.to_md = 2100;
  move.speed = 0.6;
  move.roll.rate = kTwoPi * 3 / 60;
  move.roll.amplitude = FromDegrees(25);
  move.roll.period = 23;
  simulation.run.steps = {RunStop{.seconds = 5}, move, RunStop{.seconds = 5}};
  return simulation;
}

/// Told the azimuth of the axis where the run begins.
Job ExternalJob(const Simulation& simulation) {
  Job job;
  job.well.latitude = simulation.earth.latitude;
  job.well.datum_elevation = simulation.earth.height;
  job.alignment.method = AlignmentSpec::Method::kExternal;
  const WellPoint begin = Truth(simulation).well().PointAt(simulation.run.start_md);
  job.alignment.azimuth = begin.azimuth;
  job.alignment.sigma_azimuth = FromDegrees(1e-4);
  job.tie_in.md = begin.md;
  job.tie_in.tvd = 0;
  return job;
}

class PerfectTool : public ::testing::TestWithParam<double> {};

TEST_P(PerfectTool, StaysWithinAHundredthOfADegreeForAnHour) {
  const Simulation simulation = SwingingRun(GetParam());
  const Truth truth(simulation);
  CollectingSink sink;
  const Survey survey = SurveyOf(simulation, ExternalJob(simulation), sink);
  ASSERT_EQ(survey.unusable, "");
  for (const Fault& fault : sink.faults) ADD_FAILURE() << fault.text;
  ASSERT_EQ(survey.chosen.size(), 211u) << "the tie-in and a station every 10 m to 2100 m";
  double worst_azimuth = 0, worst_inclination = 0, worst_position = 0;
  for (const Station& station : survey.chosen) {
    const WellPoint point = truth.well().PointAt(station.md);
    worst_azimuth = std::max(worst_azimuth, std::abs(WrapPi(station.azimuth - point.azimuth)));
    worst_inclination =
        std::max(worst_inclination, std::abs(station.inclination - point.inclination));
    const Eigen::Vector3d p_WT_W = truth.well().PlaceAt(station.md).p_WT_W;
    worst_position = std::max(worst_position, (station.p_WT_W - p_WT_W).norm());
  }
  RecordProperty("worst_azimuth_udeg", static_cast<int>(ToDegrees(worst_azimuth) * 1e6));
  std::printf("I %5.1f: azimuth %.2e deg, inclination %.2e deg, position %.3f m, %zu stations\n",
              GetParam(), ToDegrees(worst_azimuth), ToDegrees(worst_inclination), worst_position,
              survey.chosen.size());
  EXPECT_LT(ToDegrees(worst_azimuth), 0.01);
  EXPECT_LT(ToDegrees(worst_inclination), 0.01);
  EXPECT_LT(worst_position, 0.02) << "over the way, not from station to station";
}

// At 1 Hz and 3 rpm a sample turns by 18 deg and more: what the cheaper form leaves out is seen.
TEST(AttitudeOrder, OfTheJobIsThatOfTheSurvey) {
  Simulation simulation = SwingingRun(30);
  simulation.streams.imu_hz = 1;
  const Truth truth(simulation);
  const auto worst = [&](AttitudeSpec::Order order) {
    Job job = ExternalJob(simulation);
    job.attitude.order = order;
    CollectingSink sink;
    const Survey survey = SurveyOf(simulation, job, sink);
    EXPECT_EQ(survey.unusable, "");
    double most = 0;
    for (const Station& station : survey.chosen) {
      const WellPoint point = truth.well().PointAt(station.md);
      most = std::max(most, std::abs(WrapPi(station.azimuth - point.azimuth)));
    }
    return ToDegrees(most);
  };
  const double second = worst(AttitudeSpec::Order::kSecond),
               third = worst(AttitudeSpec::Order::kThird);
  std::printf("1 Hz: second order %.2e deg, third %.2e deg\n", second, third);
  EXPECT_GT(second, 2 * third);
  EXPECT_LT(second, 2e-3);
}

INSTANTIATE_TEST_SUITE_P(Inclinations, PerfectTool, ::testing::Values(10, 30, 60, 90, 110));

}  // namespace
}  // namespace wellgyro

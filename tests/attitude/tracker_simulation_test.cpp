#include <algorithm>
#include <cmath>
#include <variant>

#include <gtest/gtest.h>

#include "wellgyro/attitude/tracker.h"
#include "wellgyro/base/angle.h"
#include "wellgyro/simulate/simulator.h"

#include "attitude/tracker_truth.h"

namespace wellgyro {
namespace {

// A build from 20 to 70 deg while the azimuth swings, run in with a turning tool, a stop half-way,
// out again sliding; samples from the simulator, which shares no formula with the tracker.
Simulation BuildAndBack() {
  Simulation s;
  s.well.begin_md = 0;
  s.well.end_md = 800;
  s.well.inclination = {FromDegrees(20), {{.rate = FromDegrees(50) / 800}}};
  s.well.azimuth = {FromDegrees(40), {{.amplitude = FromDegrees(20), .period = 900}}};
  s.run.start_md = 50;
  s.run.roll_reference = RollReference::kHighSide;
  s.run.steps = {
      RunStop{.seconds = 60},
      RunMove{.to_md = 400, .speed = 1, .roll = {.rate = 0.3, .amplitude = 0.4, .period = 23}},
      RunStop{.seconds = 30},
      RunMove{.to_md = 750, .speed = 1.5, .roll = {.rate = -0.2}},
      RunStop{.seconds = 20},
      RunMove{.to_md = 50, .speed = 1.2}};
  s.earth.latitude = FromDegrees(60);
  s.streams.depth_hz = 0;
  s.streams.imu_hz = 20;
  return s;
}

TEST(TrackerSimulation, FollowsABuildAndBack) {
  Simulator simulator(BuildAndBack());
  const Truth& truth = simulator.truth();
  HighSideTracker tracker({});
  double azimuth = truth.At(0).azimuth, inclination = truth.At(0).inclination;
  double worst_azimuth = 0, worst_inclination = 0;
  SimulatedStep step;
  while (simulator.Next(step)) {
    const auto* sample = std::get_if<ImuSample>(&step);
    if (sample == nullptr) continue;
    const double middle = simulator.SampleTime(sample->stamp.seq) + 0.025;
    const TruthState now = truth.At(middle);
    const double after = truth.At(middle + 0.05).speed, before = truth.At(middle - 0.05).speed;
    const AlongHole along{now.md, now.speed, (after - before) / 0.1, 0, true};
    const Site site = SiteAt(now.latitude, now.height);
    tracker.SetAzimuth(azimuth);
    ASSERT_TRUE(tracker.Push(*sample, along, site));
    if (sample->stamp.seq % 10 != 0 || !tracker.ready()) continue;
    const Knot knot = tracker.CutKnot();
    azimuth = truth::Propagate(azimuth, inclination, {knot}, site).back();
    inclination = knot.inclination;
    const TruthState then = truth.At(middle - 0.025);
    worst_azimuth = std::max(worst_azimuth, std::abs(WrapPi(azimuth - then.azimuth)));
    worst_inclination = std::max(worst_inclination, std::abs(inclination - then.inclination));
    EXPECT_NEAR(WrapPi(knot.toolface - then.toolface), 0, FromDegrees(1e-3));
  }
  EXPECT_LT(worst_azimuth, FromDegrees(1e-4));
  EXPECT_LT(worst_inclination, FromDegrees(1e-4));
}

}  // namespace
}  // namespace wellgyro

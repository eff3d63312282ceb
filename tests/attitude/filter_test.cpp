#include "wellgyro/attitude/filter.h"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/math/statistics.h"

#include "attitude/filter_truth.h"

namespace wellgyro {
namespace {

using namespace units;  // NOLINT: factors of the trade
using filter_truth::ExternalFix;
using filter_truth::FixOf;
using filter_truth::MakeKnots;
using filter_truth::Plan;
using filter_truth::Pose;
using filter_truth::SetupAt;
using filter_truth::Truth;

// A hole that builds and turns, one metre a second, the tool rolling.
Pose TurningHole(double t, double inclination, double rpm) {
  return {.inclination = FromDegrees(inclination + 1.8 * std::sin(t / 250)),
          .azimuth = FromDegrees(200 + 50 * std::sin(t / 700)),
          .toolface = 0.4 + rpm * kTwoPi / 60 * t,
          .md = 500 + t};
}

TEST(AzimuthFilter, FollowsATurningHoleWithoutSensorErrors) {
  for (const double latitude : {-35.0, 0.0, 72.0}) {
    for (const double inclination : {5.0, 60.0, 110.0}) {
      for (const double length : {1.0, 10.0}) {
        FilterSetup setup = SetupAt(FromDegrees(latitude));
        Plan plan;
        plan.motion = [&](double t) { return TurningHole(t, inclination, 3); };
        plan.seconds = 3600;
        plan.knot_seconds = length;
        plan.steps_per_knot = static_cast<int>(4 * length);
        const Truth truth = MakeKnots(plan, setup, 0);
        setup.start_azimuth = truth.start.azimuth;
        AzimuthFilter filter(setup);
        double worst = 0;
        for (std::size_t i = 0; i < truth.knots.size(); ++i) {
          const AttitudeSample& a = filter.Step(truth.knots[i]);
          worst = std::max(worst, std::abs(WrapPi(a.azimuth - truth.poses[i].azimuth)));
        }
        // Mid-point over a knot: the error falls as its square.
        EXPECT_LT(ToDegrees(worst), length < 2 ? 3e-5 : 3e-3)
            << latitude << " " << inclination << " " << length;
      }
    }
  }
}

}  // namespace
}  // namespace wellgyro

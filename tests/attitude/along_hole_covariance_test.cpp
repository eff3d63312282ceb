#include "wellgyro/attitude/along_hole_covariance.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/attitude/filter.h"
#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"

#include "attitude/filter_truth.h"

namespace wellgyro {
namespace {

using filter_truth::MakeKnots;
using filter_truth::Plan;
using filter_truth::SetupAt;
using filter_truth::Truth;

constexpr double kSpeed = 0.5, kHours = 1, kInclination = 0.6;

// A straight hole to the north, where the Earth's rate does not feed back into azimuth, the tool
// sliding with its mark up so that the x gyro alone makes azimuth.
std::vector<StationState> DeadReckon(const FilterSetup& tool, double seconds, int every,
                                     bool out = false) {
  FilterSetup setup = tool;
  setup.start_azimuth = 0;
  Plan plan;
  plan.motion = [out](double t) {
    return filter_truth::Pose{.inclination = kInclination,
                              .azimuth = 0,
                              .toolface = 0,
                              .md = out ? 3000 - kSpeed * t : 1000 + kSpeed * t};
  };
  plan.seconds = seconds;
  plan.steps_per_knot = 2;
  const Truth truth = MakeKnots(plan, setup, 0);
  AzimuthFilter filter(setup);
  Knot first;
  first.inclination = kInclination;
  first.along = {.md = out ? 3000.0 : 1000.0, .known = true};
  filter.Step(first);
  filter.MarkStation();
  for (std::size_t i = 0; i < truth.knots.size(); ++i) {
    filter.Step(truth.knots[i]);
    if ((i + 1) % static_cast<std::size_t>(every) == 0) filter.MarkStation();
  }
  return filter.stations();
}

struct Process {
  const char* name;
  std::function<void(FilterSetup*)> set;
  double azimuth;   // variance after one hour x sin^2 I
  double position;  // variance across / speed^2
};

// Closed forms for one process alone over t: with rate error w(t), azimuth int w / sin I and, as
// sin I cancels, position v int int w. N: t and t^3/3; B: t^2 and t^4/4; K: t^3/3 and t^5/20;
// R: t^4/4 and t^6/36.
std::vector<Process> Processes() {
  const double t = kHours * units::kHour;
  const double n = 0.25 * units::kDegPerSqrtHour, b = 0.5 * units::kDegPerHour;
  const double k = 0.5 * units::kDegPerHourSqrtHour, r = 0.3 * units::kDegPerHour2;
  return {
      {"N", [=](FilterSetup* s) { s->gyro.angle_random_walk = n; }, n * n * t,
       n * n * std::pow(t, 3) / 3},
      {"B", [=](FilterSetup* s) { s->gyro.bias_instability = b; }, b * b * t * t,
       b * b * std::pow(t, 4) / 4},
      {"K", [=](FilterSetup* s) { s->gyro.rate_random_walk = k; }, k * k * std::pow(t, 3) / 3,
       k * k * std::pow(t, 5) / 20},
      {"R", [=](FilterSetup* s) { s->gyro.rate_ramp = r; }, r * r * std::pow(t, 4) / 4,
       r * r * std::pow(t, 6) / 36},
  };
}

TEST(AlongHoleCovariance, ClosedFormsOfDriftInAStraightHole) {
  for (const Process& p : Processes()) {
    FilterSetup setup = SetupAt(FromDegrees(60));
    p.set(&setup);
    const auto stations = DeadReckon(setup, kHours * units::kHour, 1);
    const double s2 = std::sin(kInclination) * std::sin(kInclination);
    EXPECT_NEAR(stations.back().attitude.cov_attitude(1, 1) * s2, p.azimuth, 1e-7 * p.azimuth)
        << p.name;
    const auto cov =
        CovarianceAlongHole(stations, TimeAlongHole::kWithDepth, Eigen::Matrix3d::Zero(), 0);
    // Trapezoids over 360 legs against the integral.
    const double expected = kSpeed * kSpeed * p.position;
    EXPECT_NEAR(cov.back()(1, 1), expected, 1e-4 * expected) << p.name;
    EXPECT_LT(cov.back()(0, 0), 1e-12 * expected) << p.name;
  }
}

// Out of the hole with time t from the bottom, T at the shallowest station: a station's position
// is that of the shallowest plus v int_t^T A dt, A = int_0^t w / sin I. At the bottom the same as
// on the way in.
TEST(AlongHoleCovariance, AgainstDepthTheSumRunsTheOtherWay) {
  for (const Process& p : Processes()) {
    FilterSetup setup = SetupAt(FromDegrees(60));
    p.set(&setup);
    auto stations = DeadReckon(setup, kHours * units::kHour, 1, true);
    std::reverse(stations.begin(), stations.end());
    const auto cov =
        CovarianceAlongHole(stations, TimeAlongHole::kAgainstDepth, Eigen::Matrix3d::Zero(), 0);
    const double expected = kSpeed * kSpeed * p.position;
    EXPECT_NEAR(cov.back()(1, 1), expected, 1e-4 * expected) << p.name;
  }
  // Half way, for white noise: var int_{T/2}^T A dt = N^2 (T/2)^3 (1 + 1/3) [A(T/2) and the rest].
  FilterSetup setup = SetupAt(FromDegrees(60));
  const double n = 0.25 * units::kDegPerSqrtHour, t = kHours * units::kHour;
  setup.gyro.angle_random_walk = n;
  auto stations = DeadReckon(setup, t, 1, true);
  std::reverse(stations.begin(), stations.end());
  const auto cov =
      CovarianceAlongHole(stations, TimeAlongHole::kAgainstDepth, Eigen::Matrix3d::Zero(), 0);
  const double expected = kSpeed * kSpeed * n * n * std::pow(t / 2, 3) * 4 / 3;
  EXPECT_NEAR(cov[180](1, 1), expected, 1e-4 * expected);
}

// Noise s of the inclination that lasts for T: the depth's variance after t is
// (v s sin I)^2 2 (T t - T^2 (1 - e^(-t/T))), however many stations there are.
TEST(AlongHoleCovariance, NoiseOfTheInclinationDoesNotAverageOutOverCloseStations) {
  constexpr double kSigma = 1e-5, kLasts = 8, kSeconds = 1000;
  const double expected = std::pow(kSpeed * kSigma * std::sin(kInclination), 2) * 2 *
                          (kLasts * kSeconds - kLasts * kLasts);
  for (const double every : {0.5, 2.0, 4.0}) {
    for (const bool out : {false, true}) {
      std::vector<StationState> stations;
      for (int i = 0; i <= std::lround(kSeconds / every); ++i) {
        const double t = every * i;
        StationState& s = stations.emplace_back();
        s.epoch = static_cast<std::size_t>(i);
        s.attitude.time.ns = Duration::Seconds(t).ns;
        s.attitude.inclination = kInclination;
        s.along.md = kSpeed * (out ? kSeconds - t : t);
        s.cov.setZero(1, 1);
        if (i > 0) s.cov_with_previous.setZero(1, 1);
        s.angles.setZero(2, 1);
        s.cov_white(0, 0) = kSigma * kSigma;
        s.lean_seconds = kLasts;
      }
      if (out) std::reverse(stations.begin(), stations.end());
      const auto cov = CovarianceAlongHole(
          stations, out ? TimeAlongHole::kAgainstDepth : TimeAlongHole::kWithDepth,
          Eigen::Matrix3d::Zero(), 0);
      EXPECT_NEAR(cov.back()(2, 2), expected, 0.03 * expected) << every << (out ? " out" : " in");
    }
  }
}

TEST(AlongHoleCovariance, StationsLeftOutOnlyMakeTrapezoidsLonger) {
  FilterSetup setup = SetupAt(FromDegrees(60));
  for (const Process& p : Processes()) p.set(&setup);
  setup.gyro.bias_instability_correlation_time = 900;
  setup.errors.mass_unbalance_sigma = 0.1 * units::kDegPerHourPerG;
  const auto dense = DeadReckon(setup, 3600, 1);
  const auto sparse = DeadReckon(setup, 3600, 12);
  for (const bool out : {false, true}) {
    // In and out the same stations in the order of time serve: what is compared is the chain.
    std::vector<StationState> a = dense, b = sparse;
    if (out) {
      a = DeadReckon(setup, 3600, 1, true);
      b = DeadReckon(setup, 3600, 12, true);
      std::reverse(a.begin(), a.end());
      std::reverse(b.begin(), b.end());
    }
    const auto order = out ? TimeAlongHole::kAgainstDepth : TimeAlongHole::kWithDepth;
    const auto all = CovarianceAlongHole(b, order, Eigen::Matrix3d::Zero(), 0);
    AlongHoleCovariance along(Eigen::Matrix3d::Zero(), 0, order);
    std::vector<Eigen::Matrix3d> some;
    for (std::size_t i = 0; i < a.size(); ++i) {
      if (i % 12 == 0) {
        some.push_back(along.Add(a[i]));
      } else {
        along.Skip(a[i]);
      }
    }
    ASSERT_EQ(some.size(), all.size());
    for (std::size_t i = 1; i < all.size(); ++i) {
      EXPECT_NEAR(some[i](1, 1), all[i](1, 1), 1e-8 * all[i](1, 1)) << out << " " << i;
    }
  }
}

TEST(AlongHoleCovariance, TieInAndDepthAddWhatTheyAre) {
  FilterSetup setup = SetupAt(FromDegrees(60));
  setup.gyro.angle_random_walk = 0.1 * units::kDegPerSqrtHour;
  const auto stations = DeadReckon(setup, 600, 10);
  const Eigen::Matrix3d tie = Eigen::Vector3d(1, 4, 9).asDiagonal();
  const auto bare =
      CovarianceAlongHole(stations, TimeAlongHole::kWithDepth, Eigen::Matrix3d::Zero(), 0);
  const auto cov = CovarianceAlongHole(stations, TimeAlongHole::kWithDepth, tie, 0.5);
  const Eigen::Vector3d t(std::sin(kInclination), 0, std::cos(kInclination));
  for (std::size_t i = 0; i < cov.size(); ++i) {
    EXPECT_LT((cov[i] - bare[i] - tie - 0.25 * t * t.transpose()).norm(), 1e-8);
  }
}

TEST(AlongHoleCovariance, RefusesDepthsThatDoNotIncrease) {
  const auto stations = DeadReckon(SetupAt(0.5), 100, 1);
  AlongHoleCovariance along(Eigen::Matrix3d::Zero(), 0, TimeAlongHole::kWithDepth);
  along.Add(stations[3]);
  EXPECT_THROW(along.Add(stations[3]), std::invalid_argument);
  AlongHoleCovariance against(Eigen::Matrix3d::Zero(), 0, TimeAlongHole::kAgainstDepth);
  against.Add(stations[3]);
  EXPECT_THROW(against.Add(stations[4]), std::invalid_argument);
}

}  // namespace
}  // namespace wellgyro

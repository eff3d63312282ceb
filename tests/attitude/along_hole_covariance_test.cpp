#include "wellgyro/attitude/along_hole_covariance.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/base/units.h"

namespace wellgyro {
namespace {

constexpr double kSpeed = 0.5, kHours = 1, kInclination = 0.6, kStep = 10;

// Noise, constant, walk and ramp of the rate that turns the tangent across.
struct Drift {
  double n = 0, b = 0, k = 0, r = 0;
};

// A straight hole to the north: the tangent's error across is the integral a of the rate error w,
// x = (a, w, w'), carried in steps of ten seconds, exactly.
std::vector<StationState> DeadReckon(const Drift& d, double seconds, int every, bool out = false) {
  Eigen::Matrix3d F = Eigen::Matrix3d::Identity(), Q = Eigen::Matrix3d::Zero();
  F(0, 1) = F(1, 2) = kStep;
  F(0, 2) = kStep * kStep / 2;
  Q(0, 0) = d.n * d.n * kStep + d.k * d.k * kStep * kStep * kStep / 3;
  Q(0, 1) = Q(1, 0) = d.k * d.k * kStep * kStep / 2;
  Q(1, 1) = d.k * d.k * kStep;
  Eigen::Matrix3d cov = Eigen::Vector3d(0, d.b * d.b, d.r * d.r).asDiagonal(), link = cov;
  std::vector<StationState> stations;
  for (int i = 0; i * kStep <= seconds; ++i) {
    if (i > 0) {
      cov = F * cov * F.transpose() + Q;
      link = link * F.transpose();
    }
    if (i % every != 0) continue;
    StationState& s = stations.emplace_back();
    s.knot = static_cast<std::size_t>(i);
    s.attitude.inclination = kInclination;
    s.along.md = out ? 3000 - kSpeed * kStep * i : 1000 + kSpeed * kStep * i;
    s.cov = cov;
    if (i > 0) s.cov_with_previous = link;
    s.tangent_by_phi_L(1, 0) = 1;
    link = cov;
  }
  return stations;
}

// Of all stations, in the order of depth.
std::vector<Eigen::Matrix3d> CovarianceAlongHole(const std::vector<StationState>& stations,
                                                 TimeAlongHole order,
                                                 const Eigen::Matrix3d& cov_tie_in_W,
                                                 double depth_sigma) {
  AlongHoleCovariance along(cov_tie_in_W, depth_sigma, order);
  std::vector<Eigen::Matrix3d> covariances;
  for (const StationState& station : stations) covariances.push_back(along.Add(station));
  return covariances;
}

struct Process {
  const char* name;
  Drift drift;
  double position;  // variance across / speed^2
};

// Closed forms for one process alone over t: position v int int w. N: t^3/3; B: t^4/4; K: t^5/20;
// R: t^6/36.
std::vector<Process> Processes() {
  const double t = kHours * units::kHour;
  const double n = 0.25 * units::kDegPerSqrtHour, b = 0.5 * units::kDegPerHour;
  const double k = 0.5 * units::kDegPerHourSqrtHour, r = 0.3 * units::kDegPerHour2;
  return {{"N", {.n = n}, n * n * std::pow(t, 3) / 3},
          {"B", {.b = b}, b * b * std::pow(t, 4) / 4},
          {"K", {.k = k}, k * k * std::pow(t, 5) / 20},
          {"R", {.r = r}, r * r * std::pow(t, 6) / 36}};
}

TEST(AlongHoleCovariance, ClosedFormsOfDriftInAStraightHole) {
  for (const Process& p : Processes()) {
    const auto stations = DeadReckon(p.drift, kHours * units::kHour, 1);
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
    auto stations = DeadReckon(p.drift, kHours * units::kHour, 1, true);
    std::reverse(stations.begin(), stations.end());
    const auto cov =
        CovarianceAlongHole(stations, TimeAlongHole::kAgainstDepth, Eigen::Matrix3d::Zero(), 0);
    const double expected = kSpeed * kSpeed * p.position;
    EXPECT_NEAR(cov.back()(1, 1), expected, 1e-4 * expected) << p.name;
  }
  // Half way, for white noise: var int_{T/2}^T A dt = N^2 (T/2)^3 (1 + 1/3) [A(T/2) and the rest].
  const double n = 0.25 * units::kDegPerSqrtHour, t = kHours * units::kHour;
  auto stations = DeadReckon({.n = n}, t, 1, true);
  std::reverse(stations.begin(), stations.end());
  const auto cov =
      CovarianceAlongHole(stations, TimeAlongHole::kAgainstDepth, Eigen::Matrix3d::Zero(), 0);
  const double expected = kSpeed * kSpeed * n * n * std::pow(t / 2, 3) * 4 / 3;
  EXPECT_NEAR(cov[180](1, 1), expected, 1e-4 * expected);
}

TEST(AlongHoleCovariance, StationsLeftOutOnlyMakeTrapezoidsLonger) {
  Drift setup;
  for (const Process& p : Processes()) {
    setup.n += p.drift.n;
    setup.b += p.drift.b;
    setup.k += p.drift.k;
    setup.r += p.drift.r;
  }
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
  const auto stations = DeadReckon({.n = 0.1 * units::kDegPerSqrtHour}, 600, 10);
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
  const auto stations = DeadReckon({}, 100, 1);
  AlongHoleCovariance along(Eigen::Matrix3d::Zero(), 0, TimeAlongHole::kWithDepth);
  along.Add(stations[3]);
  EXPECT_THROW(along.Add(stations[3]), std::invalid_argument);
  AlongHoleCovariance against(Eigen::Matrix3d::Zero(), 0, TimeAlongHole::kAgainstDepth);
  against.Add(stations[3]);
  EXPECT_THROW(against.Add(stations[4]), std::invalid_argument);
}

}  // namespace
}  // namespace wellgyro

// Where a path stands within its knots, against an arc that is known in closed form.
#include "wellgyro/estimate/places.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"

namespace wellgyro {
namespace {

constexpr double kCurvature = 5 * units::kDeg / 30;  // [rad/m]
constexpr double kSpeed = 0.8;                       // [m/s]
constexpr int kRest = 20, kMoving = 30;              // knots of a second

struct Arc {
  Arc() {
    double md = 0, speed = 0;
    const auto node = [&] {
      Node n;
      const double inclination = 0.6 + kCurvature * md;
      n.R_LT.col(2) = Eigen::Vector3d(std::sin(inclination), 0, std::cos(inclination));
      n.md = md;
      n.speed = speed;
      return n;
    };
    nodes.push_back(node());
    for (int k = 0; k < 2 * kRest + kMoving; ++k) {
      RunKnot knot;
      knot.increment.seconds = 1;
      knot.still = k < kRest || k >= kRest + kMoving;
      // It is under way, and stopped, within a tenth of a second.
      speed = knot.still ? 0 : kSpeed;
      if (!knot.still) md += kSpeed;
      knot.along = {.md = md, .speed = speed, .known = true};
      knots.push_back(knot);
      nodes.push_back(node());
      if (k == kRest - 1) nodes.back().speed = kSpeed;
    }
  }
  std::vector<RunKnot> knots;
  std::vector<Node> nodes;
};

// A window over time alone takes the rest beside the way for a straight hole, and finds half of the
// acceleration in the first seconds: 1e-4 g at 0.8 m/s and 5 deg/30 m.
TEST(Places, AToolThatStartsAndStopsIsAcceleratedAsTheHoleBends) {
  const Arc arc;
  std::vector<KnotPlace> places;
  const Site site = SiteAt(0.8, 0);
  PlaceKnots(site, nullptr, arc.knots, arc.nodes, places);
  for (int k = kRest; k < kRest + kMoving - 1; ++k) {
    const auto at = static_cast<std::size_t>(k);
    const Eigen::Vector3d middle =
        0.5 * (arc.nodes[at].tangent_L() + arc.nodes[at + 1].tangent_L());
    const Eigen::Vector3d coriolis =
        2 * places[at].w_IL_L.cross(kSpeed * middle);  // transport is 1e-7 of it
    const Eigen::Vector3d a = places[at].acceleration_L - coriolis;
    const double want = kSpeed * kSpeed * kCurvature;
    EXPECT_NEAR(a.norm(), want, 0.01 * want) << k;
    EXPECT_NEAR(a.dot(middle), 0, 0.05 * want) << k;
  }
  for (const int k : {0, kRest - 2, kRest + kMoving + 1, 2 * kRest + kMoving - 1}) {
    EXPECT_LT(places[static_cast<std::size_t>(k)].acceleration_L.norm(), 1e-9) << k;
  }
}

/// Largest difference of the path's acceleration from v^2 I' across the hole, over the largest of
/// v^2 I', in a hole whose inclination waves once in so many knots. Coriolis is taken out.
double MissedOfAWave(double knots_a_wave) {
  constexpr double kWave = 2e-3, kFast = 2;  // [rad], [m/s]
  const double wave_number = kTwoPi / (knots_a_wave * kFast);
  std::vector<RunKnot> knots(120);
  std::vector<Node> nodes(knots.size() + 1);
  const auto inclination = [&](double md) { return 0.6 + kWave * std::sin(wave_number * md); };
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    nodes[k].md = kFast * static_cast<double>(k);
    nodes[k].speed = kFast;
    const double at = inclination(nodes[k].md);
    nodes[k].R_LT.col(2) = Eigen::Vector3d(std::sin(at), 0, std::cos(at));
    if (k < knots.size()) knots[k].increment.seconds = 1;
  }
  std::vector<KnotPlace> places;
  PlaceKnots(SiteAt(0.8, 0), nullptr, knots, nodes, places);
  const double most = kFast * kFast * kWave * wave_number;
  double missed = 0;
  for (std::size_t k = 3; k + 3 < knots.size(); ++k) {
    const double md = kFast * (static_cast<double>(k) + 0.5), at = inclination(md);
    const Eigen::Vector3d tangent(std::sin(at), 0, std::cos(at));
    const Eigen::Vector3d across(std::cos(at), 0, -std::sin(at));
    const Eigen::Vector3d a =
        places[k].acceleration_L - 2 * places[k].w_IL_L.cross(kFast * tangent);
    missed = std::max(missed, std::abs(a.dot(across) - most * std::cos(wave_number * md)) / most);
  }
  return missed;
}

// Of the curvature in the middle of a knot of w of the wave, its chord has sinc(w / 2) and twicing
// 1 - (1 - (1 + 2 cos w) / 3)^2 of that: 1 % are missed of a wave in 15 knots, 13 % in 6. A mean
// of three knots alone would miss 6 and 34 %.
TEST(Places, AHoleThatWavesAcceleratesAsItBends) {
  for (const double knots : {15.3, 10.3, 6.3}) {
    const double w = kTwoPi / knots, mean = (1 + 2 * std::cos(w)) / 3;
    const double seen = std::sin(w / 2) / (w / 2) * (1 - (1 - mean) * (1 - mean));
    EXPECT_NEAR(MissedOfAWave(knots), 1 - seen, 0.005) << knots;
  }
}

// Along the arc t = (sin I, 0, cos I) the Earth's rate about the axis is W (cos(lat) sin I -
// sin(lat) cos I) = -W sin(lat - I): what a tool that only slides seems to roll by. The latitude
// goes with the way, by 1e-4 of what the inclination does.
TEST(Places, ASlidingToolIsTurnedByTheEarthAsTheHoleBends) {
  const Arc arc;
  std::vector<KnotPlace> places;
  PlaceKnots(SiteAt(0.8, 0), nullptr, arc.knots, arc.nodes, places);
  double most = 0;
  for (std::size_t k = 0; k + 1 < places.size(); ++k) {
    const auto middle = [&](std::size_t at) {
      return 0.6 + kCurvature * 0.5 * (arc.nodes[at].md + arc.nodes[at + 1].md);
    };
    const double want = kEarthRate * (std::sin(0.8 - middle(k)) - std::sin(0.8 - middle(k + 1)));
    EXPECT_NEAR(places[k].axial_change, want, 2e-10) << k;
    most = std::max(most, std::abs(want));
  }
  EXPECT_GT(most, 1e-7);
  EXPECT_EQ(places.back().axial_change, 0);
}

/// The roll walk in the middle of 200 m through a hole that builds and turns by these rates
/// [rad/m].
double RollWalkOf(double inclination, double build, double turn) {
  std::vector<RunKnot> knots(250);
  std::vector<Node> nodes(knots.size() + 1);
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    nodes[k].md = kSpeed * static_cast<double>(k);
    nodes[k].speed = kSpeed;
    const double tilt = inclination + build * (nodes[k].md - 100);
    const double azimuth = 0.3 + turn * nodes[k].md;
    nodes[k].R_LT.col(2) = Eigen::Vector3d(std::sin(tilt) * std::cos(azimuth),
                                           std::sin(tilt) * std::sin(azimuth), std::cos(tilt));
    if (k < knots.size()) knots[k].increment.seconds = 1;
  }
  std::vector<KnotPlace> places;
  PlaceKnots(SiteAt(0.8, 0), nullptr, knots, nodes, places);
  return places[knots.size() / 2].roll_walk;
}

// A tool that keeps its toolface rolls by A' cos I: not in a hole that only builds, to vertical and
// past it, and as much as the hole turns otherwise, by a stand's way.
TEST(Places, TheRollWalksAsTheHoleTurns) {
  EXPECT_LT(RollWalkOf(0.6, kCurvature, 0), 1e-9);
  EXPECT_LT(RollWalkOf(0, kCurvature, 0), 1e-9);
  for (const double inclination : {0.02, 0.6, 1.4}) {
    const double turn = 0.004, rate = turn * kSpeed * std::pow(std::sin(inclination), 2);
    const double want = rate * std::cos(inclination) * std::sqrt(kSpeed / 30);
    EXPECT_NEAR(RollWalkOf(inclination, 0, turn), want, 0.01 * want) << inclination;
  }
}

// Of a swing of 15 s, in knots of a second, against its integral; and of psi, which follows a part
// of it.
TEST(Places, AHiddenRollBowsAsItSwings) {
  constexpr double kFrequency = kTwoPi / 15, kAmplitude = 0.5;
  const auto roll = [](double t) { return kAmplitude * std::sin(kFrequency * t); };
  std::vector<RunKnot> knots(30);
  std::vector<double> rates;
  for (std::size_t k = 0; k < knots.size(); ++k) {
    const double begin = static_cast<double>(k);
    Increment& inc = knots[k].increment;
    inc.seconds = 1;
    inc.roll_seen = k % 7 == 3;
    knots[k].still = k % 7 == 5;
    rates.push_back(roll(begin + 1) - roll(begin));
    const double part = (k % 2 == 0 ? 0.0 : 0.3);
    inc.roll_before = part * (roll(begin + 0.5) - roll(begin));
    inc.roll_after = part * (roll(begin + 1) - roll(begin + 0.5));
  }
  std::vector<KnotPlace> places(knots.size());
  BowKnots(knots, rates, places);
  for (std::size_t k = 1; k + 1 < knots.size(); ++k) {
    if (knots[k].increment.roll_seen || knots[k].still) {
      EXPECT_EQ(places[k].roll_bow, 0) << k;
      continue;
    }
    constexpr int kParts = 1000;
    double bow = 0;
    for (int i = 0; i < kParts; ++i) {
      const double part = (i + 0.5) / kParts, begin = static_cast<double>(k);
      bow += (roll(begin + part) - roll(begin) - part * rates[k]) / kParts;
    }
    bow *= 1 - (k % 2 == 0 ? 0.0 : 0.3);
    // A tenth of the greatest there is.
    EXPECT_NEAR(places[k].roll_bow, bow, 0.1 * kAmplitude * kFrequency * kFrequency / 12) << k;
  }
}

}  // namespace
}  // namespace wellgyro

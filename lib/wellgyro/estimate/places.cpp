#include "wellgyro/estimate/places.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/Geometry>

#include "wellgyro/base/angle.h"
#include "wellgyro/earth/earth_rate.h"
#include "wellgyro/estimate/hidden_roll.h"
#include "wellgyro/record/limits.h"

namespace wellgyro {
namespace {

using Eigen::Vector3d;

// [m] of a way, from which it tells of the hole. Less is below 3 mm/s: the path's acceleration
// v^2 kappa, 6e-8 m/s^2 at 10 deg/30 m, is then none.
constexpr double kTellingWay = 0.01;
// [m] of depth marks, and not of the path: where it is renewed must not move with the solution. On
// such a way gravity changes by 2e-6 m/s^2, the latitude by 3e-7 rad. Where depth is missing it is
// renewed at every knot: 230 m further down gravity kept would be 0.03 m/s of speed in 270 s.
constexpr double kSiteEvery = 2;
// [m] over which the hole's curvature becomes another one: from stand to stand, to which doglegs
// are quoted. At 15 m the demonstration is solved without its swing (errors of azimuth 1.4 %
// larger), at 60 m ends move by 0.003 sigma.
constexpr double kCurvatureLength = 30;
// [rad], 6 km from the pole: v tan L / R is up to 1.6e-4 rad/s at 1 m/s, twice the Earth's rate.
constexpr double kPoleMargin = 1e-3;

/// sum(turns) / sum(ways) over each knot and its neighbours; zero where nothing moves.
std::vector<Vector3d> MeansOfThree(std::span<const Vector3d> turns, std::span<const double> ways) {
  std::vector<Vector3d> means(turns.size(), Vector3d::Zero());
  for (std::size_t k = 0; k < turns.size(); ++k) {
    Vector3d turn = Vector3d::Zero();
    double way = 0;
    for (std::size_t i = k > 0 ? k - 1 : 0; i < std::min(k + 2, turns.size()); ++i) {
      turn += turns[i];
      way += ways[i];
    }
    if (std::abs(way) > kTellingWay) means[k] = turn / way;
  }
  return means;
}

/// d(tangent)/d(md) of the hole about each knot, smoothed by twicing (Tukey, Exploratory Data
/// Analysis, 1977): S + S (1 - S) with S a mean of three, over steady ways (-1, 4, 3, 4, -1) / 9,
/// which is exact for cubics. By the way and not by time: a tool that starts or stops went less.
std::vector<Vector3d> Curvature(std::span<const RunKnot> knots, std::span<const Node> nodes) {
  std::vector<Vector3d> turns(knots.size(), Vector3d::Zero());
  std::vector<double> ways(knots.size(), 0);
  for (std::size_t k = 0; k < knots.size(); ++k) {
    if (knots[k].still) continue;
    turns[k] = nodes[k + 1].tangent_L() - nodes[k].tangent_L();
    ways[k] = 0.5 * knots[k].increment.seconds * (nodes[k].speed + nodes[k + 1].speed);
  }
  std::vector<Vector3d> curvature = MeansOfThree(turns, ways);
  for (std::size_t k = 0; k < knots.size(); ++k) turns[k] -= ways[k] * curvature[k];
  const std::vector<Vector3d> rest = MeansOfThree(turns, ways);
  for (std::size_t k = 0; k < knots.size(); ++k) curvature[k] += rest[k];
  return curvature;
}

/// How much the hole turns about each knot: root mean square over a stand on either side of
///   t' . (down x t) = A' sin^2 I  [rad/m],
/// regular at vertical.
std::vector<double> Turns(std::span<const RunKnot> knots, std::span<const Node> nodes,
                          std::span<const Vector3d> curvature) {
  std::vector<double> ways(knots.size() + 1, 0), squares(knots.size() + 1, 0);
  for (std::size_t k = 0; k < knots.size(); ++k) {
    const double way =
        0.5 * knots[k].increment.seconds * std::abs(nodes[k].speed + nodes[k + 1].speed);
    const double turn = curvature[k].dot(Vector3d::UnitZ().cross(nodes[k].tangent_L()));
    ways[k + 1] = ways[k] + way;
    squares[k + 1] = squares[k] + way * turn * turn;
  }
  std::vector<double> turns(knots.size(), 0);
  std::size_t begin = 0, end = 0;
  for (std::size_t k = 0; k < knots.size(); ++k) {
    while (ways[begin + 1] < ways[k] - kCurvatureLength) ++begin;
    end = std::max(end, k + 1);
    while (end < knots.size() && ways[end] < ways[k] + kCurvatureLength) ++end;
    const double way = ways[end] - ways[begin];
    if (way > kTellingWay) turns[k] = std::sqrt((squares[end] - squares[begin]) / way);
  }
  return turns;
}

/// Random walk of the inertial roll rate of a tool that keeps its toolface, T' = 0:
///   psi' = A' cos I.
/// It changes by as much within a stand: that variance over a stand's way. Gravity keeps the
/// toolface, by a moment that goes as sin^2 I, and `turn` is A' sin^2 I. Without this term a roll
/// assumed steady would be a pseudo-measurement of A', and a wrong one.
double RollWalkOf(const Vector3d& tangent, double turn, double speed) {
  return std::abs(speed) * turn * std::sqrt(std::abs(speed) / kCurvatureLength) *
         std::abs(tangent.z());
}

}  // namespace

Site SiteBy(const Site& first, const Vector3d& p_W) {
  // Damaged depths may lead anywhere, the site stays on the Earth.
  const double north = std::clamp(p_W.x(), -limits::kMd, limits::kMd);
  const double down = std::clamp(p_W.z(), -limits::kMd, limits::kMd);
  const double most = kPi / 2 - kPoleMargin;
  return SiteAt(std::clamp(first.latitude + north / first.radius_north, -most, most),
                first.height - down);
}

void PlaceKnots(const Site& first, const RunState* before, std::span<const RunKnot> knots,
                std::span<const Node> nodes, std::vector<KnotPlace>& places) {
  places.resize(knots.size());
  const std::vector<Vector3d> curvature = Curvature(knots, nodes);
  const std::vector<double> hole_turns = Turns(knots, nodes, curvature);
  Vector3d p_W = before != nullptr ? before->p_W : Vector3d::Zero();
  Site site = SiteBy(first, p_W);
  double md = nodes[0].md;
  double time = before != nullptr ? before->seconds : 0, axial = 0;
  for (std::size_t k = 0; k < knots.size(); ++k) {
    const Node& a = nodes[k];
    const Node& b = nodes[k + 1];
    const Vector3d tangent = 0.5 * (a.tangent_L() + b.tangent_L());
    const double speed = 0.5 * (a.speed + b.speed);
    const AlongHole& along = knots[k].along;
    if (k == 0 || !along.known || std::abs(along.md - md) > kSiteEvery) {
      site = SiteBy(first, p_W);
      if (along.known) md = along.md;
    }
    KnotPlace& place = places[k];
    place.site = site;
    const double c = std::cos(site.latitude), s = std::sin(site.latitude);
    const Vector3d earth = EarthRateAt(site.latitude);
    const Vector3d v = speed * tangent;
    const Vector3d transport(v.y() / site.radius_east, -v.x() / site.radius_north,
                             -v.y() * s / (c * site.radius_east));
    place.w_IL_L = earth + transport;
    place.dw_by_latitude_L = kEarthRate * Vector3d(-s, 0, -c);
    place.axial_change = 0;
    if (k > 0) places[k - 1].axial_change = earth.dot(tangent) - axial;
    axial = earth.dot(tangent);
    place.acceleration_L = speed * speed * curvature[k] + (2 * earth + transport).cross(v);
    place.roll_walk = RollWalkOf(tangent, hole_turns[k], speed);
    const double dt = knots[k].increment.seconds;
    place.since_start = time + 0.5 * dt;
    place.depth = p_W.z();
    time += dt;
    p_W += (b.md - a.md) * tangent;
  }
}

void BowKnots(std::span<const RunKnot> knots, std::span<const double> roll_rates,
              std::vector<KnotPlace>& places) {
  for (std::size_t k = 0; k < knots.size(); ++k) {
    const Increment& inc = knots[k].increment;
    places[k].roll_bow = 0;
    if (k == 0 || k + 1 == knots.size() || !RollIsHidden(knots[k])) continue;
    const double dt = inc.seconds;
    const double apart = 0.5 * (knots[k - 1].increment.seconds + knots[k + 1].increment.seconds);
    const double change = (roll_rates[k + 1] - roll_rates[k - 1]) / (apart + dt);
    const double of_psi = (inc.roll_before - inc.roll_after) / 3;
    places[k].roll_bow = -change * dt * dt / 12 - of_psi;
  }
}

}  // namespace wellgyro

#include "wellgyro/trajectory/leg_arc.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/trajectory/leg_tree.h"
#include "wellgyro/trajectory/minimum_curvature.h"

namespace wellgyro {
namespace {

using Eigen::Vector3d;

struct Draw {
  std::mt19937_64 engine{20261122};
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform{0, 1};

  Vector3d Vector() {
    const double x = normal(engine), y = normal(engine), z = normal(engine);
    return {x, y, z};
  }
  Vector3d Unit() { return Vector().normalized(); }
  /// Lengths of 1 to 1000 m, straight, gentle, and up to nearly half a circle.
  LegArc Arc() {
    const Vector3d begin = 100 * uniform(engine) * Vector(), t1 = Unit();
    Vector3d t2 = Unit();
    const double style = uniform(engine);
    if (style < 0.3) t2 = (t1 + 0.05 * uniform(engine) * t2).normalized();
    if (style > 0.9 || (t1 + t2).norm() < 1e-3) t2 = t1;
    return MakeLegArc(begin, std::pow(10, 3 * uniform(engine)), t1, t2);
  }
};

/// The arc by turning its tangent about the axis of the circle, with nothing of the code under
/// test. Where the centre is so far away that its place is not known well enough, the tangent is
/// summed at Gauss' three points, exact to (turn)^6 / 2e6 of the length.
struct Turned {
  explicit Turned(const LegArc& arc) : arc_(arc) {
    axis_ = arc.tangent_W.cross(arc.normal_W).normalized();
  }
  Vector3d operator()(double s) const {
    const auto tangent = [&](double at) -> Vector3d {
      return Eigen::AngleAxisd(arc_.curvature * at, axis_) * arc_.tangent_W;
    };
    if (arc_.curvature * arc_.length < 0.01) {
      const double off = std::sqrt(0.15) * s;
      return arc_.begin_W +
             s / 18 * (5 * tangent(s / 2 - off) + 8 * tangent(s / 2) + 5 * tangent(s / 2 + off));
    }
    const Vector3d centre = arc_.begin_W + arc_.normal_W / arc_.curvature;
    return centre + Eigen::AngleAxisd(arc_.curvature * s, axis_) * (arc_.begin_W - centre);
  }

 private:
  const LegArc& arc_;
  Vector3d axis_;
};

/// Golden section between two bounds.
template <class F>
double Least(const F& f, double low, double high) {
  constexpr double kGolden = 0.6180339887498949;
  for (int i = 0; i < 60; ++i) {
    const double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
    (f(a) < f(b) ? high : low) = f(a) < f(b) ? b : a;
  }
  return f((low + high) / 2);
}

/// The smallest of `f` on [0, length], from samples and the brackets around their minima.
template <class F>
double Sampled(const F& f, double length, int samples) {
  std::vector<double> value(static_cast<std::size_t>(samples) + 1);
  const double step = length / samples;
  for (int k = 0; k <= samples; ++k) value[static_cast<std::size_t>(k)] = f(k * step);
  double least = std::ranges::min(value);
  const double worth = 1.2 * least + 3 * step;
  for (int k = 0; k <= samples; ++k) {
    const auto at = static_cast<std::size_t>(k);
    const bool falls = k == 0 || value[at] <= value[at - 1];
    const bool rises = k == samples || value[at] <= value[at + 1];
    if (!falls || !rises || value[at] > worth) continue;
    least = std::min(least, Least(f, std::max(0, k - 1) * step, std::min(samples, k + 1) * step));
  }
  return least;
}

// tests/run --long draws 1e5 pairs.
TEST(LegArc, NoMinimumIsMissed) {
  Draw draw;
  double worst_above = 0, worst_below = 0;
  for (int i = 0; i < WELLGYRO_ARC_PAIRS; ++i) {
    const LegArc a = draw.Arc(), b = draw.Arc();
    const NearestPair found = NearestBetween(a, b);
    const Turned on_a(a), on_b(b);
    const double gap = (on_a(found.s_first) - on_b(found.s_second)).norm();
    ASSERT_NEAR(gap, found.distance, 1e-7) << i;
    const double brute = Sampled(
        [&](double s) {
          const Vector3d here = on_a(s);
          return Sampled([&](double u) { return (on_b(u) - here).norm(); }, b.length, 16);
        },
        a.length, 16);
    worst_above = std::max(worst_above, found.distance - brute);
    worst_below = std::max(worst_below, brute - found.distance);
    ASSERT_LE(found.distance, brute + 1e-6) << "pair " << i;
  }
  RecordProperty("pairs", WELLGYRO_ARC_PAIRS);
  std::printf("%d pairs: at most %.2g m above brute force, %.2g m below\n", WELLGYRO_ARC_PAIRS,
              worst_above, worst_below);
}

TEST(LegArc, IsTheArcOfMinimumCurvature) {
  Draw draw;
  for (int i = 0; i < 200; ++i) {
    const Vector3d t1 = draw.Unit(), t2 = draw.Unit();
    const LegArc arc = MakeLegArc(Vector3d::Zero(), 30, t1, t2);
    const auto leg = MinimumCurvatureLeg(30, t1, t2);
    if (!leg || leg->dogleg > 3) continue;
    EXPECT_LT((PointOn(arc, 30) - leg->displacement).norm(), 1e-12);
    EXPECT_LT((DirectionOn(arc, 30) - t2).norm(), 1e-12);
  }
}

// Circles that lie beside each other at one distance all along, and ones that meet.
TEST(LegArc, DegeneratePairs) {
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  const LegArc inner = MakeLegArc({0, -10, 0}, 10 * kPi / 2, x, y);
  const LegArc outer = MakeLegArc({0, -12, 0}, 12 * kPi / 2, x, y);
  EXPECT_NEAR(NearestBetween(inner, outer).distance, 2, 1e-7);
  const LegArc above = MakeLegArc({0, -10, 3}, 10 * kPi / 2, x, y);
  EXPECT_NEAR(NearestBetween(inner, above).distance, 3, 1e-7);
  EXPECT_LT(NearestBetween(inner, inner).distance, 1e-7);
  const LegArc axis = MakeLegArc({0, 0, -5}, 10, z, z);
  EXPECT_NEAR(NearestBetween(inner, axis).distance, 10, 1e-7);
  const LegArc one = MakeLegArc({0, 0, 0}, 10, x, x), two = MakeLegArc({15, 2, 0}, 10, x, x);
  EXPECT_NEAR(NearestBetween(one, two).distance, std::hypot(5, 2), 1e-12);
  const LegArc back = MakeLegArc({8, 2, 0}, 10, -x, -x);
  EXPECT_NEAR(NearestBetween(one, back).distance, 2, 1e-12);
}

// From the issue: a true approach of 1 m between stations 30 m apart, on a bend.
TEST(LegArc, ApproachBetweenStations) {
  const Vector3d down(0, 0, 1), north(1, 0, 0);
  const LegArc bend = MakeLegArc({0, 0, 0}, 100 * kPi / 2, down, north);
  const Vector3d middle = PointOn(bend, bend.length / 2);
  const Vector3d out = Vector3d(-1, 0, 1).normalized();  // away from the circle's centre
  const Vector3d east = Vector3d::UnitY();
  const LegArc across = MakeLegArc(middle + out - 15 * east, 30, east, east);
  const NearestPair pair = NearestBetween(bend, across);
  EXPECT_NEAR(pair.distance, 1, 1e-9);
  EXPECT_NEAR(pair.s_first, bend.length / 2, 1e-4);
  EXPECT_NEAR(pair.s_second, 15, 1e-4);
}

TEST(LegArc, CrossingsOfAPlane) {
  Draw draw;
  int crossed = 0;
  for (int i = 0; i < 500; ++i) {
    const LegArc arc = draw.Arc();
    const Vector3d across = draw.Unit();
    const Vector3d point = PointOn(arc, arc.length * draw.uniform(draw.engine));
    const PlaneCrossings at = CrossingsOfPlane(arc, point, across);
    ASSERT_GE(at.count, 1) << i;
    for (int c = 0; c < at.count; ++c) {
      EXPECT_NEAR((PointOn(arc, at.s[c]) - point).dot(across), 0, 1e-8 * (1 + arc.length));
      ++crossed;
    }
  }
  EXPECT_GT(crossed, 550);
}

TEST(LegTree, FindsWhatEveryLegSearchedFinds) {
  Draw draw;
  std::vector<LegArc> legs;
  Vector3d at(0, 0, 0), t = Vector3d::UnitZ();
  for (int i = 0; i < 77; ++i) {
    const Vector3d next = (t + 0.2 * draw.Unit()).normalized();
    legs.push_back(MakeLegArc(at, 30, t, next));
    at = PointOn(legs.back(), 30);
    t = next;
  }
  const LegTree tree(legs);
  for (int i = 0; i < 300; ++i) {
    const LegArc other = draw.Arc();
    double nearest = 1e300, pair = 1e300;
    for (const LegArc& leg : legs) {
      nearest =
          std::min(nearest, (PointOn(leg, NearestOn(leg, other.begin_W)) - other.begin_W).norm());
      pair = std::min(pair, NearestBetween(other, leg).distance);
    }
    EXPECT_NEAR(tree.Nearest(other.begin_W).distance, nearest, 1e-9);
    const LegTree::Pair found = tree.Nearest(other);
    EXPECT_NEAR(found.place.distance, pair, 2e-7);
  }
}

}  // namespace
}  // namespace wellgyro

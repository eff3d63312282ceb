#include "wellgyro/trajectory/trajectory.h"

#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gmock/gmock.h>

#include "wellgyro/base/units.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/trajectory/leg_geometry.h"

namespace wellgyro {
namespace {

using testing::HasSubstr;

// Down, out, over the top and back down: TVD goes up and down several times.
Trajectory Porpoise(int stations) {
  std::vector<double> md, inclination, azimuth;
  for (int i = 0; i < stations; ++i) {
    const double s = 10.0 * i;
    md.push_back(s);
    inclination.push_back(kPi / 2 + 0.6 * std::sin(s / 130));
    azimuth.push_back(s / 400);
  }
  return Trajectory(md, inclination, azimuth, {5, 6, 1000});
}

// The arc between two stations, integrated in long double with the tangent turned evenly.
Eigen::Vector3d Integrated(const TrajectoryPoint& a, const TrajectoryPoint& b, double fraction) {
  using V = Eigen::Matrix<long double, 3, 1>;
  const V t1 = a.tangent_W.cast<long double>(), t2 = b.tangent_W.cast<long double>();
  const V axis = t1.cross(t2);
  const long double dogleg = std::atan2(axis.norm(), t1.dot(t2));
  const V normal = dogleg > 0 ? V((axis / axis.norm()).cross(t1)) : V::Zero();
  V sum = V::Zero();
  const int n = 2000;
  for (int k = 0; k < n; ++k) {
    // Gauss at the middle, whose error is (dogleg / n)^2 / 24.
    const long double angle = dogleg * fraction * (k + 0.5L) / n;
    sum += std::cos(angle) * t1 + std::sin(angle) * normal;
  }
  const long double length = (b.md - a.md) * fraction;
  return a.position_W + (sum * length / n).cast<double>();
}

TEST(Trajectory, ByMeasuredDepthIsOnTheArcs) {
  const Trajectory well = Porpoise(50);
  for (std::size_t i = 0; i + 1 < well.size(); ++i) {
    for (const double u : {0.13, 0.5, 0.99}) {
      const TrajectoryPoint p = well.AtMd(well.station(i).md + 10 * u);
      EXPECT_LT((p.position_W - Integrated(well.station(i), well.station(i + 1), u)).norm(), 1e-7);
      EXPECT_LT((p.tangent_W - Tangent(p.inclination, p.azimuth)).norm(), 1e-14);
      EXPECT_EQ(p.dogleg_severity, well.station(i + 1).dogleg_severity);
    }
    EXPECT_EQ(well.AtMd(well.station(i).md).position_W, well.station(i).position_W);
    EXPECT_EQ(well.AtMd(well.station(i).md).azimuth, well.station(i).azimuth);
  }
  EXPECT_THROW(well.AtMd(-1e-9), std::domain_error);
  EXPECT_THROW(well.AtMd(490.0001), std::domain_error);
  EXPECT_THROW(well.AtMd(std::numeric_limits<double>::quiet_NaN()), std::domain_error);
}

// Sign changes of TVD over a fine scan: what a search without any index would find.
std::vector<double> Scanned(const Trajectory& well, double tvd, double step) {
  std::vector<double> found;
  double before = well.station(0).position_W.z() - tvd;
  for (double md = well.md_begin() + step; md <= well.md_end(); md += step) {
    const double now = well.AtMd(md).position_W.z() - tvd;
    if ((before < 0) != (now < 0)) found.push_back(md - step * now / (now - before));
    before = now;
  }
  return found;
}

TEST(Trajectory, ByTvdFindsEveryCrossing) {
  const Trajectory well = Porpoise(400);
  std::size_t most = 0;
  for (double tvd = 920; tvd < 1080; tvd += 3.7) {
    const std::vector<double> found = well.MdAtTvd(tvd);
    const std::vector<double> truth = Scanned(well, tvd, 0.5);
    ASSERT_EQ(found.size(), truth.size()) << tvd;
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_NEAR(found[i], truth[i], 0.01) << tvd;
      EXPECT_NEAR(well.AtMd(found[i]).position_W.z(), tvd, 1e-9);
    }
    most = std::max(most, found.size());
  }
  EXPECT_GE(most, 8u);
}

TEST(Trajectory, AStationsOwnTvdIsFoundOnce) {
  const Trajectory well = Porpoise(100);
  for (std::size_t i = 0; i < well.size(); ++i) {
    int here = 0;
    for (const double md : well.MdAtTvd(well.station(i).position_W.z())) {
      here += std::abs(md - well.station(i).md) < 1e-4 ? 1 : 0;
    }
    EXPECT_EQ(here, 1) << i;
  }
}

TEST(Trajectory, TouchingLevelAndVerticalLegs) {
  // One arc through the horizontal: highest TVD where it is level, at its middle by symmetry.
  const std::vector<double> md{0, 100}, inclination{kPi / 2 - 0.3, kPi / 2 + 0.3}, azimuth{1, 1};
  const Trajectory arc(md, inclination, azimuth, {0, 0, 0});
  const double top = 100 / 0.6 * (1 - std::cos(0.3));
  EXPECT_EQ(arc.MdAtTvd(top - 1e-6).size(), 2u);
  EXPECT_TRUE(arc.MdAtTvd(top + 1e-8).empty());
  const auto touched = arc.MdAtTvd(arc.AtMd(50).position_W.z());
  ASSERT_FALSE(touched.empty());
  for (const double depth : touched) EXPECT_NEAR(depth, 50, 1e-4);

  const std::vector<double> flat_md{0, 50, 100, 150, 200};
  const std::vector<double> flat{0, kPi / 2, kPi / 2, kPi / 2, kPi / 4};
  const std::vector<double> north(5, 0.0);
  const Trajectory level(flat_md, flat, north, {0, 0, 0});
  const double z = level.station(1).position_W.z();
  const std::vector<double> in_level = level.MdAtTvd(z);
  EXPECT_THAT(in_level,
              testing::ElementsAre(testing::DoubleNear(50, 1e-4), testing::DoubleNear(150, 1e-4)));

  const std::vector<double> straight{0, 0, 0, 0, 0};
  const Trajectory vertical(flat_md, straight, north, {0, 0, 7});
  EXPECT_THAT(vertical.MdAtTvd(7), testing::ElementsAre(0.0));
  EXPECT_THAT(vertical.MdAtTvd(100), testing::ElementsAre(testing::DoubleNear(93, 1e-12)));
  EXPECT_THAT(vertical.MdAtTvd(207), testing::ElementsAre(testing::DoubleNear(200, 1e-12)));
  EXPECT_TRUE(vertical.MdAtTvd(6.999).empty());
}

TEST(Trajectory, OneStationIsAPoint) {
  const std::vector<double> md{10}, inclination{0.1}, azimuth{0.2};
  const Trajectory point(md, inclination, azimuth, {1, 2, 3});
  EXPECT_EQ(point.AtMd(10).position_W, Eigen::Vector3d(1, 2, 3));
  EXPECT_THAT(point.MdAtTvd(3), testing::ElementsAre(10.0));
  EXPECT_TRUE(point.MdAtTvd(4).empty());
  EXPECT_EQ(point.Resampled(4).size(), 1u);
}

TEST(Trajectory, RefusesWhatIsNoSurvey) {
  const std::vector<double> md{0, 10, 5}, angle{0, 0, 0};
  try {
    Trajectory(md, angle, angle, {0, 0, 0});
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr("station 2"));
  }
  EXPECT_THROW(Trajectory({}, {}, {}, {0, 0, 0}), std::invalid_argument);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> one{0};
  EXPECT_THROW(Trajectory(one, one, one, {nan, 0, 0}), std::invalid_argument);
}

TEST(Trajectory, ResampledAtWholeMultiples) {
  const std::vector<double> md{12, 31, 60}, inclination{0, 0.2, 0.5}, azimuth{0, 1, 1.2};
  const Trajectory well(md, inclination, azimuth, {0, 0, 12});
  std::vector<double> depths;
  for (const TrajectoryPoint& p : well.Resampled(10)) depths.push_back(p.md);
  EXPECT_THAT(depths, testing::ElementsAre(12, 20, 30, 40, 50, 60));
  depths.clear();
  for (const TrajectoryPoint& p : well.Resampled(20, true)) depths.push_back(p.md);
  EXPECT_THAT(depths, testing::ElementsAre(12, 20, 31, 40, 60));
  EXPECT_THROW(well.Resampled(0), std::invalid_argument);
  // Summing the resampled stations with the corners kept is the same curve.
  std::vector<double> m, i, a;
  for (const TrajectoryPoint& p : well.Resampled(0.7, true)) {
    m.push_back(p.md), i.push_back(p.inclination), a.push_back(p.azimuth);
  }
  const Trajectory again(m, i, a, {0, 0, 12});
  EXPECT_LT((again.AtMd(60).position_W - well.AtMd(60).position_W).norm(), 1e-12);
}

TEST(Trajectory, AheadGoesOnStraightOrCurved) {
  const std::vector<double> md{0, 100}, inclination{0, 0}, azimuth{0.3, 0.3};
  const Trajectory down(md, inclination, azimuth, {0, 0, 0});
  EXPECT_LT((down.Ahead(25).position_W - Eigen::Vector3d(0, 0, 125)).norm(), 1e-12);
  // A quarter circle towards azimuth 0.3 + 1.1 from the vertical.
  const double radius = 200;
  const TrajectoryPoint quarter = down.Ahead(radius * kPi / 2, 1 / radius, 1.1);
  EXPECT_NEAR(quarter.inclination, kPi / 2, 1e-12);
  EXPECT_NEAR(quarter.azimuth, 1.4, 1e-12);
  EXPECT_LT((quarter.position_W -
             Eigen::Vector3d(radius * std::cos(1.4), radius * std::sin(1.4), 100 + radius))
                .norm(),
            1e-9);
  EXPECT_THROW(down.Ahead(-1), std::invalid_argument);
  EXPECT_THROW(down.Ahead(1000, 0.01), std::invalid_argument);
}

TEST(Trajectory, SideTracksLeaveTheParent) {
  const Trajectory parent = Porpoise(20);
  const std::vector<PathStation> below{{140, 1.2, 0.1}, {170, 1.1, 0.2}};
  const Trajectory side = Trajectory::TiedOnto(parent, 123, below);
  EXPECT_EQ(side.size(), 3u);
  EXPECT_EQ(side.station(0).position_W, parent.AtMd(123).position_W);
  EXPECT_THROW(Trajectory::TiedOnto(parent, 500, below), std::domain_error);
  EXPECT_THROW(Trajectory::TiedOnto(parent, 150, below), std::invalid_argument);
}

TEST(Trajectory, OfAPathRefersToTheHeadsMeridian) {
  const Site head = SiteAt(FromDegrees(60), 0);
  Path path(head, {0, kPi / 2, kPi / 2}, {0, 0, 1000});
  std::vector<PathPoint> points{path.last()};
  for (int i = 1; i <= 100; ++i) points.push_back(*path.Add({50.0 * i, kPi / 2, kPi / 2}));
  const Trajectory well = Trajectory::OfPath(points);
  EXPECT_EQ(well.AtMd(5000).position_W, points.back().p_WT_W);
  // Due east by its own meridian, 5 km east at 60 deg north: the design's 0.08 deg.
  EXPECT_NEAR(ToDegrees(well.AtMd(5000).azimuth), 90 - 0.08, 0.005);
}

TEST(LegGeometry, DoglegBuildTurnAndToolface) {
  // Straight up the high side.
  const LegGeometry build = GeometryOfLeg(30, 0.5, 1.0, 0.6, 1.0);
  EXPECT_NEAR(build.dogleg_severity, 0.1 / 30, 1e-15);
  EXPECT_NEAR(build.build, 0.1 / 30, 1e-15);
  EXPECT_EQ(build.turn, 0);
  EXPECT_NEAR(build.toolface, 0, 1e-12);
  EXPECT_NEAR(std::abs(GeometryOfLeg(30, 0.6, 1.0, 0.5, 1.0).toolface), kPi, 1e-12);
  // In the horizontal to the right.
  EXPECT_NEAR(GeometryOfLeg(30, kPi / 2, 1.0, kPi / 2, 1.1).toolface, kPi / 2, 1e-12);
  // Across north, the short way.
  EXPECT_NEAR(GeometryOfLeg(10, 1, 6.2, 1, 0.1).turn, (0.1 - 6.2 + kTwoPi) / 10, 1e-15);
  // Out of the vertical: azimuth + toolface is the direction.
  EXPECT_NEAR(GeometryOfLeg(10, 0, 1.0, 0.2, 2.5).toolface, 1.5, 1e-12);
  // Trade units: 3 deg over 30 m is 3 deg/30 m and 3.048 deg/100 ft.
  const double severity = GeometryOfLeg(30, 0, 0, FromDegrees(3), 0).dogleg_severity;
  EXPECT_NEAR(severity / units::kDegPer30m, 3, 1e-12);
  EXPECT_NEAR(severity / units::kDegPer100ft, 3.048, 1e-12);
  EXPECT_EQ(GeometryOfLeg(30, 0.3, 1, 0.3, 1).toolface, 0);
  EXPECT_THROW(GeometryOfLeg(0, 0, 0, 0, 0), std::invalid_argument);
}

// Ahead with a leg's own severity and toolface arrives at its end: two definitions, one curve.
TEST(LegGeometry, ToolfaceLeadsToTheNextStation) {
  for (const double i2 : {0.05, 0.8, 1.9}) {
    for (const double a2 : {0.0, 1.5, 4.0}) {
      const LegGeometry leg = GeometryOfLeg(50, 0.7, 2.0, i2, a2);
      const std::vector<double> md{0, 10}, inclination{0.7, 0.7}, azimuth{2, 2};
      const TrajectoryPoint end = Trajectory(md, inclination, azimuth, {0, 0, 0})
                                      .Ahead(50, leg.dogleg_severity, leg.toolface);
      EXPECT_LT((end.tangent_W - Tangent(i2, a2)).norm(), 1e-13);
    }
  }
}

TEST(Closure, SectionAndSubSea) {
  EXPECT_NEAR(ClosureOf(-3, -4).distance, 5, 1e-15);
  EXPECT_NEAR(ClosureOf(-3, -4).azimuth, kPi + std::atan2(4, 3), 1e-15);
  EXPECT_NEAR(ClosureOf(1, -1e-30).azimuth, 0, 1e-15);
  EXPECT_NEAR(VerticalSection(10, 20, FromDegrees(30), 1, 2),
              9 * std::cos(FromDegrees(30)) + 18 * 0.5, 1e-12);
  EXPECT_EQ(TvdSubSea(100, 25), 75);
}

}  // namespace
}  // namespace wellgyro

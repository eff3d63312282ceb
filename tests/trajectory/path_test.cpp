#include "wellgyro/trajectory/path.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <GeographicLib/Geodesic.hpp>
#include <gtest/gtest.h>

#include "wellgyro/base/units.h"
#include "wellgyro/trajectory/minimum_curvature.h"

namespace wellgyro {
namespace {

struct End {
  double azimuth, convergence;  // at the far end [rad]
};

// A geodesic of WGS 84 from 5 deg east, by GeographicLib.
End AlongGeodesic(double latitude_deg, double azimuth_deg, double distance) {
  double latitude = 0, longitude = 0, azimuth = 0;
  GeographicLib::Geodesic::WGS84().Direct(latitude_deg, 5, azimuth_deg, distance, latitude,
                                          longitude, azimuth);
  return {FromDegrees(azimuth), WrapPi(FromDegrees(azimuth - azimuth_deg))};
}

TEST(MeridianConvergence, IsTheTurnOfAGeodesicsAzimuth) {
  for (const double latitude_deg : {-70.0, -35.0, 0.0, 5.0, 60.0, 70.0}) {
    const Site head = SiteAt(FromDegrees(latitude_deg), 0);
    for (const double azimuth_deg : {0.0, 30.0, 90.0, 135.0, 250.0, 300.0}) {
      for (const double distance : {10.0, 1000.0, 10000.0}) {
        const double north = distance * std::cos(FromDegrees(azimuth_deg));
        const double east = distance * std::sin(FromDegrees(azimuth_deg));
        const double truth = AlongGeodesic(latitude_deg, azimuth_deg, distance).convergence;
        EXPECT_NEAR(MeridianConvergence(head, north, east), truth, 3e-8 * distance / 10000 + 1e-15)
            << latitude_deg << " " << azimuth_deg << " " << distance;
      }
    }
  }
  // The design's example.
  EXPECT_NEAR(ToDegrees(MeridianConvergence(SiteAt(FromDegrees(60), 0), 0, 5000)), 0.08, 0.005);
}

// A level hole along a geodesic is straight seen from the well head, though its own azimuth turns.
TEST(Path, ALevelGeodesicIsStraightWhateverTheSpacing) {
  for (const double azimuth_deg : {90.0, 40.0, 200.0}) {
    for (const double spacing : {5.0, 30.0, 1000.0}) {
      const Site head = SiteAt(FromDegrees(60), 0);
      Path path(head, {0, kPi / 2, FromDegrees(azimuth_deg)}, {0, 0, 2000});
      const int n = static_cast<int>(8000 / spacing);
      for (int i = 1; i <= n; ++i) {
        const double azimuth = AlongGeodesic(60, azimuth_deg, i * spacing).azimuth;
        ASSERT_TRUE(path.Add({i * spacing, kPi / 2, azimuth}));
      }
      const double length = n * spacing;
      const Eigen::Vector3d& p = path.last().p_WT_W;
      EXPECT_NEAR(p.x(), length * std::cos(FromDegrees(azimuth_deg)), 3e-4) << spacing;
      EXPECT_NEAR(p.y(), length * std::sin(FromDegrees(azimuth_deg)), 3e-4) << spacing;
      EXPECT_NEAR(p.z(), 2000, 1e-9);
      EXPECT_LT(path.last().dogleg_severity, 1e-9);
    }
  }
}

TEST(Path, OnTheEquatorIsPlainMinimumCurvature) {
  Path path(SiteAt(0, 0), {10, 0.1, 1.0}, {1, 2, 3});
  const auto added = path.Add({40, 0.4, 1.3});
  ASSERT_TRUE(added);
  const double md[] = {10, 40}, inclination[] = {0.1, 0.4}, azimuth[] = {1.0, 1.3};
  Eigen::Vector3d position[2];
  double severity[2];
  MinimumCurvature(md, inclination, azimuth, {1, 2, 3}, position, severity);
  EXPECT_LT((added->p_WT_W - position[1]).norm(), 1e-9);
  EXPECT_NEAR(added->dogleg_severity, severity[1], 1e-12);
}

TEST(Path, FaultsNameTheDepthAndLeaveThePathAsItWas) {
  Path path(SiteAt(FromDegrees(50), 0), {100, 0.2, 1.0}, {0, 0, 99});
  const auto back = path.Add({100, 0.2, 1.0});
  ASSERT_FALSE(back);
  EXPECT_EQ(back.fault().code, FaultCode::kOrder);
  EXPECT_NE(back.fault().text.find("100 m"), std::string::npos);
  const auto opposite = path.Add({130, kPi - 0.2, 1.0 + kPi});
  ASSERT_FALSE(opposite);
  EXPECT_EQ(opposite.fault().code, FaultCode::kRange);
  EXPECT_NE(opposite.fault().text.find("130 m"), std::string::npos);
  const auto odd = path.Add({130, std::numeric_limits<double>::infinity(), 0});
  ASSERT_FALSE(odd);
  EXPECT_EQ(odd.fault().code, FaultCode::kRange);
  EXPECT_EQ(path.last().station.md, 100);
  EXPECT_TRUE(path.Add({130, 0.2, 1.0}));
}

TEST(Path, RefusesAHeadWithoutTrueNorth) {
  EXPECT_THROW(Path(SiteAt(FromDegrees(89.9), 0), {}, {0, 0, 0}), std::invalid_argument);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(Path(SiteAt(0, 0), {nan, 0, 0}, {0, 0, 0}), std::invalid_argument);
}

TEST(Interpolate, LiesOnTheArcBetweenItsEnds) {
  const Site head = SiteAt(FromDegrees(60), 0);
  Path path(head, {1000, 1.2, 1.5}, {500, 3000, 800});
  const PathPoint from = path.last();
  const PathPoint to = *path.Add({1090, 1.6, 2.1});
  const PathPoint begin = Interpolate(head, from, to, 1000);
  const PathPoint end = Interpolate(head, from, to, 1090);
  EXPECT_LT((begin.p_WT_W - from.p_WT_W).norm(), 1e-12);
  EXPECT_LT((end.p_WT_W - to.p_WT_W).norm(), 1e-12);
  EXPECT_NEAR(begin.station.azimuth, 1.5, 1e-15);
  EXPECT_NEAR(end.station.azimuth, 2.1, 1e-10);
  EXPECT_NEAR(end.station.inclination, 1.6, 1e-15);
  // The derivative of position by depth is the tangent.
  const PathPoint a = Interpolate(head, from, to, 1030 - 1e-3);
  const PathPoint b = Interpolate(head, from, to, 1030 + 1e-3);
  const PathPoint middle = Interpolate(head, from, to, 1030);
  EXPECT_LT(((b.p_WT_W - a.p_WT_W) / 2e-3 - middle.tangent_W).norm(), 1e-9);
  EXPECT_NEAR(middle.tangent_W.norm(), 1, 1e-15);
  EXPECT_EQ(middle.dogleg_severity, to.dogleg_severity);
}

TEST(Interpolate, CarriesTheAzimuthThroughAVerticalHole) {
  const Site head = SiteAt(FromDegrees(60), 0);
  Path path(head, {0, 0, 2.0}, {0, 0, 0});
  const PathPoint from = path.last();
  const PathPoint to = *path.Add({30, 0, 5.0});
  const PathPoint middle = Interpolate(head, from, to, 12);
  EXPECT_EQ(middle.station.azimuth, 2.0);
  EXPECT_EQ(middle.p_WT_W.z(), 12);
}

}  // namespace
}  // namespace wellgyro

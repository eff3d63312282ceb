#include "wellgyro/earth/grid.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/earth/earth.h"

namespace wellgyro {
namespace {

constexpr double Dms(double d, double m, double s) { return FromDegrees(d + m / 60 + s / 3600); }

// The worked examples of IOGP Publication 373-7-2 (EPSG Guidance Note 7-2).

TEST(ProjectToGrid, TransverseMercatorAsPublished) {  // British National Grid
  GridSpec grid;
  grid.semi_major = 6377563.396;
  grid.inverse_flattening = 299.32496;
  grid.latitude_origin = FromDegrees(49);
  grid.longitude_origin = FromDegrees(-2);
  grid.scale_origin = 0.9996012717;
  grid.false_easting = 400'000;
  grid.false_northing = -100'000;
  const GridPoint p = ProjectToGrid(grid, Dms(50, 30, 0), Dms(0, 30, 0));
  EXPECT_NEAR(p.easting, 577274.99, 0.01);
  EXPECT_NEAR(p.northing, 69740.50, 0.01);
}

TEST(ProjectToGrid, LambertConeWithTwoParallelsAsPublished) {  // NAD27 / Texas South Central
  GridSpec grid;
  grid.projection = GridSpec::Projection::kLambertConformalConic;
  grid.semi_major = 6378206.4;
  grid.inverse_flattening = 294.97870;
  grid.latitude_origin = Dms(27, 50, 0);
  grid.longitude_origin = FromDegrees(-99);
  grid.parallel_1 = Dms(28, 23, 0);
  grid.parallel_2 = Dms(30, 17, 0);
  grid.false_easting = 2'000'000 * units::kUsSurveyFoot;
  const GridPoint p = ProjectToGrid(grid, Dms(28, 30, 0), FromDegrees(-96));
  EXPECT_NEAR(p.easting / units::kUsSurveyFoot, 2963503.91, 0.01);
  EXPECT_NEAR(p.northing / units::kUsSurveyFoot, 254759.80, 0.01);
}

TEST(ProjectToGrid, LambertConeWithOneParallelAsPublished) {  // JAD69 / Jamaica National Grid
  GridSpec grid;
  grid.projection = GridSpec::Projection::kLambertConformalConic;
  grid.semi_major = 6378206.4;
  grid.inverse_flattening = 294.97870;
  grid.latitude_origin = grid.parallel_1 = grid.parallel_2 = FromDegrees(18);
  grid.longitude_origin = FromDegrees(-77);
  grid.false_easting = 250'000;
  grid.false_northing = 150'000;
  const GridPoint p = ProjectToGrid(grid, Dms(17, 55, 55.80), -Dms(76, 56, 37.26));
  EXPECT_NEAR(p.easting, 255966.58, 0.01);
  EXPECT_NEAR(p.northing, 142493.51, 0.01);
}

TEST(ProjectToGrid, PolarStereographicAsPublished) {  // WGS 84 / UPS North
  GridSpec grid;
  grid.projection = GridSpec::Projection::kPolarStereographic;
  grid.scale_origin = 0.994;
  grid.false_easting = grid.false_northing = 2'000'000;
  const GridPoint p = ProjectToGrid(grid, FromDegrees(73), FromDegrees(44));
  EXPECT_NEAR(p.easting, 3320416.75, 0.01);
  EXPECT_NEAR(p.northing, 632668.43, 0.01);
}

GridSpec SouthPole() {
  GridSpec grid;
  grid.projection = GridSpec::Projection::kPolarStereographic;
  grid.north_pole = false;
  grid.longitude_origin = FromDegrees(20);
  return grid;
}

GridSpec Cone() {
  GridSpec grid;
  grid.projection = GridSpec::Projection::kLambertConformalConic;
  grid.parallel_1 = FromDegrees(44);
  grid.parallel_2 = FromDegrees(49);
  grid.longitude_origin = FromDegrees(3);
  return grid;
}

// Convergence and scale by what they mean: where a step to true north goes on the grid.
TEST(ProjectToGrid, ConvergenceAndScaleAreThoseOfAStepToTrueNorth) {
  struct Case {
    GridSpec grid;
    double latitude_deg, longitude_deg;
  };
  for (const Case& c :
       {Case{UtmGrid("31N"), 60, 5.9}, Case{UtmGrid("31N"), 52, 0.3},
        Case{UtmGrid("21S"), -33, -55}, Case{SouthPole(), -77, -100}, Case{Cone(), 47, -1}}) {
    const double latitude = FromDegrees(c.latitude_deg);
    const double longitude = FromDegrees(c.longitude_deg);
    const double step = 1e-6;
    const GridPoint south = ProjectToGrid(c.grid, latitude - step, longitude);
    const GridPoint north = ProjectToGrid(c.grid, latitude + step, longitude);
    const GridPoint here = ProjectToGrid(c.grid, latitude, longitude);
    const double de = north.easting - south.easting, dn = north.northing - south.northing;
    // The grid azimuth of true north is less the convergence.
    EXPECT_NEAR(WrapPi(std::atan2(de, dn) + here.convergence), 0, 1e-8) << c.grid.name;
    EXPECT_NEAR(std::hypot(de, dn) / (2 * step * SiteAt(latitude, 0).radius_north), here.scale,
                1e-8)
        << c.grid.name;
  }
}

TEST(ProjectToGrid, EastOfTheMeridianInTheNorthConvergenceIsPositive) {
  EXPECT_GT(ProjectToGrid(UtmGrid("31N"), 1.0, FromDegrees(4)).convergence, 0);
  EXPECT_LT(ProjectToGrid(UtmGrid("31S"), -1.0, FromDegrees(4)).convergence, 0);
}

TEST(ProjectToGrid, WorksAcrossTheDateLine) {
  const GridPoint p = ProjectToGrid(UtmGrid("60N"), 0.7, FromDegrees(-179.5));
  EXPECT_GT(p.easting, 700'000);
  EXPECT_LT(p.easting, 800'000);
}

TEST(ProjectToGrid, RefusesWhatIsOutside) {
  EXPECT_THROW((void)ProjectToGrid(UtmGrid("31N"), 1.0, FromDegrees(60)), std::domain_error);
  EXPECT_THROW((void)ProjectToGrid(UtmGrid("31N"), 1.6, 0), std::domain_error);
  EXPECT_THROW((void)ProjectToGrid(UtmGrid("31N"), 1.0, std::numeric_limits<double>::infinity()),
               std::domain_error);
  EXPECT_THROW((void)ProjectToGrid(SouthPole(), kPi / 2, 0), std::domain_error);
  EXPECT_THROW((void)ProjectToGrid(Cone(), -kPi / 2, 0), std::domain_error);
  GridSpec odd = UtmGrid("31N");
  odd.semi_major = -1;
  EXPECT_THROW((void)ProjectToGrid(odd, 1.0, FromDegrees(3)), std::invalid_argument);
}

TEST(ProjectToGrid, OriginsThatAreNotFiniteAreNoGrid) {
  for (double GridSpec::*member : {&GridSpec::false_easting, &GridSpec::false_northing,
                                   &GridSpec::latitude_origin, &GridSpec::longitude_origin}) {
    GridSpec grid = UtmGrid("31N");
    grid.*member = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(ProjectToGrid(grid, 1, 0.05), std::invalid_argument);
  }
}

TEST(UtmGrid, KnowsItsZones) {
  EXPECT_EQ(UtmGrid("31N").name, "UTM 31N");
  EXPECT_DOUBLE_EQ(UtmGrid("31N").longitude_origin, FromDegrees(3));
  EXPECT_DOUBLE_EQ(UtmGrid("1S").longitude_origin, FromDegrees(-177));
  EXPECT_EQ(UtmGrid("60S").false_northing, 1e7);
  for (const char* odd :
       {"", "N", "31", "31n", "0N", "61N", "31NN", "-1N", "31X", " 31N", "3 1N"}) {
    EXPECT_THROW((void)UtmGrid(odd), std::invalid_argument) << odd;
  }
}

// Against the radii of curvature for a short step, and back along the geodesic for a long one.
TEST(OffsetGeodetic, FollowsTheGeodesic) {
  const GeodeticPoint head{FromDegrees(60), FromDegrees(5)};
  const Site site = SiteAt(head.latitude, 0);
  const GeodeticPoint near = OffsetGeodetic(head, 30, -40);
  EXPECT_NEAR(near.latitude - head.latitude, 30 / site.radius_north, 1e-10);
  EXPECT_NEAR(near.longitude - head.longitude, -40 / (site.radius_east * 0.5), 2e-10);
  // Due east the geodesic bends towards the equator by s^2 tan(latitude) / (2 R N).
  const GeodeticPoint far = OffsetGeodetic(head, 0, 10000);
  EXPECT_NEAR(far.latitude - head.latitude,
              -1e8 * std::tan(head.latitude) / (2 * site.radius_north * site.radius_east), 1e-10);
  EXPECT_EQ(OffsetGeodetic(head, 0, 0).longitude, head.longitude);
}

TEST(WellGrid, WithoutAStatementIsTheProjection) {
  const GeodeticPoint head{FromDegrees(60), FromDegrees(5.5)};
  const WellGrid well(UtmGrid("31N"), head);
  const GeodeticPoint place = OffsetGeodetic(head, 1500, -900);
  const GridPoint truth = ProjectToGrid(UtmGrid("31N"), place.latitude, place.longitude);
  const GridPoint point = well.At(1500, -900);
  EXPECT_NEAR(point.northing, truth.northing, 1e-8);
  EXPECT_NEAR(point.easting, truth.easting, 1e-8);
  EXPECT_NEAR(point.convergence, truth.convergence, 1e-15);
}

TEST(WellGrid, WhatTheOperatorStatesHolds) {
  const GeodeticPoint head{FromDegrees(60), FromDegrees(5.5)};
  GridSpec grid = UtmGrid("31N");
  grid.convergence = FromDegrees(1.9);
  grid.scale = 0.99975;
  const WellGrid well(grid, head);
  const GridPoint start = well.At(0, 0);
  EXPECT_EQ(start.northing, well.projected_head().northing);
  EXPECT_NEAR(start.convergence, *grid.convergence, 1e-15);
  EXPECT_NEAR(start.scale, *grid.scale, 1e-15);
  // A step of true azimuth 70 deg has grid azimuth 68.1 deg and the stated scale.
  const double azimuth = FromDegrees(70);
  const GridPoint step = well.At(10 * std::cos(azimuth), 10 * std::sin(azimuth));
  const double dn = step.northing - start.northing, de = step.easting - start.easting;
  EXPECT_NEAR(std::atan2(de, dn), azimuth - *grid.convergence, 1e-6);
  EXPECT_NEAR(std::hypot(dn, de), 10 * *grid.scale, 1e-5);
  // Along the well convergence changes as the projection's own.
  const GridPoint own = WellGrid(UtmGrid("31N"), head).At(0, 4000);
  EXPECT_NEAR(well.At(0, 4000).convergence - own.convergence,
              *grid.convergence - well.projected_head().convergence, 1e-15);
  EXPECT_GT(own.convergence, well.projected_head().convergence + FromDegrees(0.05));
}

TEST(WellGrid, RefusesStatementsThatMakeNoSense) {
  GridSpec grid = UtmGrid("31N");
  grid.scale = 0;
  EXPECT_THROW(WellGrid(grid, {1, 0.05}), std::invalid_argument);
  EXPECT_THROW(WellGrid(UtmGrid("31N"), {1, 2}), std::domain_error);
}

}  // namespace
}  // namespace wellgyro

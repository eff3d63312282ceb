#include "wellgyro/earth/crs.h"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "wellgyro/base/units.h"

namespace wellgyro {
namespace {

GeodeticPoint Place(double latitude, double longitude) {
  return {latitude * units::kDeg, longitude * units::kDeg};
}

// An independent projection, GeographicLib's, on WGS 84: UTM north and south, east and west of the
// central meridian. The sign of the convergence is the same: true less grid azimuth.
TEST(Crs, UtmAsGeographicLibHasIt) {
  const struct {
    const char* code;
    const char* zone;
    double latitude, longitude;
  } cases[] = {{"EPSG:32631", "31N", 58.44, 1.93},
               {"EPSG:32631", "31N", 58.44, 5.5},
               {"EPSG:32733", "33S", -12.3, 13.1},
               {"EPSG:32760", "60S", -41, 178.9}};
  for (const auto& c : cases) {
    const auto found = ProjectToCrs(c.code, Place(c.latitude, c.longitude));
    ASSERT_TRUE(found) << found.fault().text;
    const GridPoint ours =
        ProjectToGrid(UtmGrid(c.zone), c.latitude * units::kDeg, c.longitude * units::kDeg);
    EXPECT_NEAR(found->point.easting, ours.easting, 1e-6) << c.code;
    EXPECT_NEAR(found->point.northing, ours.northing, 1e-6) << c.code;
    EXPECT_NEAR(found->point.convergence / units::kDeg, ours.convergence / units::kDeg, 1e-8);
    EXPECT_NEAR(found->point.scale, ours.scale, 1e-9);
    EXPECT_EQ(found->unit, 1);
  }
}

// EPSG Guidance Note 7-2, the worked example of the Lambert conic of Texas South Central in US
// survey feet: 28 deg 30' N, 96 deg W gives easting 2963503.91 and northing 254759.80 (NAD27).
TEST(Crs, FeetAsThePublishedExampleHasThem) {
  const auto grid = ShiftPoint("EPSG:4267", "EPSG:32040", {-96, 28.5, 0});
  ASSERT_TRUE(grid) << grid.fault().text;
  EXPECT_NEAR(grid->point.x, 2963503.91, 0.006);
  EXPECT_NEAR(grid->point.y, 254759.80, 0.006);
  const auto back = ShiftPoint("EPSG:32040", "EPSG:4267", grid->point);
  ASSERT_TRUE(back);
  EXPECT_NEAR(back->point.x, -96, 1e-10);
  EXPECT_NEAR(back->point.y, 28.5, 1e-10);
}

TEST(Crs, ThereAndBack) {
  const auto grid = ProjectToCrs("EPSG:23031", Place(58.44, 1.93));
  ASSERT_TRUE(grid) << grid.fault().text;
  EXPECT_EQ(grid->name, "ED50 / UTM zone 31N");
  const auto place = GeodeticOfCrs("EPSG:23031", {grid->point.easting, grid->point.northing, 0});
  ASSERT_TRUE(place);
  EXPECT_NEAR(place->latitude / units::kDeg, 58.44, 2e-8);  // 2 mm: heights go with the datum
  EXPECT_NEAR(place->longitude / units::kDeg, 1.93, 2e-8);
  // The datum moves the well by some hundred metres: never forgotten.
  const auto wgs = ProjectToCrs("EPSG:32631", Place(58.44, 1.93));
  ASSERT_TRUE(wgs);
  EXPECT_GT(std::hypot(grid->point.easting - wgs->point.easting,
                       grid->point.northing - wgs->point.northing),
            100);
}

// NAD27 to NAD83 in Texas is done by a grid file that Debian's package lacks: its name is said, and
// no rough shift is given in its place.
TEST(Crs, AMissingGridIsNamed) {
  const auto shifted = ShiftPoint("EPSG:4267", "EPSG:4269", {-96, 28.5, 0});
  if (shifted) GTEST_SKIP() << "this machine has the grid: " << shifted->operation;
  EXPECT_EQ(shifted.fault().code, FaultCode::kRange);
  EXPECT_NE(shifted.fault().text.find("grid file"), std::string::npos) << shifted.fault().text;
  EXPECT_NE(shifted.fault().text.find(".tif"), std::string::npos) << shifted.fault().text;
}

TEST(Crs, RefusesWhatItDoesNotKnow) {
  EXPECT_EQ(ProjectToCrs("EPSG:999999", Place(1, 1)).fault().code, FaultCode::kForeign);
  EXPECT_EQ(ProjectToCrs("EPSG:4326", Place(1, 1)).fault().code, FaultCode::kForeign);
  for (const char* bad : {"", "EPSG", ":", "EPSG:", "+proj=utm +zone=31", "/etc/passwd",
                          "urn:ogc:def:crs:EPSG::23031", "EPSG:23031+5773"}) {
    EXPECT_FALSE(ProjectToCrs(bad, Place(58, 2))) << bad;
  }
  EXPECT_FALSE(ShiftPoint("EPSG:32631", "EPSG:4326", {NAN, 0, 0}));
  EXPECT_FALSE(ShiftPoint("EPSG:32631", "EPSG:4326", {1e30, 1e30, 0}));
}

// An operation holds in the area the registry states for it: at 57 deg N, 7.5 deg E, in the
// Norwegian North Sea, "ED50 to WGS 84 (24)", EPSG:1613, of the sea south of 62 deg, and not (25),
// EPSG:1627, of Denmark east of 8 deg; New Zealand lies on both sides of the antimeridian.
TEST(Crs, TheOperationIsOneOfThePlace) {
  const auto sea = ProjectToCrs("EPSG:23032", Place(57, 7.5));
  ASSERT_TRUE(sea) << sea.fault().text;
  EXPECT_NE(sea->operation.find("ED50 to WGS 84 (24)"), std::string::npos) << sea->operation;
  EXPECT_EQ(sea->accuracy, 1);
  const auto denmark = ProjectToCrs("EPSG:23032", Place(56, 9));
  ASSERT_TRUE(denmark) << denmark.fault().text;
  EXPECT_NE(denmark->operation.find("ED50 to WGS 84 (25)"), std::string::npos)
      << denmark->operation;
  for (const double longitude : {173.6, -178.5 + 360}) {
    const auto zealand = ProjectToCrs("EPSG:2193", Place(-39.3, longitude));
    ASSERT_TRUE(zealand) << zealand.fault().text;
    EXPECT_NE(zealand->operation.find("NZGD2000 to WGS 84 (1)"), std::string::npos);
  }
}

// PSAD56 / UTM 19S is for 72 to 66 deg W south of the equator; 20N holds at 10 deg N, 64.5 deg W.
TEST(Crs, APlaceOutsideTheAreaOfASystemIsTold) {
  EXPECT_EQ(ProjectToCrs("EPSG:24820", Place(10, -64.5))->outside, "");
  EXPECT_NE(ProjectToCrs("EPSG:24879", Place(10, -64.5))->outside, "");
}

// SWEREF99 TM lists the northing first. On its central meridian true north is grid north; 3 deg
// east of it the convergence is the sphere's, tan(c) = tan(3 deg) sin(latitude), to 1e-3 deg.
TEST(Crs, ConvergenceOfASystemThatListsTheNorthingFirst) {
  const auto place = [](double longitude_deg) {
    return GeodeticPoint{.latitude = 60 * units::kDeg, .longitude = longitude_deg * units::kDeg};
  };
  const auto middle = ProjectToCrs("EPSG:3006", place(15)),
             east = ProjectToCrs("EPSG:3006", place(18));
  ASSERT_TRUE(middle && east);
  EXPECT_NEAR(middle->point.easting, 500'000, 1e-3);
  EXPECT_NEAR(middle->point.convergence, 0, 1e-8);
  EXPECT_NEAR(middle->point.scale, 0.9996, 1e-9);
  EXPECT_NEAR(east->point.convergence,
              std::atan(std::tan(3 * units::kDeg) * std::sin(60 * units::kDeg)),
              1e-3 * units::kDeg);
}

}  // namespace
}  // namespace wellgyro

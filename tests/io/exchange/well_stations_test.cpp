#include "wellgyro/io/exchange/well_stations.h"

#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "wellgyro/base/units.h"

namespace wellgyro {
namespace {

using testing::HasSubstr;

WellStations Good(const std::string& text, North wanted = North::kTrue) {
  const auto table = ParseWellStations(text, "s.csv", wanted);
  if (!table) ADD_FAILURE() << table.fault().line << ": " << table.fault().text;
  return table ? *table : WellStations{};
}

TEST(WellStations, HeadersOfTheTrade) {
  const WellStations table = Good("MD[m],INC[deg],AZI_TRUE[deg]\n0,0,0\n30,1.5,359\n");
  EXPECT_EQ(table.north, North::kTrue);
  EXPECT_TRUE(table.depth_unit_stated);
  ASSERT_EQ(table.stations.size(), 2u);
  EXPECT_DOUBLE_EQ(table.stations[1].inclination, 1.5 * units::kDeg);
  EXPECT_DOUBLE_EQ(table.stations[1].azimuth, 359 * units::kDeg);

  EXPECT_DOUBLE_EQ(Good("md_ft;Inclination (deg);Azimuth\r\n0;0;0\r\n100;1;2\r\n").stations[1].md,
                   30.48);
  EXPECT_DOUBLE_EQ(Good("MD(ft)\tINC\tAZI\n0\t0\t0\n100\t1\t-90\n").stations[1].azimuth,
                   270 * units::kDeg);
  const WellStations bare = Good("\xEF\xBB\xBF# a remark\nmd inc azi\n0   0  0\n 30  1 2\n");
  EXPECT_FALSE(bare.depth_unit_stated);
  EXPECT_EQ(bare.north, North::kUnknown);
  EXPECT_EQ(bare.stations[1].md, 30);
}

TEST(WellStations, OffsetsAreTakenWithoutATvd) {
  const WellStations half =
      Good("MD[m],INC[deg],AZI_TRUE[deg],N[m],E[m]\n0,0,0,5,-7\n30,0,0,5,-7\n");
  EXPECT_FALSE(half.start_stated);
  ASSERT_TRUE(half.offsets);
  EXPECT_EQ(*half.offsets, Eigen::Vector2d(5, -7));
  EXPECT_FALSE(Good("MD[m],INC[deg],AZI_TRUE[deg]\n0,0,0\n30,0,0\n").offsets);
}

TEST(WellStations, ChoosesTheNorthThatIsWanted) {
  const std::string both = "MD[m],INC[deg],AZI_TRUE[deg],AZI_GRID[deg]\n0,1,10,20\n9,1,10,20\n";
  EXPECT_NEAR(Good(both).stations[0].azimuth, 10 * units::kDeg, 1e-15);
  const WellStations grid = Good(both, North::kGrid);
  EXPECT_NEAR(grid.stations[0].azimuth, 20 * units::kDeg, 1e-15);
  EXPECT_EQ(grid.north, North::kGrid);
}

TEST(WellStations, TakesTheStartFromThePositionsOfTheFirstRow) {
  const WellStations table = Good(
      "MD[ft],INC[deg],AZI[deg],TVD[ft],N[m],E[ft]\n100,0,0,99,5,10\n200,1,1,199,5.266,10.015\n");
  ASSERT_TRUE(table.start_stated);
  EXPECT_LT((table.start_W - Eigen::Vector3d(5, 3.048, 99 * 0.3048)).norm(), 1e-12);
  EXPECT_FALSE(Good("MD[m],INC,AZI,TVD[m]\n0,0,0,0\n9,0,0,9\n").start_stated);
}

TEST(WellStations, OffsetsFromTwoWellHeadsContradictTheMap) {
  const auto at = [](const std::string& place) {
    return Good("MD[m],INC[deg],AZI_TRUE[deg],TVD[m],N[m],E[m],NORTHING[m],EASTING[m]\n0,0,0,0," +
                place + "\n30,0,0,30," + place + "\n");
  };
  const WellStations a = at("0,0,6600000,400000"), b = at("0,0,6600300,400400");
  ASSERT_TRUE(a.map);
  EXPECT_THAT(PlacesContradict(a, b).value_or(""),
              HasSubstr("500.0 m apart by their map coordinates, 0.0 m"));
  // A map's scale and the turn of grid to true north are no contradiction.
  EXPECT_FALSE(PlacesContradict(a, at("310,392.6,6600300,400400")));
  EXPECT_FALSE(PlacesContradict(a, Good("MD[m],INC,AZI\n0,0,0\n9,0,0\n")));
}

TEST(WellStations, AFaultSaysWhoseOptionItNames) {
  const auto well = ParseWellStations("WELL,MD[m],INC,AZI\nA,0,0,0\nB,0,0,0\n", "s.csv");
  ASSERT_FALSE(well);
  EXPECT_THAT(well.fault().text, HasSubstr("--well; that is an option of wellgyro convert"));
}

TEST(WellStations, FaultsNameTheirPlace) {
  const std::string head = "MD[m],INC[deg],AZI[deg]\n";
  struct Bad {
    std::string text;
    int line;
    const char* says;
  };
  const Bad all[] = {
      {"", 0, "empty"},
      {head, 1, "single station"},
      {head + "0,0,0\n", 0, "two stations"},
      {head + "0,0,0\n30,x,0\n", 3, "'x'"},
      {head + "0,0,0\n30,1\n", 3, "2 fields where the header has 3"},
      {head + "0,0,0\n30,nan,1\n", 3, "'nan'"},
      {head + "0,0,0\n30,inf,1\n", 3, "'inf'"},
      {head + "0,0,0\n1e99,1,1\n", 3, "e+99"},
      {head + "0,0,0\n30,181,1\n", 3, "181"},
      {head + "0,0,0\n30,-1,1\n", 3, "-1"},
      {head + "0,0,0\n0,1,1\n", 3, "increase"},
      {head + "0,0,0\n30,180,1\n", 0, "MD 30 m"},
      {"MD[m],INC[deg]\n0,0\n", 2, "azimuth"},
      {"MD[yd],INC[deg],AZI[deg]\n0,0,0\n", 2, "yd"},
      {"MD[m],INC[deg],AZI_MAG[deg]\n0,0,0\n9,0,0\n", 0, "magnetic"},
  };
  for (const Bad& bad : all) {
    const auto well = ParseWellStations(bad.text, "s.csv");
    ASSERT_FALSE(well) << bad.text;
    EXPECT_THAT(well.fault().text, HasSubstr(bad.says)) << bad.text;
    EXPECT_EQ(well.fault().line, bad.line) << bad.text;
  }
}

TEST(WellStations, AnyFormatOfTheTrade) {
  const std::string las =
      "~V\n VERS. 2.0 :\n WRAP. NO :\n~W\n STRT.FT 0 :\n STOP.FT 100 :\n STEP.FT 0 :\n NULL. "
      "-999.25 :\n~C\n DEPT.FT :\n INCL.DEG :\n"
      " AZIM.DEG :\n~A\n 0 0 0\n 100 1 90\n";
  const WellStations well = Good(las);
  ASSERT_EQ(well.stations.size(), 2u);
  EXPECT_DOUBLE_EQ(well.stations[1].md, 30.48);
  EXPECT_DOUBLE_EQ(well.stations[1].azimuth, 90 * units::kDeg);
}

}  // namespace
}  // namespace wellgyro

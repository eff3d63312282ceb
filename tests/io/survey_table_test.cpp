#include "wellgyro/io/survey_table.h"

#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "wellgyro/base/units.h"

namespace wellgyro {
namespace {

using testing::HasSubstr;

SurveyTable Good(const std::string& text, NorthReference wanted = NorthReference::kTrue) {
  const auto table = ParseSurveyTable(text, "s.csv", wanted);
  if (!table) ADD_FAILURE() << table.fault().line << ": " << table.fault().text;
  return table ? *table : SurveyTable{};
}

TEST(SurveyTable, HeadersOfTheTrade) {
  const SurveyTable table = Good("MD[m],INC[deg],AZI_TRUE[deg]\n0,0,0\n30,1.5,359\n");
  EXPECT_EQ(table.north, NorthReference::kTrue);
  EXPECT_TRUE(table.depth_unit_stated);
  ASSERT_EQ(table.stations.size(), 2u);
  EXPECT_DOUBLE_EQ(table.stations[1].inclination, 1.5 * units::kDeg);
  EXPECT_DOUBLE_EQ(table.stations[1].azimuth, 359 * units::kDeg);

  EXPECT_DOUBLE_EQ(Good("md_ft;Inclination (deg);Azimuth\r\n0;0;0\r\n100;1;2\r\n").stations[1].md,
                   30.48);
  EXPECT_DOUBLE_EQ(Good("MD(ft)\tINC\tAZI\n0\t0\t0\n100\t1\t-90\n").stations[1].azimuth,
                   270 * units::kDeg);
  const SurveyTable bare = Good("\xEF\xBB\xBF# a remark\nmd inc azi\n0   0  0\n 30  1 2\n");
  EXPECT_FALSE(bare.depth_unit_stated);
  EXPECT_EQ(bare.north, NorthReference::kUnstated);
  EXPECT_EQ(bare.stations[1].md, 30);
}

TEST(SurveyTable, ChoosesTheNorthThatIsWanted) {
  const std::string both = "MD[m],INC[deg],AZI_TRUE[deg],AZI_GRID[deg]\n0,1,10,20\n9,1,10,20\n";
  EXPECT_NEAR(Good(both).stations[0].azimuth, 10 * units::kDeg, 1e-15);
  const SurveyTable grid = Good(both, NorthReference::kGrid);
  EXPECT_NEAR(grid.stations[0].azimuth, 20 * units::kDeg, 1e-15);
  EXPECT_EQ(grid.north, NorthReference::kGrid);
}

TEST(SurveyTable, TakesTheStartFromThePositionsOfTheFirstRow) {
  const SurveyTable table =
      Good("MD[ft],INC[deg],AZI[deg],TVD[ft],N[m],E[ft]\n100,0,0,99,5,10\n200,1,1,0,0,0\n");
  ASSERT_TRUE(table.start);
  EXPECT_LT((*table.start - Eigen::Vector3d(5, 3.048, 99 * 0.3048)).norm(), 1e-12);
  EXPECT_FALSE(Good("MD[m],INC,AZI,TVD[m]\n0,0,0,0\n9,0,0,9\n").start);
}

TEST(SurveyTable, FaultsNameTheirPlace) {
  const std::string head = "MD[m],INC[deg],AZI[deg]\n";
  struct Bad {
    std::string text;
    int line, column;
    const char* says;
  };
  const Bad all[] = {
      {"", 0, 1, "empty"},
      {head, 1, 1, "two stations"},
      {head + "0,0,0\n", 2, 1, "two stations"},
      {head + "0,0,0\n30,x,0\n", 3, 4, "'x'"},
      {head + "0,0,0\n30,1\n", 3, 1, "fewer cells"},
      {head + "0,0,0\n30,,1\n", 3, 4, "''"},
      {head + "0,0,0\n30,nan,1\n", 3, 4, "'nan'"},
      {head + "0,0,0\n30,inf,1\n", 3, 4, "'inf'"},
      {head + "0,0,0\n30,1e99,1\n", 3, 4, "cannot be"},
      {head + "0,0,0\n30,181,1\n", 3, 4, "180"},
      {head + "0,0,0\n30,-1,1\n", 3, 4, "180"},
      {head + "0,0,0\n0,1,1\n", 3, 1, "increase"},
      {head + "0,0,0\n30,180,1\n", 3, 1, "back"},
      {"MD[m],INC[deg]\n0,0\n", 1, 1, "AZI"},
      {"MD[yd],INC[deg],AZI[deg]\n0,0,0\n", 1, 1, "yd"},
      {"MD[m],INC[rad],AZI[deg]\n0,0,0\n", 1, 7, "rad"},
      {"MD[m],INC[deg],AZI_MAG[deg]\n0,0,0\n", 1, 1, "AZI"},
      {"MD[m],MD[ft],INC[deg],AZI\n0,0,0,0\n", 1, 7, "twice"},
  };
  for (const Bad& bad : all) {
    const auto table = ParseSurveyTable(bad.text, "s.csv");
    ASSERT_FALSE(table) << bad.text;
    EXPECT_THAT(table.fault().text, HasSubstr(bad.says));
    EXPECT_EQ(table.fault().line, bad.line) << bad.text;
    EXPECT_EQ(table.fault().column, bad.column) << bad.text;
  }
}

}  // namespace
}  // namespace wellgyro

// Tables as people and programs type them, made from a hole whose place is known in closed form:
// vertical, then a circle of 3 deg in 30 m, all in one plane 40 deg east of grid north.
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <gmock/gmock.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/exchange/exchange.h"

#include "io/exchange/parsed.h"

namespace wellgyro {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

struct Truth {
  double md, inclination, tvd, north, east;  // m and deg
};

std::vector<Truth> TypedHole() {
  constexpr double kDegree = std::numbers::pi / 180, kRadius = 30 / (3 * kDegree);
  std::vector<Truth> hole;
  for (int k = 0; k < 30; ++k) hole.push_back({30.0 * k, 0, 30.0 * k, 0, 0});
  for (int k = 0; k <= 20; ++k) {
    const double tilt = 3 * k * kDegree, out = kRadius * (1 - std::cos(tilt));
    hole.push_back({900 + 30.0 * k, 3.0 * k, 900 + kRadius * std::sin(tilt),
                    out * std::cos(40 * kDegree), out * std::sin(40 * kDegree)});
  }
  return hole;
}

std::string TypedRows(const std::function<std::string(const Truth&)>& row) {
  std::string text;
  for (const Truth& t : TypedHole()) text += row(t) + "\n";
  return text;
}

void ExpectTheHole(const SurveyTable& table) {
  const std::vector<Truth> hole = TypedHole();
  ASSERT_EQ(table.rows(), hole.size());
  for (std::size_t row = 0; row < hole.size(); ++row) {
    EXPECT_NEAR(table.md(row), hole[row].md, 0.006) << row;
    EXPECT_NEAR(table.inclination(row), hole[row].inclination * units::kDeg, 1e-6) << row;
    const auto tvd = table.Get(Column::kTvd, row), east = table.Get(Column::kEast, row);
    EXPECT_NEAR(tvd.value_or(hole[row].tvd), hole[row].tvd, 0.006) << row;
    EXPECT_NEAR(east.value_or(hole[row].east), hole[row].east, 0.006) << row;
  }
}

// 1,234.56 as it is written elsewhere.
std::string Typeset(double number, const std::string& between, const std::string& mark) {
  const std::string plain = fmt::format("{:.2f}", std::abs(number));
  const std::string whole = plain.substr(0, plain.size() - 3);
  std::string text = number < 0 ? "\u2212" : "";
  for (std::size_t i = 0; i < whole.size(); ++i) {
    if (i > 0 && (whole.size() - i) % 3 == 0) text += between;
    text += whole[i];
  }
  return text + mark + plain.substr(plain.size() - 2);
}

TEST(TypedTables, NumbersAsCountriesTypesetThem) {
  for (const std::string between : {" ", "\u00A0", "\u202F", "'", "."}) {
    const std::string mark = between == "'" ? "." : ",";
    const std::string text =
        "MD[m];INC[deg];AZI_GRID[deg];TVD[m]\n" + TypedRows([&](const Truth& t) {
          return Typeset(t.md, between, mark) + ";" + Typeset(t.inclination, between, mark) +
                 ";40;" + Typeset(t.tvd, between, mark);
        });
    SCOPED_TRACE(between);
    ExpectTheHole(Parsed(text));
  }
  const SurveyTable west =
      Parsed("MD[m],INC,AZI_TRUE,N[m],E[m]\n0,0,270,0,0\n30,4,270,0,\u22121.05\n");
  EXPECT_EQ(west.Get(Column::kEast, 1), -1.05);
}

TEST(TypedTables, GapsThatPartNoThousandsAreNoNumbers) {
  for (const std::string md : {"1 02", "10 2000", "1.02.5,5", "1 0200", "1' 020"}) {
    EXPECT_THAT(ParseFault("MD[m];INC[deg];AZI_GRID[deg]\n0;1,5;2\n" + md + ";1,5;2\n").text,
                HasSubstr("is not a number"))
        << md;
  }
}

TEST(TypedTables, NamesWithBlanksInThem) {
  const auto row = [](const Truth& t) {
    return fmt::format("{:14.2f}{:14.2f}{:14.2f}{:14.2f}{:14.2f}{:14.2f}", t.md, t.east, t.north,
                       t.tvd, t.inclination, 40.0);
  };
  for (const std::string names :
       {"MD(m)  X Offset(m)  Y Offset(m)  TVD(m)  Inclination(deg)  Azimuth Grid(deg)\n",
        "MD (m) East (m) North (m) TVD (m) Inc (deg) AZI_GRID (deg)\n",
        "MD East North TVD Inc Azi (azimuth)\n(m) (m) (m) (m) (deg) (deg)\n\n"}) {
    SCOPED_TRACE(names);
    ExpectTheHole(Parsed(names + TypedRows(row), {.north = North::kGrid}));
  }
}

TEST(TypedTables, ABlankLineBelowTheHeadingEndsNothing) {
  const auto row = [](const Truth& t) {
    return fmt::format("{:.2f},{:.2f},40,{:.2f}", t.md, t.inclination, t.tvd);
  };
  const std::string head = "MD[m],INC[deg],AZI_GRID[deg],TVD[m]\n";
  ExpectTheHole(Parsed(head + "\n" + TypedRows(row)));
  EXPECT_THAT(ParseFault(head + "0,0,0,0\n\n30,0,0,30\n").text, HasSubstr("take that line out"));
}

TEST(TypedTables, ManyRowsAreToldInOneNote) {
  const auto row = [](const Truth& at) {
    return fmt::format("{:.2f},{:.2f},{},{:.2f}", at.md, at.inclination,
                       at.inclination == 0 ? "" : "40", at.tvd);
  };
  const SurveyTable t = Parsed("MD[m],INC[deg],AZI_GRID[deg],TVD[m]\n" + TypedRows(row));
  EXPECT_THAT(t.head.notes, Contains(HasSubstr("31 stations from MD 0.00 m to 900.00 m")));
  EXPECT_THAT(t.head.notes, Not(Contains(HasSubstr("at MD 30.00 m"))));
}

// Inclinations of a run that was corrected after the positions were computed: each leg differs by
// little, the path by much.
TEST(TypedTables, WhatAddsUpAlongThePathIsTold) {
  const auto text = [](double more) {
    return "MD[m],INC[deg],AZI_GRID[deg],TVD[m]\n" + TypedRows([&](const Truth& t) {
             return fmt::format("{:.2f},{:.2f},40,{:.2f}", t.md,
                                t.inclination + (t.inclination > 0 ? more : 0), t.tvd);
           });
  };
  EXPECT_THAT(Parsed(text(0)).head.notes, Not(Contains(HasSubstr("part by up to"))));
  EXPECT_THAT(Parsed(text(0.3)).head.notes, Contains(HasSubstr("part by up to")));
}

TEST(TypedTables, DepthsBelowAndHeightsAboveTheSea) {
  const auto text = [](const std::string& column, double sign) {
    return "MD[m],INC[deg],AZI_GRID[deg]," + column + "\n" + TypedRows([&](const Truth& t) {
             return fmt::format("{:.2f},{:.2f},40,{:.2f}", t.md, t.inclination,
                                sign * (t.tvd - 25));
           });
  };
  const SurveyTable depth = Parsed(text("TVDSS[m]", 1));
  EXPECT_THAT(depth.head.notes, Contains(HasSubstr("agree by minimum curvature")));
  EXPECT_THAT(ParseFault(text("TVDSS[m]", -1)).text, HasSubstr("--columns TVDSS=0"));
  for (const double sign : {1, -1}) {
    const SurveyTable z = Parsed(text("Z[m]", sign));
    EXPECT_NEAR(*z.Get(Column::kDown, z.rows() - 1), TypedHole().back().tvd - 25, 0.006) << sign;
  }
  // Beside TVD a height does not stand for the elevation of the datum.
  const SurveyTable both =
      Parsed("MD[m],INC[deg],AZI_GRID[deg],TVD[m],Z[m]\n" + TypedRows([](const Truth& t) {
               return fmt::format("{:.2f},{:.2f},40,{:.2f},{:.2f}", t.md, t.inclination, t.tvd,
                                  25 - t.tvd);
             }));
  EXPECT_NEAR(both.head.datum_elevation.value_or(0), 25, 0.006);
}

TEST(TypedTables, TwoAzimuthsShowTheTurnBetweenTheirNorths) {
  const auto row = [](const Truth& at) {
    return fmt::format("{:.2f},{:.2f},42.67,40,{:.2f},{:.2f}", at.md, at.inclination, at.north,
                       at.east);
  };
  const SurveyTable t =
      Parsed("MD[m],INC[deg],AZI_MAG[deg],AZI_GRID[deg],N[m],E[m]\n" + TypedRows(row));
  EXPECT_EQ(t.head.azimuth.north, North::kMagnetic);
  EXPECT_EQ(t.head.offsets, North::kGrid);
  EXPECT_THAT(t.head.notes, Contains(HasSubstr("agree by minimum curvature with north and east")));
}

std::string Petrel(double head) {
  return fmt::format(
             "# WELL TRACE FROM PETREL\n# WELL NAME: A\n# WELL HEAD X-COORDINATE: {:.2f} (m)\n"
             "# WELL HEAD Y-COORDINATE: 6500000.00 (m)\n"
             "# WELL DATUM (KB, Kelly bushing, from MSL): 25.00 (m)\n"
             "MD X Y Z TVD DX DY AZIM_GN INCL\n",
             head) +
         TypedRows([](const Truth& t) {
           return fmt::format("{:.2f} {:.2f} {:.2f} {:.2f} {:.2f} {:.2f} {:.2f} 40 {:.2f}", t.md,
                              4e5 + t.east, 6.5e6 + t.north, 25 - t.tvd, t.tvd, t.east, t.north,
                              t.inclination);
         });
}

TEST(TypedTables, PetrelsHeadAndColumnsNameOneWellHead) {
  ExpectTheHole(Parsed(Petrel(4e5)));
  EXPECT_THAT(ParseFault(Petrel(4e5 + 300)).text,
              HasSubstr("mend the line WELL HEAD X-COORDINATE"));
}

TEST(TypedTables, RowsOfALogWithoutASurveyAreCounted) {
  const SurveyTable t = Parsed(
      "~V\n VERS. 2.0 :\n WRAP. NO :\n~W\n STRT.M 0 :\n STOP.M 60 :\n STEP.M 30 :\n"
      " NULL. -999.25 :\n~P\n I_AT. Grid :\n~C\n DEPT.M :\n DEVI.DEG :\n AZIM.DEG :\n~A\n"
      "0 1 2\n30 -999.25 -999.25\n60 1 2\n");
  EXPECT_EQ(t.rows(), 2u);
  EXPECT_THAT(t.head.notes, Contains(HasSubstr("1 rows without inclination are left out")));
}

// A survey of ours takes a depth from the way in and the next from the way out: their places differ
// by what the run knows of them, which it states, and no number is wrong.
TEST(TypedTables, PlacesMayDifferByTheirOwnSigma) {
  const auto text = [](double sigma) {
    std::string rows =
        "MD[m],INC[deg],AZI_GRID[deg],TVD[m],N[m],E[m],VAR_NN[m2],COV_NE[m2],COV_NV[m2],"
        "VAR_EE[m2],COV_EV[m2],VAR_VV[m2]\n";
    for (const Truth& t : TypedHole()) {
      const double beside = t.md == 1200 ? 0.13 : 0;
      rows += fmt::format("{},{},40,{:.4f},{:.4f},{:.4f},{v},0,0,{v},0,{v}\n", t.md, t.inclination,
                          t.tvd, t.north, t.east + beside, fmt::arg("v", sigma * sigma));
    }
    return rows;
  };
  EXPECT_EQ(Parsed(text(0.5)).rows(), TypedHole().size());
  EXPECT_THAT(ParseFault(text(0.01)).text, HasSubstr("0.13 m away from what its neighbours"));
}

}  // namespace
}  // namespace wellgyro

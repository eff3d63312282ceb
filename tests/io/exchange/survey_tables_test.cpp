#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>

#include "wellgyro/earth/grid.h"
#include "wellgyro/io/exchange/exchange.h"

#include "support/survey_samples.h"

namespace wellgyro {
namespace {

TEST(SurveyTables, TurningKeepsThePoints) {
  SurveyTable t = support::FullSurvey();
  const SurveyTable grid = t;
  TurnTo(t, North::kTrue);
  EXPECT_EQ(t.head.azimuth.north, North::kTrue);
  EXPECT_EQ(t.head.offsets, North::kTrue);
  const double c = -1.2345 * units::kDeg;
  for (std::size_t row = 0; row < t.rows(); ++row) {
    EXPECT_NEAR(WrapPi(t.azimuth(row) - grid.azimuth(row) - c), 0, 1e-14);
    const double n = *grid.Get(Column::kNorth, row), e = *grid.Get(Column::kEast, row);
    // The same point seen from axes turned back by the convergence.
    EXPECT_NEAR(*t.Get(Column::kNorth, row), n * std::cos(c) - e * std::sin(c), 1e-12);
    EXPECT_NEAR(*t.Get(Column::kEast, row), n * std::sin(c) + e * std::cos(c), 1e-12);
    const double vn = *grid.Get(Column::kVarNN, row), ve = *grid.Get(Column::kVarEE, row);
    EXPECT_NEAR(*t.Get(Column::kVarNN, row) + *t.Get(Column::kVarEE, row), vn + ve, 1e-15);
  }
  TurnTo(t, North::kGrid);
  EXPECT_NEAR(*t.Get(Column::kCovNE, 3), *grid.Get(Column::kCovNE, 3), 1e-15);
  SurveyTable unknown = grid;
  unknown.head.azimuth.convergence.reset();
  EXPECT_THROW(TurnTo(unknown, North::kTrue), std::invalid_argument);
}

TEST(SurveyTables, PositionsAreSummedOnlyWhereTheyCanBe) {
  SurveyTable t;
  t.Add(0, 0, 0);
  t.Add(100, 0, 0);
  t.Add(90, 1, 1, RowStatus::kUnused);
  t.Add(200, kPi / 2, kPi / 2);
  ASSERT_TRUE(FillPositions(t));
  EXPECT_NEAR(*t.Get(Column::kTvd, 3), 100 + 200 / kPi, 1e-6);
  EXPECT_NEAR(*t.Get(Column::kEast, 3), 200 / kPi, 1e-6);
  EXPECT_FALSE(t.Get(Column::kTvd, 2));
  SurveyTable deep;
  deep.Add(500, 0.5, 0);
  deep.Add(530, 0.5, 0);
  EXPECT_FALSE(FillPositions(deep));
  EXPECT_FALSE(deep.Has(Column::kTvd));
}

// Dated 2026-11-23: positions computed for a file in feet had all the digits of a conversion.
TEST(SurveyTables, ComputedNumbersHaveSixDecimalsInTheFilesOwnUnit) {
  for (const std::string unit : {"m", "ft", "ftUS"}) {
    std::string text = "MD[" + unit + "],INC[deg],AZI_TRUE[deg]\n";
    for (int k = 0; k < 60; ++k) {
      text +=
          std::to_string(100 * k) + "," + std::to_string(k) + "," + std::to_string(40 + k) + "\n";
    }
    Result<SurveyTable> table = ParseSurvey(text, "text");
    ASSERT_TRUE(table);
    ASSERT_TRUE(FillPositions(*table));
    table->head.section_azimuth = 45 * units::kDeg;
    FillDerived(*table);
    std::istringstream lines(WriteSurvey(*table, SurveyFormat::kCsv));
    int fields = 0;
    for (std::string field; std::getline(lines, field, ',');) {
      const std::size_t point = field.find('.'), end = std::min(field.find('\n'), field.size());
      const std::size_t decimals = point < end ? end - point - 1 : 0;
      EXPECT_LE(decimals, 6u) << unit << " " << field;
      ++fields;
    }
    EXPECT_GT(fields, 500);
  }
}

TEST(SurveyTables, AnglesAloneTurnWithoutAWordOnOffsets) {
  SurveyTable t;
  t.head.azimuth = {.north = North::kTrue, .convergence = 0.25};
  t.Add(100, 0.1, 1);
  SurveyTable odd = t;
  TurnTo(t, North::kGrid);
  EXPECT_NEAR(t.azimuth(0), 0.75, 1e-15);
  EXPECT_EQ(t.head.offsets, North::kGrid);
  odd.head.azimuth.convergence = std::nan("");
  EXPECT_THROW(TurnTo(odd, North::kGrid), std::invalid_argument);
  EXPECT_EQ(odd.azimuth(0), 1) << "refused before anything is turned";
}

TEST(SurveyTables, NoUnitIsRefused) {
  SurveyTable t;
  EXPECT_THROW(SetUnits(t, static_cast<LengthUnit>(99)), std::invalid_argument);
}

TEST(SurveyTables, DerivedColumns) {
  SurveyTable t = support::FullSurvey();
  FillDerived(t);
  const double n = *t.Get(Column::kNorth, 5), e = *t.Get(Column::kEast, 5);
  EXPECT_NEAR(*t.Get(Column::kClosure, 5), std::hypot(n, e), 1e-6);
  EXPECT_NEAR(*t.Get(Column::kTvdSubSea, 5), *t.Get(Column::kTvd, 5) - 25.3, 1e-6);
  EXPECT_NEAR(*t.Get(Column::kVerticalSection, 5),
              n * std::cos(5 * units::kDeg) + e * std::sin(5 * units::kDeg), 1e-6);
}

TEST(SurveyTables, OurSurveyWithItsGrid) {
  Job job;
  job.well = {.name = "A-1", .latitude = 1.04, .longitude = 0.03, .datum_elevation = 25};
  job.grid = UtmGrid("31N");
  job.grid->epsg = "EPSG:32631";
  const WellGrid grid(*job.grid, {job.well.latitude, job.well.longitude});
  Station tie, s;
  tie.kind = StationKind::kTieIn;
  s.md = 30;
  s.azimuth = 0.001;
  s.p_WT_W = {100, 200, 29};
  s.utc.ns = 1768457520500000000;
  s.status = StationStatus::kDefinitive;
  const Station stations[] = {tie, s};
  const SurveyTable t = TableOfSurvey(job, stations, &grid);
  EXPECT_EQ(t.status(0), RowStatus::kTieIn);
  EXPECT_EQ(t.head.crs, "EPSG:32631");
  EXPECT_EQ(t.head.azimuth.convergence, grid.At(0, 0).convergence);
  EXPECT_EQ(t.Get(Column::kEasting, 1), grid.At(100, 200).easting);
  EXPECT_EQ(t.head.names.created, "2026-01-15T06:12:00.500Z");
  EXPECT_EQ(t.head.definitive, true);
  EXPECT_EQ(t.head.datum_elevation, 25);
  EXPECT_EQ(t.head.tool, SurveyTool::kGyroContinuous);
}

}  // namespace
}  // namespace wellgyro

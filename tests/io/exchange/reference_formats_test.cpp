// Files that others wrote, read whole, written again and compared. They stay outside the project.
#include <array>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "wellgyro/io/exchange/exchange.h"

#include "support/survey_samples.h"

namespace wellgyro {
namespace {

using support::ExpectSameStations;

std::filesystem::path ReferencePath(const std::string& name) {
  return std::filesystem::path(WELLGYRO_REFERENCE_DIR) / name;
}

SurveyTable ReadReference(const std::string& name, const ReadOptions& options = {}) {
  auto table = ReadSurvey(ReferencePath(name), options);
  EXPECT_TRUE(table) << (table ? "" : table.fault().text) << " line "
                     << (table ? 0 : table.fault().line);
  return table ? *table : SurveyTable();
}

// Written in `format` and read again, every station of `columns` is the same to the last bit.
void ExpectRoundTrip(const SurveyTable& table, SurveyFormat format,
                     const std::vector<Column>& columns) {
  const auto back = ParseSurvey(WriteSurvey(table, format), "written");
  ASSERT_TRUE(back) << back.fault().text;
  ExpectSameStations(table, *back, columns);
}

const std::vector<Column> kPositions{Column::kMd,       Column::kInclination, Column::kAzimuth,
                                     Column::kTvd,      Column::kNorth,       Column::kEast,
                                     Column::kNorthing, Column::kEasting,     Column::kDown,
                                     Column::kLatitude, Column::kLongitude};

class ReferenceFormats : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(ReferencePath("wells"))) {
      GTEST_SKIP() << "the reference data are not here";
    }
  }
};

TEST_F(ReferenceFormats, P717ExampleA) {
  const SurveyTable t = ReadReference("wells/p717/exampleA.p717");
  ASSERT_EQ(t.rows(), 440u);
  EXPECT_EQ(t.head.md_unit, LengthUnit::kFoot);
  EXPECT_EQ(t.head.grid_unit, LengthUnit::kUsFoot);
  EXPECT_EQ(t.head.azimuth.north, North::kGrid);
  EXPECT_EQ(t.head.azimuth.convergence, 1.780 * units::kDeg);
  EXPECT_EQ(t.head.names.well, "ALPHA 01");
  EXPECT_EQ(t.head.names.contractor, "Unknown Contractor");
  EXPECT_EQ(t.head.datum, "Derrick Floor");
  EXPECT_NEAR(t.head.datum_elevation.value_or(0), 2626 * units::kUsSurveyFoot, 1e-9);
  EXPECT_EQ(t.head.md_kind, DepthKind::kWireline);
  EXPECT_EQ(t.head.crs, "EPSG:32039");
  EXPECT_EQ(t.head.objects.size(), 3u);
  EXPECT_EQ(t.md(439), 10991 * units::kFoot);
  EXPECT_EQ(t.status(439), RowStatus::kProjected);
  EXPECT_EQ(t.Get(TextColumn::kPoint, 439), "BHL");
  EXPECT_EQ(t.inclination(438), 58.301 * units::kDeg);
  for (const SurveyFormat format :
       {SurveyFormat::kP717, SurveyFormat::kWitsml1411, SurveyFormat::kWitsml21, SurveyFormat::kLas,
        SurveyFormat::kCsv}) {
    ExpectRoundTrip(t, format, {Column::kMd, Column::kInclination, Column::kAzimuth});
  }
}

TEST_F(ReferenceFormats, P717ExampleB) {
  const SurveyTable t = ReadReference("wells/p717/exampleB.p717");
  ASSERT_EQ(t.rows(), 23u);
  EXPECT_EQ(t.head.runs.size(), 2u);
  EXPECT_EQ(t.head.runs[1].tool, SurveyTool::kMagneticMwd);
  EXPECT_EQ(t.head.runs[1].azimuth.declination, 2.51 * units::kDeg);
  EXPECT_EQ(t.head.runs[1].azimuth.declination_source, "WMM2015");
  EXPECT_NEAR(t.head.datum_elevation.value_or(0), 2626 * units::kUsSurveyFoot, 1e-9);
  EXPECT_EQ(t.status(13), RowStatus::kUnused);
  EXPECT_EQ(t.Get(Column::kSurvey, 13), 2);
  EXPECT_EQ(t.head.error_model, "A001Mb_Gyro");
  EXPECT_EQ(t.Get(TextColumn::kErrorModel, 22), "A001Mb_MWD");
  EXPECT_EQ(t.Get(Column::kTvd, 22), 499.92 * units::kFoot);
  EXPECT_EQ(t.Get(Column::kLongitude, 22), -95.3696836 * units::kDeg);
  ExpectRoundTrip(t, SurveyFormat::kP717, kPositions);
  ExpectRoundTrip(t, SurveyFormat::kWitsml1411, kPositions);
  ExpectRoundTrip(t, SurveyFormat::kCsv, kPositions);
  // Its positions are ours, to the 0.01 ft that it prints.
  SurveyTable summed = t;
  for (const Column c : {Column::kTvd, Column::kNorth, Column::kEast, Column::kDogleg}) {
    summed.Drop(c);
  }
  ASSERT_TRUE(FillPositions(summed));
  for (std::size_t row = 0; row < t.rows(); ++row) {
    if (t.status(row) == RowStatus::kUnused) continue;
    for (const Column c : {Column::kTvd, Column::kNorth, Column::kEast}) {
      EXPECT_NEAR(*summed.Get(c, row), *t.Get(c, row), 0.0101 * units::kFoot) << row;
    }
  }
}

TEST_F(ReferenceFormats, WitsmlOfARealServer) {
  const SurveyTable t = ReadReference("wells/witsml/energistics_2016_trajectory_1411.xml");
  ASSERT_EQ(t.rows(), 82u);
  EXPECT_EQ(t.head.names.well, "EnergisticsWell2016-A");
  EXPECT_EQ(t.head.azimuth.north, North::kGrid);
  EXPECT_EQ(t.head.grid_correction, -0.639999985694885 * units::kDeg);
  EXPECT_EQ(t.head.curvature_unit, CurvatureUnit::kDegPerMetre);
  EXPECT_EQ(t.status(0), RowStatus::kTieIn);
  ExpectRoundTrip(t, SurveyFormat::kWitsml1411,
                  {Column::kMd, Column::kInclination, Column::kAzimuth, Column::kTvd,
                   Column::kNorth, Column::kEast, Column::kVerticalSection, Column::kDogleg,
                   Column::kBuild, Column::kTurn, Column::kGravityRef, Column::kUtc});
  ExpectRoundTrip(t, SurveyFormat::kWitsml21,
                  {Column::kMd, Column::kInclination, Column::kAzimuth, Column::kTvd,
                   Column::kNorth, Column::kEast});
  // Its north and east are minimum curvature from its own tie-in.
  SurveyTable summed = t;
  const double north = *t.Get(Column::kNorth, 0), east = *t.Get(Column::kEast, 0);
  for (const Column c : {Column::kTvd, Column::kNorth, Column::kEast}) summed.Drop(c);
  ASSERT_TRUE(FillPositions(summed));
  double worst = 0;
  for (std::size_t row = 0; row < t.rows(); ++row) {
    worst = std::max(
        worst, std::abs(*summed.Get(Column::kNorth, row) + north - *t.Get(Column::kNorth, row)));
    worst = std::max(worst,
                     std::abs(*summed.Get(Column::kEast, row) + east - *t.Get(Column::kEast, row)));
  }
  EXPECT_LT(worst, 2e-6);  // its figures and our sums are given to 1e-6 m and less
}

TEST_F(ReferenceFormats, WitsmlExampleWithMatrix) {
  const SurveyTable t = ReadReference("wells/witsml/energistics_example_1411.xml");
  ASSERT_EQ(t.rows(), 1u);
  EXPECT_EQ(t.head.md_unit, LengthUnit::kFoot);
  EXPECT_EQ(t.head.azimuth.declination, -4.038 * units::kDeg);
  EXPECT_EQ(t.head.error_model, "good gyro");
  EXPECT_TRUE(t.head.planned.value_or(false));
  EXPECT_EQ(t.Get(Column::kCovNV, 0), 2.356194 * (units::kFoot * units::kFoot));
  EXPECT_EQ(t.Get(Column::kMagneticToolface, 0), 47.3 * units::kDeg);
  EXPECT_EQ(t.Get(Column::kEasting, 0), 427710.69);
  EXPECT_EQ(t.head.crs, "ED50 / UTM Zone 31N");
  std::vector<Column> columns = kPositions;
  for (const Column c : {Column::kVarNN, Column::kCovNE, Column::kCovNV, Column::kVarEE,
                         Column::kCovEV, Column::kVarVV, Column::kBiasN}) {
    columns.push_back(c);
  }
  ExpectRoundTrip(t, SurveyFormat::kWitsml1411, columns);
}

// One survey in eight files that independent programs accept.
TEST_F(ReferenceFormats, TheSameSurveyInEveryFormat) {
  const SurveyTable csv = ReadReference("formats/gyro_survey.csv");
  ASSERT_EQ(csv.rows(), 7u);
  EXPECT_EQ(csv.head.azimuth.north, North::kGrid);
  struct Other {
    const char* name;
    double angle_deg, length;
  };
  for (const Other& other :
       {Other{"gyro_survey.las", 5e-5, 5e-5}, Other{"gyro_survey_step0.las", 5e-5, 5e-5},
        Other{"gyro_trajectory_1411.xml", 5e-5, 5e-5}, Other{"gyro_trajectory_20.xml", 5e-5, 5e-5},
        Other{"gyro_trajectory_21.xml", 5e-5, 5e-5}, Other{"gyro_survey.p717", 5e-4, 6e-3}}) {
    SCOPED_TRACE(other.name);
    const SurveyTable t = ReadReference(std::string("formats/") + other.name);
    ASSERT_EQ(t.rows(), csv.rows());
    for (std::size_t row = 0; row < csv.rows(); ++row) {
      EXPECT_NEAR(t.md(row), csv.md(row), other.length);
      EXPECT_NEAR(t.inclination(row), csv.inclination(row), other.angle_deg * units::kDeg);
      EXPECT_NEAR(t.azimuth(row), csv.azimuth(row), other.angle_deg * units::kDeg);
      EXPECT_NEAR(*t.Get(Column::kTvd, row), *csv.Get(Column::kTvd, row), other.length);
      EXPECT_NEAR(*t.Get(Column::kNorth, row), *csv.Get(Column::kNorth, row), other.length);
    }
  }
}

TEST_F(ReferenceFormats, TablesOfEveryStyle) {
  const ReadOptions metres{.depth_unit = LengthUnit::kMetre, .north = North::kGrid};
  EXPECT_EQ(ReadReference("wells/wellpathpy/well9.csv").rows(), 121u);
  EXPECT_EQ(ReadReference("wells/wellpathpy/well10.csv").rows(), 121u);
  const SurveyTable report =
      ReadReference("wells/wellpathpy/Well_Surveys_Projected_to_TD.csv", {.north = North::kGrid});
  EXPECT_EQ(report.rows(), 80u);
  EXPECT_THAT(report.head.remarks, testing::ElementsAre(testing::HasSubstr("430.1m")));
  EXPECT_EQ(ReadReference("wells/volve/15_9-F-12_Survey_Data.csv", metres).rows(), 126u);
  const SurveyTable nlog = ReadReference("wells/nlog/P11-A-02_SURV.csv", metres);
  EXPECT_EQ(nlog.rows(), 91u);
  EXPECT_EQ(nlog.md(90), 2691);
  EXPECT_EQ(nlog.inclination(90), 89.66 * units::kDeg);
  EXPECT_EQ(nlog.azimuth(90), 319.61 * units::kDeg);
  EXPECT_EQ(ReadReference("wells/wellpathpy/mock_data_set.csv", metres).rows(), 94u);
  const ReadOptions by_number{
      .columns = {{"MD[m]", "1"}, {"INC", "2"}, {"AZI_GRID", "3"}, {"TVD[m]", "4"}}};
  const SurveyTable iscwsa = ReadReference("wells/iscwsa-1.txt", by_number);
  EXPECT_EQ(iscwsa.md(iscwsa.rows() - 1), 8000);
  EXPECT_EQ(iscwsa.Get(Column::kTvd, iscwsa.rows() - 1), 3521.06);
}

}  // namespace
}  // namespace wellgyro

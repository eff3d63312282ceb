#include <string>

#include <gmock/gmock.h>

#include "wellgyro/io/exchange/exchange.h"

#include "io/exchange/parsed.h"
#include "support/survey_samples.h"

namespace wellgyro {
namespace {

using testing::HasSubstr;

// As short as a file can be that says what its numbers are.
const std::string kHead =
    "IOGP,TEST,7,1.0,1,2026:01:15,08:00:00,t.p717,me\r\n"
    "** decoration, as the user guide has it\r\n"
    "HC,1,3,0,CRS Number/EPSG Code/Name/Source,2,23031,ED50 / UTM zone 31N,,,EPSG,\r\n"
    "HC,1,6,1,Coordinate System Axis 1,2,1,,Northing,north,N,1,m\r\n"
    "H7,1,4,0,Rig/Workover ZDP Definition,1,Rig A,ZDP,3,1,Rotary Table,1,1\r\n"
    "H7,1,5,0,Survey Definition,1,1,1,GYRO,Gyro,,,,,0,30,m,2026:01:15,,ST=N,,,\r\n"
    "H7,1,5,1,Survey Details,1,1,2,MD-Wireline,3,Corrected Depth,1,7,AZIM_TRUE,1,Surveyed,0,,0,,"
    ",,\r\n"
    "O7,0,3,ZDP,RT,6625015.54,427710.69,-25.5,,,,,,\r\n"
    "H7,5,0,0,P7 Table Definition,1,Definitive,1,Minimum Curvature,1077,GNL,0,,0,2,"
    "4;;var_N;34,27;;dogleg;28\r\n"
    "P7,0,1,1,,,10,TP,9,Other,0,0,0,0,0,0,,,,,,;0\r\n"
    "P7,0,1,1,,A021Gc,,D,1,Surveyed,30,1.5,358.5,0.39,-0.01,30,,,,,,0.0123;1.5\r\n";

const std::string kG7 =
    "G7,0,1,1,2026:01:15:06:12:00.5,1,30.0,1.5,358.5,0.39,-0.01,30.0,2,0.2,-0.1,-9.81,7.1,-1.2,"
    "13.2,9.8126,59.75,15.04,12.5,100.25,9.81234,59.7553,15.041,-1.2345,\n";
// The draft of 2019 has tool and flag before MD.
const std::string kG7Of2019 =
    "G7,0,1,1,2026:01:15:06:12:00.5,2,1,30.0,1.5,358.5,0.39,-0.01,30.0,0.2,-0.1,-9.81,7.1,-1.2,"
    "13.2,9.8126,59.75,15.04,12.5,100.25,9.81234,59.7553,15.041,-1.2345,\n";

TEST(P717, RecordsMeanWhatTheyShould) {
  const SurveyTable t = Parsed(kHead);
  ASSERT_EQ(t.rows(), 2u);
  EXPECT_EQ(t.head.datum, "Rotary Table");
  EXPECT_EQ(t.head.datum_elevation, 25.5);
  EXPECT_EQ(t.head.azimuth.north, North::kTrue);
  EXPECT_EQ(t.head.crs, "EPSG:23031");
  EXPECT_EQ(t.head.runs[0].md_status, 3);
  EXPECT_EQ(t.status(0), RowStatus::kTieIn);
  EXPECT_EQ(t.Get(Column::kObject, 0), 10);
  EXPECT_FALSE(t.Get(Column::kVarNN, 0));
  EXPECT_EQ(t.Get(Column::kVarNN, 1), 0.0123);
  EXPECT_EQ(t.Get(Column::kDogleg, 1), 1.5 * units::kDegPer30m);
  EXPECT_EQ(t.head.error_model, "A021Gc");
}

TEST(P717, GyroRawRecordsOfBothDrafts) {
  for (const std::string& record : {kG7, kG7Of2019}) {
    const SurveyTable t = Parsed(kHead + record);
    ASSERT_EQ(t.head.gyro_raw.size(), 1u);
    const GyroRawRecord& g = t.head.gyro_raw[0];
    EXPECT_EQ(g.tool, 2);
    EXPECT_TRUE(g.used);
    EXPECT_EQ(g.time, "2026:01:15:06:12:00.5");
    EXPECT_EQ(g.md, 30);
    EXPECT_EQ(g.azimuth, 358.5 * units::kDeg);
    EXPECT_EQ(g.down, 30);
    EXPECT_EQ(g.f, Eigen::Vector3d(0.2, -0.1, -9.81));
    EXPECT_EQ(g.w.y(), -1.2 * units::kDegPerHour);
    EXPECT_EQ(g.gravity, 9.8126);
    EXPECT_EQ(g.gyro_toolface, 12.5 * units::kDeg);
    EXPECT_EQ(g.gravity_toolface, 100.25 * units::kDeg);
    EXPECT_EQ(g.earth_rate_ref, 15.041 * units::kDegPerHour);
    EXPECT_EQ(g.convergence, -1.2345 * units::kDeg);
    // And comes back in the layout of the published field list.
    EXPECT_THAT(WriteSurvey(t, SurveyFormat::kP717), HasSubstr(kG7));
  }
}

TEST(P717, FaultsNameTheLine) {
  EXPECT_EQ(ParseFault(kHead + "P7,0,1,1,,,,D,1,Surveyed,30,1,1,,,,,,,,,\n").line, 12);
  EXPECT_EQ(ParseFault(kHead + "P7,0,1,1,,,,D,1,Surveyed,x,1,1,,,,,,,,,\n").column, 11);
  EXPECT_EQ(ParseFault(kHead + "P7,0,1\n").line, 12);
  EXPECT_THAT(ParseFault(kHead + "Q7,0,1,2,3\n").text, HasSubstr("Q7"));
  EXPECT_THAT(ParseFault(kHead + "G7,0,1,1\n").text, HasSubstr("G7"));
  EXPECT_THAT(ParseFault("IOGP,x,1,1.1,1,,,,\n").text, HasSubstr("P7"));
  const std::string no_survey = "IOGP,x,7,1.0,1,,,,\nP7,0,1,1,,,,D,1,Surveyed,1,1,1,,,,,,,,,\n";
  EXPECT_THAT(ParseFault(no_survey).text, HasSubstr("H7,1,5,0"));
}

TEST(P717, TextKeepsOutOfTheWayOfTheFormat) {
  SurveyTable t = support::FullSurvey();
  t.head.names.well = "A,1;2";
  t.Set(TextColumn::kComment, 1, "one, two; three");
  const SurveyTable back = Parsed(WriteSurvey(t, SurveyFormat::kP717));
  EXPECT_EQ(back.head.names.well, "A 1 2");
  EXPECT_EQ(back.Get(TextColumn::kComment, 1), "one  two  three");
  EXPECT_EQ(back.md(6), t.md(6));
}

}  // namespace
}  // namespace wellgyro
